// Settings with which hands learned: one decision each 4 control steps, 64 worlds.
#pragma once
#include "tasks/task_info.hpp"

namespace rdm {

inline constexpr std::array kHandLearner = {
    LearnerDefault{"hidden", "128,128"},
    LearnerDefault{"activation", "tanh"},
    LearnerDefault{"horizon", "16"},
    LearnerDefault{"passes", "6"},
    LearnerDefault{"minibatches", "4"},
    LearnerDefault{"learning_rate", "1e-3"},
    LearnerDefault{"lr_schedule", "kl"},
    LearnerDefault{"kl_target", "0.04"},
    LearnerDefault{"discount", "0.96"},
    LearnerDefault{"lambda", "0.95"},
    LearnerDefault{"clip", "0.2"},
    LearnerDefault{"max_grad_norm", "1"},
    LearnerDefault{"noise_correlation", "0.3"},
    LearnerDefault{"action_repeat", "4"},
    LearnerDefault{"multiplier_optimizer", "sgd"},
    LearnerDefault{"multiplier_normalized", "true"},
    LearnerDefault{"multiplier_lr", "0.03"},
    LearnerDefault{"normalize_obs", "true"},
};

// init_std: a throw needs wild trials, a grip that must not be lost small ones.
constexpr auto hand_learner(const char* cost_limit, const char* init_std) {
  return join_defaults(kHandLearner, {{"init_std", init_std}, {"cost_limit", cost_limit}});
}
// Joint forces, the last action and all of the fingertips but where they are do not help to throw.
inline constexpr const char* kThrowObs = "*,!*joint_force,!*action,!*_tip_*,*_tip_position";

// Small batches, bounded by KL more than by the clip, learn in a third of the steps; the deviation falls over
// the run, so that the policy that acts without noise and the one that was trained come together. With the
// gains of other algorithms that were measured on throws. A team's step is the product of its groups' probability
// ratios, whose tails decide what a step seems to be worth: each of two groups has half of CPO's, and ratios are cut.
constexpr auto throw_learner(const char* cost_limit) {
  return join_defaults(
      kHandLearner,
      {{"init_std", "0.4"},        {"std_min", "0.15"},         {"std_schedule", "linear"},
       {"kl_target_end", "0.005"}, {"lr_min", "1e-6"},          {"average", "0.9"},
       {"actor_obs", kThrowObs},   {"critic_obs", kThrowObs},   {"ppo:horizon", "8"},
       {"ppo:clip", "0.8"},        {"ppo_lag:horizon", "8"},    {"ppo_lag:clip", "0.8"},
       {"pid_kp", "0.0075"},       {"pid_ki", "0.00075"},       {"pid_kd", "0.0075"},
       {"penalty", "2"},           {"focops_eta", "0.04"},      {"focops:early_stop_kl", "0.04"},
       {"trust_kl", "0.15"},       {"macpo:trust_kl", "0.075"}, {"macpo:ratio_max", "2"},
       {"fisher_stride", "4"},     {"cost_limit", cost_limit}});
}

// Where a moment decides (an egg let go off fingertips, a hole to be met): two decisions for each one of
// above, in as many control steps of an epoch.
inline constexpr LearnerDefault kFineDecisions[] = {{"action_repeat", "2"},
                                                    {"horizon", "32"},
                                                    {"ppo:horizon", "16"},
                                                    {"ppo_lag:horizon", "16"},
                                                    {"noise_correlation", "0.55"}};

}  // namespace rdm

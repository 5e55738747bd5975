// Learner settings of the small worlds: what all of them share, those with a known optimum, and those of
// published benchmarks.
#pragma once
#include "tasks/task_info.hpp"

namespace rdm {

inline constexpr std::array kSmallLearner = {
    LearnerDefault{"hidden", "64,64"}, LearnerDefault{"activation", "tanh"},
    LearnerDefault{"lr_schedule", "linear"}, LearnerDefault{"multiplier_optimizer", "sgd"},
    LearnerDefault{"multiplier_normalized", "true"}};
inline constexpr auto kKnownLearner =
    join_defaults(kSmallLearner, {{"learn_std", "false"}, {"normalize_obs", "false"}, {"critic_l2", "0"}});
inline constexpr auto kSafetyLearner = join_defaults(kSmallLearner, {{"passes", "10"},
                                                                     {"lambda", "0.95"},
                                                                     {"cost_lambda", "0.95"},
                                                                     {"early_stop_kl", "0.03"},
                                                                     {"pid_ki", "0.004"},
                                                                     {"pid_kd", "0.05"},
                                                                     {"pid_smooth_p", "0"},
                                                                     {"pid_smooth_d", "0.5"},
                                                                     {"penalty", "10"},
                                                                     {"barrier_kappa", "10"},
                                                                     {"barrier_max", "20"},
                                                                     {"focops:multiplier_max", "100"},
                                                                     {"multiplier_divide", "true"},
                                                                     {"cost_limit", "25"}});
// Of the rolling ball. Its observations are scaled as they are; a normaliser that still drifts would move the
// held speed across the limit.
inline constexpr auto kBallLearner = join_defaults(kSafetyLearner, {{"horizon", "250"},
                                                                    {"learning_rate", "1e-3"},
                                                                    {"minibatches", "32"},
                                                                    {"discount", "0.99"},
                                                                    {"init_std", "0.6"},
                                                                    {"std_min", "0.05"},
                                                                    {"multiplier_init", "1"},
                                                                    {"normalize_obs", "false"},
                                                                    {"multiplier_lr", "0.2"}});

}  // namespace rdm

// The rows of options that algorithms have in common, and what presets lay under them. Rows of one algorithm or
// part stand in its own file.
#pragma once
#include <span>

#include "algos/core/agent_types.hpp"
#include "algos/core/shared_options.hpp"
#include "base/option_rows.hpp"

namespace rdm {

inline constexpr int32_t kLongestObs = 1023;  // characters of actor_obs, critic_obs
inline constexpr double kHuge = 1e12, kMaxMultiplier = kHuge, kMaxLearningRate = 10;

// What every algorithm understands.
inline constexpr auto kSharedRows = [] {
  using S = SharedOptions;
  return option_rows<S>(
      row<&S::preset>(basic(text_option(
          "preset", "default", "default|safe|paper|omnisafe",
          "set of values laid under the options: safe charges falls, paper and omnisafe are the peers'"))),
      // networks
      row<&S::hidden>(basic(text_option("hidden", "64,64", nullptr,
                                        "widths of the hidden layers, at most 4, separated by commas"))),
      row<&S::critic_hidden>(
          text_option("critic_hidden", "", nullptr, "the same for the critics; empty: as hidden")),
      row<&S::activation, Activation::kTanh, Activation::kElu, Activation::kRelu>(
          text_option("activation", "tanh", "tanh|elu|relu", "of the hidden layers")),
      row<&S::last_layer_scale>(
          number_option("last_layer_scale", 0.01, 0, 100, "factor on the actor's initial last layer")),
      row<&S::actor_obs>(basic(text_option(
          "actor_obs", "*", nullptr,
          "what the actor observes: fields by commas, '*', !less; or state, vision, touch, proprioception",
          kLongestObs))),
      row<&S::critic_obs>(
          text_option("critic_obs", "*", nullptr, "what the critics observe, in the same form", kLongestObs)),
      // seeing
      row<&S::encoder>(basic(text_option(
          "encoder", "", nullptr,
          "widths of a PointNet's layers, 64,128: the last are features for the actor; empty: none"))),
      row<&S::encoder_activation, Activation::kTanh, Activation::kElu, Activation::kRelu>(
          text_option("encoder_activation", "relu", "tanh|elu|relu", "of its layers and features")),
      row<&S::encoder_frozen>(flag_option("encoder_frozen", false,
                                          "it does not learn; its features are computed once, when acting")),
      row<&S::encoder_points>(integer_option("encoder_points", 512, 1, 16384, "points of each cloud")),
      row<&S::encoder_classes>(integer_option(
          "encoder_classes", 0, 0, 64, "classes of points, which it reads beside coordinates; 0: none")),
      row<&S::encoder_color>(flag_option("encoder_color", false, "it reads the colours of points")),
      row<&S::encoder_origin>(
          text_option("encoder_origin", "0,0,0", nullptr, "x,y,z in the world, m: where points are 0 to it")),
      row<&S::encoder_range>(
          number_option("encoder_range", 0.25, 1e-3, 1e3, "distance from there, m, that is 1 to it")),
      // collecting
      row<&S::horizon>(
          basic(integer_option("horizon", 128, 1, 1 << 20, "decisions of each environment per epoch"))),
      row<&S::action_repeat>(basic(integer_option("action_repeat", 1, 1, 10000,
                                                  "control steps for which a decision's action is held"))),
      row<&S::noise_correlation>(number_option("noise_correlation", 0, 0, 0.999,
                                               "AR(1) coefficient of the exploration noise over decisions")),
      row<&S::init_std>(basic(number_option("init_std", 0.6, 1e-6, 1e3,
                                            "initial standard deviation of the action (stationary)"))),
      row<&S::std_min>(number_option("std_min", 0.01, 1e-6, 1e3, "lower bound on the standard deviation")),
      row<&S::std_max>(number_option("std_max", 10, 1e-6, 1e3, "upper bound on the standard deviation")),
      row<&S::learn_std>(flag_option("learn_std", true, "learn the standard deviation")),
      row<&S::state_std, false, true>(text_option(
          "std_mode", "free", "free|state",
          "deviation as parameters, or outputs of the actor's network; no gradient at its bounds")),
      row<&S::linear_std, false, true>(
          text_option("std_schedule", "none", "none|linear",
                      "linear: not learned, falls from init_std to std_min over total_epochs")),
      row<&S::average>(number_option(
          "average", 0, 0, 0.9999,
          "share of its past in the actor's mean over epochs, which policy files hold; 0: none")),
      row<&S::shield_learn, ShieldLearn::kOwn, ShieldLearn::kApplied, ShieldLearn::kCost, ShieldLearn::kEnd>(
          text_option("shield_learn", "own", "own|applied|cost|end",
                      "learn from a refused action: own, applied (what ran), cost (of column 0) or end (of "
                      "the episode)")),
      row<&S::shield_penalty>(
          number_option("shield_penalty", 0, 0, 1e6, "what a refused decision takes from the reward")),
      row<&S::normalize_obs>(basic(flag_option(
          "normalize_obs", true, "subtract the running mean of observations, divide by their deviation"))),
      row<&S::obs_clip>(number_option("obs_clip", 5, 0.1, 1e6, "bound on normalised observations")),
      row<&S::obs_count_max>(
          number_option("obs_count_max", 0, 0, kHuge, "samples after which old statistics fade; 0: never")),
      row<&S::obs_freeze>(
          number_option("obs_freeze", 0, 0, kHuge,
                        "samples after which statistics stand still, those of a clone too; 0: never")),
      row<&S::normalize_reward>(flag_option(
          "normalize_reward", false, "learn from rewards less their running mean, over their deviation")),
      row<&S::normalize_cost>(
          flag_option("normalize_cost", false, "the same for costs; limits hold for costs as they are")),
      row<&S::reward_factor>(number_option(
          "reward_factor", 1, 1e-9, 1e9,
          "factor on rewards in what is learned; brings values near 1, where the critic learns soon")),
      // returns
      row<&S::discount>(basic(
          number_option("discount", 0.99, 0, 1, "per control step; a decision has discount^action_repeat"))),
      row<&S::lambda>(basic(number_option("lambda", 0.95, 0, 1, "of the reward advantage (GAE)"))),
      row<&S::cost_lambda>(number_option("cost_lambda", 0.95, 0, 1, "of the cost advantages (GAE)")),
      row<&S::standardize_reward_adv>(flag_option(
          "standardize_reward_adv", true, "reward advantage to mean 0 and deviation 1 over the batch")),
      row<&S::standardize_cost_adv, false, true>(legacy(
          text_option("scale_cost_adv", "center", "center|std",
                      "cost advantages: subtract the mean, or standardise as the authors of FOCOPS do"))),
      row<&S::discounted_limit>(flag_option(
          "discounted_limit", false,
          "limits hold for discounted sums over an episode, as cost advantages are; else for plain sums")),
      row<&S::terminal_cost>(flag_option("terminal_cost", false,
                                         "charge a terminated episode's missing steps at its own cost rate")),
      // learning
      row<&S::passes>(basic(integer_option("passes", 10, 1, 10000, "over the data of an epoch"))),
      row<&S::minibatches>(
          basic(integer_option("minibatches", 4, 1, 1 << 20, "number of minibatches in a pass"))),
      row<&S::blocks>(
          integer_option("blocks", 1, 1, 65536,
                         "equal parts of all worlds whose sums meet in a tree: ranks times a power of two")),
      row<&S::learning_rate>(
          basic(number_option("learning_rate", 3e-4, 0, kMaxLearningRate, "Adam rate of the actor", true))),
      row<&S::critic_learning_rate>(number_option("critic_learning_rate", 0, 0, kMaxLearningRate,
                                                  "Adam rate of the critics; 0: learning_rate", true)),
      row<&S::rate_kind, RateKind::kConstant, RateKind::kLinear, RateKind::kKl>(basic(text_option(
          "lr_schedule", "constant", "constant|linear|kl",
          "of the actor's rate (linear: of a trust region's radius too): linear falls to 0, kl adapts"))),
      row<&S::critics_follow, false, true>(
          legacy(text_option("critic_lr_schedule", "constant", "constant|actor",
                             "of the critics' rate: constant, or in step with the actor's"))),
      row<&S::total_epochs>(
          integer_option("total_epochs", 1000, 1, 1 << 30, "epochs of the linear schedules", true)),
      row<&S::kl_target>(number_option("kl_target", 0.02, 1e-9, 1e3,
                                       "kl schedule: the epoch's mean KL is kept in half to twice this",
                                       true)),
      row<&S::kl_target_end>(number_option(
          "kl_target_end", 0, 0, 1e3,
          "kl schedule: kl_target goes to this, in a line over total_epochs; 0: it stays", true)),
      row<&S::kl_factor>(
          number_option("kl_factor", 1.3, 1, 10, "kl schedule: change of the rate per epoch", true)),
      row<&S::lr_min>(number_option("lr_min", 1e-5, 0, kMaxLearningRate, "kl schedule: lowest rate", true)),
      row<&S::lr_max>(number_option("lr_max", 3e-3, 0, kMaxLearningRate, "kl schedule: highest rate", true)),
      row<&S::early_stop_kl>(basic(number_option(
          "early_stop_kl", 0, 0, 1e3, "stop the passes above this KL over the batch; 0: never", true))),
      row<&S::entropy>(basic(number_option("entropy", 0, 0, 1e3, "weight of the entropy bonus", true))),
      row<&S::max_grad_norm>(number_option("max_grad_norm", 1, 0, kHuge,
                                           "bound on each network's gradient norm; 0: none", true)),
      row<&S::joint_grad_norm>(legacy(flag_option(
          "joint_grad_norm", false, "max_grad_norm bounds the norm over all networks together", true))),
      row<&S::value_clip>(legacy(number_option(
          "value_clip", 0, 0, 1e6,
          "bound on a value's change from the one that acted, in the critics' loss; 0: none", true))),
      row<&S::critic_l2>(
          number_option("critic_l2", 1e-3, 0, 1e3, "weight of the critics' squared parameters", true)),
      // demonstrations
      row<&S::warm_epochs>(
          integer_option("warm_epochs", 0, 0, 1 << 30,
                         "first epochs in which the critics learn alone: actor and multipliers stay", true)),
      row<&S::imitation>(basic(number_option(
          "imitation", 0, 0, 1e6, "weight of staying near a recording (rdm_agent_set_recording); 0: none"))),
      row<&S::imitation_decay>(
          number_option("imitation_decay", 0.99, 0, 1, "factor on that weight per epoch", true)),
      // costs
      row<&S::cost_limit>(basic(number_option("cost_limit", 25, -1, kHuge,
                                              "limit on column 0's sum over an episode; < 0: none", true))),
      row<&S::cost_limit_per_step>(basic(number_option(
          "cost_limit_per_step", -1, -1, kHuge,
          "limit on column 0's mean per control step, in the place of cost_limit; < 0: none", true))),
      row<&S::episode_steps>(basic(integer_option(
          "episode_steps", 0, 0, INT32_MAX,
          "control steps after which an episode counts as ended; 0: max_steps of the config"))),
      row<&S::raw_costs, false, true>(text_option(
          "cost_signal", "flag", "flag|raw",
          "what rollouts take as cost: the pool's, or cost_raw above 0; limits are in its unit")));
}();

// The window alone: a rule with multipliers or one without.
struct WindowOptions {
  int32_t window;
};
inline constexpr auto kWindowRows = option_rows<WindowOptions>(row<&WindowOptions::window>(
    integer_option("multiplier_window", 100, 1, 1000000, "finished episodes that J_c is the mean of")));

// A rule with a place for each cost, or one that follows a single one.
struct OneCostOptions {
  bool worst;
};
inline constexpr auto kOneCostRows =
    option_rows<OneCostOptions>(row<&OneCostOptions::worst, false, true>(legacy(text_option(
        "several_costs", "refuse", "refuse|worst",
        "with more than one limited cost: refuse, or follow the most violated one in each epoch"))));

// How a constraint that an episode's sum J_c sets is put in the units of a mean over decisions.
enum class ViolationScale { kStep, kDiscount, kRaw };
struct ViolationOptions {
  ViolationScale scale;
};
inline constexpr auto kViolationRows = option_rows<ViolationOptions>(
    row<&ViolationOptions::scale, ViolationScale::kStep, ViolationScale::kDiscount, ViolationScale::kRaw>(
        legacy(text_option("violation_scale", "step", "step|discount|raw",
                           "factor on J_c - limit: 1 / decisions of an episode, 1 - discount, or 1"))));

// A row of a preset: what it lays under one option.
struct PresetValue {
  const char *preset, *key, *text;
  const char* algos = nullptr;  // "trpo|cpo": for these alone, over a row for all before it; null: for all
};
std::span<const PresetValue> preset_values();

// The values for one agent: table, then config.defaults, then the preset, then config.options. A default
// that only other algorithms know, or of the form "algorithm:key" for another, is skipped; an option is not.
// Takes memory from the hooks of the config, once and for each long text.
Options read_options(const AgentConfig& config, const AlgoInfo& algo);

}  // namespace rdm

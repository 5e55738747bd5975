// The rows of options that algorithms have in common, and what presets lay under them. Rows of one algorithm or
// part stand in its own file.
#pragma once
#include <span>

#include "algos/core/agent_types.hpp"
#include "algos/core/shared_options.hpp"
#include "base/option_rows.hpp"
#include "nn/latent.hpp"
#include "nn/policy.hpp"

namespace rdm {

struct AlgoRow;

inline constexpr int32_t kLongestObs = 1023;  // characters of actor_obs, critic_obs
inline constexpr double kHuge = 1e12, kMaxMultiplier = kHuge, kMaxLearningRate = 10;

// What every algorithm understands.
inline constexpr auto kSharedRows = [] {
  using S = SharedOptions;
  return option_rows<S>(
      row<&S::preset>(basic(text_option("preset", "default", "default|safe|paper|omnisafe",
                                        "named set of defaults: safe charges falls (terminal_cost); paper, "
                                        "omnisafe: the published values"))),
      // networks
      row<&S::hidden>(
          basic(text_option("hidden", "64,64", nullptr,
                            "widths of the actor's hidden layers, at most 4, separated by commas"))),
      row<&S::critic_hidden>(text_option("critic_hidden", "", nullptr,
                                         "widths of the critics' hidden layers; empty: the same as hidden")),
      row<&S::activation, Activation::kTanh, Activation::kElu, Activation::kRelu>(
          text_option("activation", "tanh", "tanh|elu|relu", "activation function of the hidden layers")),
      row<&S::last_layer_scale>(number_option("last_layer_scale", 0.01, 0, 100,
                                              "factor on the initial weights of the actor's last layer")),
      row<&S::actor_obs>(basic(text_option(
          "actor_obs", "*", nullptr,
          "fields the actor observes: names, '*', !name to leave out; state, vision, touch or proprioception",
          kLongestObs))),
      row<&S::critic_obs>(text_option("critic_obs", "*", nullptr,
                                      "fields the critics observe, written as in actor_obs", kLongestObs)),
      // seeing
      row<&S::encoder>(basic(text_option(
          "encoder", "", nullptr,
          "layer widths of the point-cloud encoder, e.g. 64,128; the last is the features; empty: none"))),
      row<&S::encoder_activation, Activation::kTanh, Activation::kElu, Activation::kRelu>(
          text_option("encoder_activation", "relu", "tanh|elu|relu",
                      "activation function of the point-cloud encoder, its features included")),
      row<&S::encoder_frozen>(
          flag_option("encoder_frozen", false,
                      "the encoder does not learn; its features are computed once, when acting")),
      row<&S::encoder_points>(integer_option("encoder_points", 512, 1, 16384,
                                             "number of points in each cloud that the encoder reads")),
      row<&S::encoder_classes>(
          integer_option("encoder_classes", 0, 0, 64,
                         "number of point classes that the encoder reads beside coordinates; 0: none")),
      row<&S::encoder_color>(
          flag_option("encoder_color", false, "the encoder also reads the colours of points")),
      row<&S::encoder_origin>(text_option("encoder_origin", "0,0,0", nullptr,
                                          "world point that is the encoder's origin: x,y,z in m")),
      row<&S::encoder_range>(number_option("encoder_range", 0.25, 1e-3, 1e3,
                                           "distance from encoder_origin that the encoder reads as 1, m")),
      // collecting
      row<&S::horizon>(basic(
          integer_option("horizon", 128, 1, 1 << 20, "decisions collected from each environment per epoch"))),
      row<&S::action_repeat>(basic(integer_option(
          "action_repeat", 1, 1, 10000, "control steps for which the action of one decision is held"))),
      row<&S::noise_correlation>(number_option(
          "noise_correlation", 0, 0, 0.999,
          "correlation of the exploration noise from one decision to the next (AR(1) coefficient)")),
      row<&S::init_std>(basic(
          number_option("init_std", 0.6, 1e-6, 1e3,
                        "initial standard deviation of the exploration noise, in units of the action"))),
      row<&S::std_min>(number_option("std_min", 0.01, 1e-6, 1e3,
                                     "lower bound of the standard deviation of the exploration noise")),
      row<&S::std_max>(number_option("std_max", 10, 1e-6, 1e3,
                                     "upper bound of the standard deviation of the exploration noise")),
      row<&S::learn_std>(
          flag_option("learn_std", true, "learn the standard deviation of the exploration noise")),
      row<&S::state_std, false, true>(text_option(
          "std_mode", "free", "free|state",
          "standard deviation: free parameters, or outputs of the actor's network that depend on the state")),
      row<&S::linear_std, false, true>(text_option(
          "std_schedule", "none", "none|linear",
          "linear: the deviation is not learned but falls from init_std to std_min over total_epochs")),
      row<&S::average>(number_option("average", 0, 0, 0.9999,
                                     "policy files hold the actor's running mean over epochs; this is the "
                                     "weight of the past; 0: no mean")),
      row<&S::shield_learn, ShieldLearn::kOwn, ShieldLearn::kApplied, ShieldLearn::kCost, ShieldLearn::kEnd>(
          text_option("shield_learn", "own", "own|applied|cost|end",
                      "a refused action is learned as: own, applied (what ran), cost (1 in column 0), end "
                      "(of the episode)")),
      row<&S::shield_penalty>(
          number_option("shield_penalty", 0, 0, 1e6,
                        "amount subtracted from the reward of a decision that the shield refused")),
      row<&S::normalize_obs>(basic(flag_option("normalize_obs", true,
                                               "normalise observations: subtract their running mean, divide "
                                               "by their running standard deviation"))),
      row<&S::obs_clip>(
          number_option("obs_clip", 5, 0.1, 1e6, "bound of the magnitude of normalised observations")),
      row<&S::obs_count_max>(number_option(
          "obs_count_max", 0, 0, kHuge,
          "samples after which older ones lose weight in the observations' mean and deviation; 0: never")),
      row<&S::obs_freeze>(number_option("obs_freeze", 0, 0, kHuge,
                                        "samples, those of cloning included, after which the observations' "
                                        "statistics are fixed; 0: never")),
      row<&S::normalize_reward>(flag_option(
          "normalize_reward", false,
          "normalise rewards by their running mean and standard deviation before learning from them")),
      row<&S::normalize_cost>(
          flag_option("normalize_cost", false,
                      "normalise costs in the same way; limits still apply to the costs as measured")),
      row<&S::reward_factor>(number_option(
          "reward_factor", 1, 1e-9, 1e9,
          "factor on rewards before learning; one that brings values near 1 makes the critic learn faster")),
      // returns
      row<&S::discount>(
          basic(number_option("discount", 0.99, 0, 1,
                              "discount factor per control step; a decision has discount^action_repeat"))),
      row<&S::lambda>(basic(number_option("lambda", 0.95, 0, 1, "lambda of the reward advantage (GAE)"))),
      row<&S::cost_lambda>(number_option("cost_lambda", 0.95, 0, 1, "lambda of the cost advantages (GAE)")),
      row<&S::standardize_reward_adv>(
          flag_option("standardize_reward_adv", true,
                      "scale the reward advantage to mean 0 and standard deviation 1 over the batch")),
      row<&S::standardize_cost_adv, false, true>(
          legacy(text_option("scale_cost_adv", "center", "center|std",
                             "cost advantages: center subtracts the mean; std also divides by the deviation, "
                             "as in FOCOPS's code"))),
      row<&S::discounted_limit>(
          flag_option("discounted_limit", false,
                      "cost limits apply to the discounted sum over an episode; false: to the plain sum")),
      row<&S::terminal_cost>(flag_option(
          "terminal_cost", false,
          "an episode that terminates early is charged its own mean cost for each step that is missing")),
      // learning
      row<&S::passes>(
          basic(integer_option("passes", 10, 1, 10000, "passes over the data of an epoch in one update"))),
      row<&S::minibatches>(
          basic(integer_option("minibatches", 4, 1, 1 << 20, "number of minibatches in each pass"))),
      row<&S::blocks>(integer_option(
          "blocks", 1, 1, 65536,
          "equal parts into which the worlds are cut for sums; the number of ranks times a power of two")),
      row<&S::learning_rate>(basic(number_option("learning_rate", 3e-4, 0, kMaxLearningRate,
                                                 "learning rate of the actor (Adam)", true))),
      row<&S::critic_learning_rate>(
          number_option("critic_learning_rate", 0, 0, kMaxLearningRate,
                        "learning rate of the critics (Adam); 0: the same as learning_rate", true)),
      row<&S::rate_kind, RateKind::kConstant, RateKind::kLinear, RateKind::kKl>(
          basic(text_option("lr_schedule", "constant", "constant|linear|kl",
                            "learning rate (or trust region) over epochs: constant, linear (falls to 0), kl "
                            "(follows kl_target)"))),
      row<&S::critics_follow, false, true>(legacy(text_option(
          "critic_lr_schedule", "constant", "constant|actor",
          "learning rate of the critics over epochs: constant, or in proportion to the actor's"))),
      row<&S::total_epochs>(integer_option("total_epochs", 1000, 1, 1 << 30,
                                           "number of epochs over which the linear schedules run", true)),
      row<&S::kl_target>(number_option(
          "kl_target", 0.02, 1e-9, 1e3,
          "kl schedule: the rate changes when the epoch's mean KL is outside half to twice this value",
          true)),
      row<&S::kl_target_end>(number_option(
          "kl_target_end", 0, 0, 1e3,
          "kl schedule: value that kl_target reaches linearly over total_epochs; 0: it stays constant",
          true)),
      row<&S::kl_factor>(number_option("kl_factor", 1.3, 1, 10,
                                       "kl schedule: factor by which the learning rate changes in an epoch",
                                       true)),
      row<&S::lr_min>(
          number_option("lr_min", 1e-5, 0, kMaxLearningRate, "kl schedule: lowest learning rate", true)),
      row<&S::lr_max>(
          number_option("lr_max", 3e-3, 0, kMaxLearningRate, "kl schedule: highest learning rate", true)),
      row<&S::early_stop_kl>(basic(number_option(
          "early_stop_kl", 0, 0, 1e3,
          "end the passes of an update when the KL over the batch exceeds this; 0: never", true))),
      row<&S::entropy>(basic(number_option("entropy", 0, 0, 1e3, "weight of the entropy bonus", true))),
      row<&S::max_grad_norm>(number_option("max_grad_norm", 1, 0, kHuge,
                                           "bound of each network's gradient norm; 0: no bound", true)),
      row<&S::joint_grad_norm>(legacy(flag_option(
          "joint_grad_norm", false, "apply max_grad_norm to the gradient of all networks together", true))),
      row<&S::value_clip>(legacy(number_option(
          "value_clip", 0, 0, 1e6,
          "critics' loss clips the change of a value since it was collected at this; 0: no clipping", true))),
      row<&S::critic_l2>(number_option("critic_l2", 1e-3, 0, 1e3,
                                       "weight of the sum of the critics' squared parameters in their loss",
                                       true)),
      // demonstrations
      row<&S::warm_epochs>(integer_option(
          "warm_epochs", 0, 0, 1 << 30,
          "number of first epochs in which only the critics learn; the actor and the multipliers stay",
          true)),
      row<&S::imitation>(basic(number_option(
          "imitation", 0, 0, 1e6,
          "weight of staying near a recording (rdm_agent_set_recording) in the actor's loss; 0: none"))),
      row<&S::imitation_decay>(number_option("imitation_decay", 0.99, 0, 1,
                                             "factor on the weight imitation after each epoch", true)),
      // costs
      row<&S::cost_limit>(
          basic(number_option("cost_limit", 25, -1, kHuge,
                              "limit on the sum of cost column 0 over an episode; < 0: no limit", true))),
      row<&S::cost_limit_per_step>(basic(number_option(
          "cost_limit_per_step", -1, -1, kHuge,
          "limit on the mean of cost column 0 per control step; replaces cost_limit; < 0: not used", true))),
      row<&S::episode_steps>(basic(integer_option(
          "episode_steps", 0, 0, INT32_MAX,
          "control steps after which an episode counts as ended; 0: max_steps of the configuration"))),
      row<&S::raw_costs, false, true>(text_option("cost_signal", "flag", "flag|raw",
                                                  "cost that rollouts learn from, and limits apply to: flag: "
                                                  "`cost`; raw: `cost_raw` where above 0")),
      // memory
      row<&S::history>(integer_option(
          "history", 1, 1, kMaxHistory,
          "number of decisions whose observations the networks see: this one and those before it")),
      row<&S::history_fields>(text_option(
          "history_fields", "", nullptr,
          "fields that a history keeps, written as in actor_obs; empty: all that the actor observes",
          kLongestObs)),
      row<&S::memory>(text_option(
          "memory", "", nullptr,
          "memory of the actor: gru:UNITS, a gated recurrent unit before its last layer; empty: none")),
      row<&S::memory_chunk>(
          integer_option("memory_chunk", 16, 1, 1 << 16,
                         "decisions in a row through which the gradient of a memory flows back")),
      // latent
      row<&S::latent>(integer_option(
          "latent", 0, 0, kMaxLatent,
          "numbers that an encoder makes of latent_fields, which the actor reads in their place; 0: none")),
      row<&S::latent_fields>(text_option("latent_fields", "dynamics.*", nullptr,
                                         "fields of the latent, written as in actor_obs", kLongestObs)),
      row<&S::latent_hidden>(text_option("latent_hidden", "64,32", nullptr,
                                         "widths of the hidden layers of the latent's encoder")),
      row<&S::latent_student, false, true>(text_option(
          "latent_from", "fields", "fields|history",
          "what its encoder reads: latent_fields; history: a student's, the only part that then learns")));
}();

// The window alone: a rule with multipliers or one without.
struct WindowOptions {
  int32_t window;
};
inline constexpr auto kWindowRows = option_rows<WindowOptions>(row<&WindowOptions::window>(
    integer_option("multiplier_window", 100, 1, 1000000,
                   "number of last finished episodes over which the mean cost J_c is taken")));

// A rule with a place for each cost, or one that follows a single one.
struct OneCostOptions {
  bool worst;
};
inline constexpr auto kOneCostRows =
    option_rows<OneCostOptions>(row<&OneCostOptions::worst, false, true>(legacy(text_option(
        "several_costs", "refuse", "refuse|worst",
        "if several costs are limited: refuse to start, or follow the most violated one in each epoch"))));

// How a constraint that an episode's sum J_c sets is put in the units of a mean over decisions.
enum class ViolationScale { kStep, kDiscount, kRaw };
struct ViolationOptions {
  ViolationScale scale;
};
inline constexpr auto kViolationRows = option_rows<ViolationOptions>(
    row<&ViolationOptions::scale, ViolationScale::kStep, ViolationScale::kDiscount, ViolationScale::kRaw>(
        legacy(text_option(
            "violation_scale", "step", "step|discount|raw",
            "scale of J_c - limit: step: 1 / decisions of an episode; discount: 1 - discount; raw: 1"))));

// A row of a preset: what it lays under one option.
struct PresetValue {
  const char *preset, *key, *text;
  const char* algos = nullptr;  // "trpo|cpo": for these alone, over a row for all before it; null: for all
};
std::span<const PresetValue> preset_values();

// The values for one agent: table, then config.defaults, then the preset, then config.options. A default
// that only other algorithms know, or of the form "algorithm:key" for another, is skipped, and a set of groups is
// none; an option is not.
// Takes memory from the hooks of the config, once and for each long text.
Options read_options(const AgentConfig& config, const AlgoRow& algo);

}  // namespace rdm

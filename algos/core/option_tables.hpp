// The option tables of the algorithms: shared rows, rows of the clipped loss, rows of the multiplier.
#pragma once
#include <array>
#include <cstddef>
#include <span>

#include "algos/core/agent_types.hpp"

namespace rdm {

inline constexpr int32_t kLongestObs = 1023;  // characters of actor_obs, critic_obs
inline constexpr double kHuge = 1e12, kMaxMultiplier = kHuge, kMaxLearningRate = 10;

// What every algorithm understands.
inline constexpr std::array kSharedOptions = {
    basic(text_option(
        "preset", "default", "default|safe|paper|omnisafe",
        "set of values laid under the options: safe charges falls, paper and omnisafe are the peers'")),
    // networks
    basic(text_option("hidden", "64,64", nullptr,
                      "widths of the hidden layers, at most 4, separated by commas")),
    text_option("critic_hidden", "", nullptr, "the same for the critics; empty: as hidden"),
    text_option("activation", "tanh", "tanh|elu|relu", "of the hidden layers"),
    number_option("last_layer_scale", 0.01, 0, 100, "factor on the actor's initial last layer"),
    basic(text_option(
        "actor_obs", "*", nullptr,
        "what the actor sees: fields by commas, '*', !less; or state, vision, touch, proprioception",
        kLongestObs)),
    text_option("critic_obs", "*", nullptr, "what the critics see, in the same words", kLongestObs),
    // seeing
    basic(text_option(
        "encoder", "", nullptr,
        "widths of a PointNet's layers, 64,128: the last are features for the actor; empty: none")),
    text_option("encoder_activation", "relu", "tanh|elu|relu", "of its layers and features"),
    flag_option("encoder_frozen", false, "it does not learn; its features are computed once, when acting"),
    integer_option("encoder_points", 512, 1, 16384, "points of each cloud"),
    integer_option("encoder_classes", 0, 0, 64,
                   "classes of points, which it sees beside coordinates; 0: none"),
    flag_option("encoder_color", false, "it sees the colours of points"),
    text_option("encoder_origin", "0,0,0", nullptr, "x,y,z in the world, m: where points are 0 to it"),
    number_option("encoder_range", 0.25, 1e-3, 1e3, "distance from there, m, that is 1 to it"),
    // collecting
    basic(integer_option("horizon", 128, 1, 1 << 20, "decisions of each environment per epoch")),
    basic(
        integer_option("action_repeat", 1, 1, 10000, "control steps for which a decision's action is held")),
    number_option("noise_correlation", 0, 0, 0.999,
                  "AR(1) coefficient of the exploration noise over decisions"),
    basic(number_option("init_std", 0.6, 1e-6, 1e3, "initial standard deviation of the action (stationary)")),
    number_option("std_min", 0.01, 1e-6, 1e3, "lower bound on the standard deviation"),
    number_option("std_max", 10, 1e-6, 1e3, "upper bound on the standard deviation"),
    flag_option("learn_std", true, "learn the standard deviation"),
    text_option("std_mode", "free", "free|state",
                "deviation as parameters, or outputs of the actor's network; no gradient at its bounds"),
    text_option("std_schedule", "none", "none|linear",
                "linear: not learned, falls from init_std to std_min over total_epochs"),
    number_option("average", 0, 0, 0.9999,
                  "share of its past in the actor's mean over epochs, which policy files hold; 0: none"),
    basic(flag_option("normalize_obs", true,
                      "subtract the running mean of observations, divide by their deviation")),
    number_option("obs_clip", 5, 0.1, 1e6, "bound on normalised observations"),
    number_option("obs_count_max", 0, 0, kHuge, "samples after which old statistics fade; 0: never"),
    number_option("obs_freeze", 0, 0, kHuge,
                  "samples after which statistics stand still, those of a clone too; 0: never"),
    flag_option("normalize_reward", false,
                "learn from rewards less their running mean, over their deviation"),
    flag_option("normalize_cost", false, "the same for costs; limits hold for costs as they are"),
    number_option("reward_factor", 1, 1e-9, 1e9,
                  "factor on rewards in what is learned; brings values near 1, where the critic learns soon"),
    // returns
    basic(number_option("discount", 0.99, 0, 1, "per control step; a decision has discount^action_repeat")),
    basic(number_option("lambda", 0.95, 0, 1, "of the reward advantage (GAE)")),
    number_option("cost_lambda", 0.95, 0, 1, "of the cost advantages (GAE)"),
    flag_option("standardize_reward_adv", true, "reward advantage to mean 0 and deviation 1 over the batch"),
    legacy(text_option("scale_cost_adv", "center", "center|std",
                       "cost advantages: subtract the mean, or standardise as the authors of FOCOPS do")),
    flag_option(
        "discounted_limit", false,
        "limits hold for discounted sums over an episode, as cost advantages are; else for plain sums"),
    flag_option("terminal_cost", false, "charge a terminated episode's missing steps at its own cost rate"),
    // learning
    basic(integer_option("passes", 10, 1, 10000, "over the data of an epoch")),
    basic(integer_option("minibatches", 4, 1, 1 << 20, "number of minibatches in a pass")),
    integer_option("blocks", 1, 1, 65536,
                   "equal parts of all worlds whose sums meet in a tree: ranks times a power of two"),
    basic(number_option("learning_rate", 3e-4, 0, kMaxLearningRate, "Adam rate of the actor", true)),
    number_option("critic_learning_rate", 0, 0, kMaxLearningRate,
                  "Adam rate of the critics; 0: learning_rate", true),
    basic(text_option(
        "lr_schedule", "constant", "constant|linear|kl",
        "of the actor's rate (linear: of a trust region's radius too): linear falls to 0, kl adapts")),
    legacy(text_option("critic_lr_schedule", "constant", "constant|actor",
                       "of the critics' rate: constant, or in step with the actor's")),
    integer_option("total_epochs", 1000, 1, 1 << 30, "epochs of the linear schedules", true),
    number_option("kl_target", 0.02, 1e-9, 1e3,
                  "kl schedule: the epoch's mean KL is kept in half to twice this", true),
    number_option("kl_target_end", 0, 0, 1e3,
                  "kl schedule: kl_target goes to this, in a line over total_epochs; 0: it stays", true),
    number_option("kl_factor", 1.3, 1, 10, "kl schedule: change of the rate per epoch", true),
    number_option("lr_min", 1e-5, 0, kMaxLearningRate, "kl schedule: lowest rate", true),
    number_option("lr_max", 3e-3, 0, kMaxLearningRate, "kl schedule: highest rate", true),
    basic(number_option("early_stop_kl", 0, 0, 1e3, "stop the passes above this KL over the batch; 0: never",
                        true)),
    basic(number_option("entropy", 0, 0, 1e3, "weight of the entropy bonus", true)),
    number_option("max_grad_norm", 1, 0, kHuge, "bound on each network's gradient norm; 0: none", true),
    legacy(flag_option("joint_grad_norm", false, "max_grad_norm bounds the norm over all networks together",
                       true)),
    legacy(number_option("value_clip", 0, 0, 1e6,
                         "bound on a value's change from the one that acted, in the critics' loss; 0: none",
                         true)),
    number_option("critic_l2", 1e-3, 0, 1e3, "weight of the critics' squared parameters", true),
    // demonstrations
    integer_option("warm_epochs", 0, 0, 1 << 30,
                   "first epochs in which the critics learn alone: actor and multipliers stay", true),
    basic(number_option("imitation", 0, 0, 1e6,
                        "weight of staying near a recording (rdm_agent_set_recording); 0: none")),
    number_option("imitation_decay", 0.99, 0, 1, "factor on that weight per epoch", true),
    // costs
    basic(number_option("cost_limit", 25, -1, kHuge, "limit on column 0's sum over an episode; < 0: none",
                        true)),
    basic(number_option("cost_limit_per_step", -1, -1, kHuge,
                        "limit on column 0's mean per control step, in the place of cost_limit; < 0: none",
                        true)),
    basic(integer_option("episode_steps", 0, 0, INT32_MAX,
                         "control steps after which an episode counts as ended; 0: max_steps of the config")),
    text_option("cost_signal", "flag", "flag|raw",
                "what rollouts take as cost: the pool's, or cost_raw above 0; limits are in its unit"),
};

// The clipped surrogate.
inline constexpr std::array kClipOptions = {
    basic(number_option("clip", 0.2, 1e-6, 10, "bound on the change of the probability ratio", true)),
};

// Lagrange multipliers, one per limited cost.
inline constexpr std::array kMultiplierOptions = {
    legacy(text_option("multiplier_optimizer", "adam", "sgd|adam|softplus",
                       "of the multipliers; softplus: Adam on ln(e^l - 1)")),
    basic(number_option("multiplier_init", 0.001, 0, 1e6, "initial multiplier")),
    basic(number_option("multiplier_lr", 0.035, 0, 1e3, "rate of the multiplier per epoch", true)),
    number_option("multiplier_max", 1e6, 0, kMaxMultiplier, "upper bound on the multiplier", true),
    number_option("multiplier_gain", 0, 0, 1e6,
                  "added to the multiplier per violation: damps its swings (augmented Lagrangian)", true),
    legacy(flag_option("multiplier_normalized", false, "divide the violation by the limit; at most 3")),
    integer_option("multiplier_warmup", 0, 0, 1 << 30, "epochs in which the multiplier's rate grows from 0",
                   true),
    integer_option("multiplier_window", 100, 1, 1000000, "finished episodes that J_c is the mean of"),
};

// Where the cost part of a combined advantage stands.
inline constexpr std::array kSplitOptions = {
    legacy(text_option(
        "cost_loss", "combined", "combined|split",
        "combined: (A_r - l A_c)/(1 + l), clipped; split: cost part unclipped, as Ray et al. have it")),
};

// The window alone, for rules without a multiplier.
inline constexpr std::array kWindowOptions = {
    integer_option("multiplier_window", 100, 1, 1000000, "finished episodes that J_c is the mean of"),
};

// A rule with a place for each cost, or one that follows a single one.
inline constexpr std::array kOneCostOptions = {
    legacy(text_option(
        "several_costs", "refuse", "refuse|worst",
        "with more than one limited cost: refuse, or follow the most violated one in each epoch")),
};

// The trust region: max G x under x (F + damping I) x / 2 <= trust_kl, F by conjugate gradients.
inline constexpr std::array kTrustOptions = {
    basic(number_option("trust_kl", 0.01, 1e-9, 1e3,
                        "bound on the KL of an epoch's policy step; papers have 0.01 to 0.02", true)),
    integer_option("cg_iterations", 15, 1, 1000, "of conjugate gradients, at most", true),
    number_option("cg_tolerance", 1e-6, 0, 1, "residual, relative to the right-hand side, that is enough",
                  true),
    number_option("cg_damping", 0.1, 0, 1e6, "added to the diagonal of the Fisher matrix", true),
    legacy(integer_option("fisher_stride", 1, 1, 1 << 20, "the Fisher matrix is of every n-th sample", true)),
    integer_option("line_search_steps", 15, 1, 1000, "lengths that are tried", true),
    number_option("line_search_decay", 0.8, 0.01, 0.99, "of one length to the next", true),
    legacy(flag_option(
        "kl_mean_over_dims", false,
        "KL and Fisher matrix averaged over action dimensions, as the peers have it; else summed")),
};

// How a constraint that an episode's sum J_c sets is put in the units of a mean over decisions.
inline constexpr std::array kViolationOptions = {
    legacy(text_option("violation_scale", "step", "step|discount|raw",
                       "factor on J_c - limit: 1 / decisions of an episode, 1 - discount, or 1")),
};

// `table` with other defaults, by name.
struct OtherDefault {
  const char* key;
  double number;
  const char* text = nullptr;
};
inline constexpr OtherDefault kTrustDefaults[] = {{"critic_learning_rate", 1e-3}};
template <size_t N, size_t M>
constexpr auto with_defaults(std::array<OptionSpec, N> table, const OtherDefault (&values)[M]) {
  const auto same = [](const char* a, const char* b) {
    while (*a && *a == *b) ++a, ++b;
    return *a == *b;
  };
  for (const OtherDefault& v : values) {
    size_t at = 0;
    while (!same(table.at(at).key, v.key)) ++at;  // past the end: an error of the compiler
    if (v.text)
      table[at].text = v.text;
    else
      table[at].number = v.number;
  }
  return table;
}

template <size_t... N>
constexpr auto join_options(const std::array<OptionSpec, N>&... tables) {
  std::array<OptionSpec, (N + ...)> all{};
  size_t at = 0;
  const auto append = [&](const auto& table) {
    for (const OptionSpec& s : table) all[at++] = s;
  };
  (append(tables), ...);
  return all;
}

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

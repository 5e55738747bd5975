#include "algos/core/option_tables.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "algos/core/algo_row.hpp"
#include "algos/core/groups.hpp"
#include "base/error.hpp"

namespace rdm {
namespace {

constexpr const char* kOwner = "agent";

constexpr const char* kTrustRegion = "trpo|trpo_lag|cpo|pcpo";

// Sources: paper is the code behind the paper's table of hand tasks and the papers of the algorithms,
// omnisafe that library's on-policy defaults with its minibatches of 64 or 128 expressed as a count.
constexpr PresetValue kPresetValues[] = {
    {"safe", "terminal_cost", "true"},
    {"safe", "multiplier_warmup", "20"},
    {"paper", "hidden", "1024,1024,512"},
    {"paper", "critic_hidden", ""},
    {"paper", "activation", "elu"},
    {"paper", "last_layer_scale", "0.01"},
    {"paper", "horizon", "8"},
    {"paper", "action_repeat", "1"},
    {"paper", "noise_correlation", "0"},
    {"paper", "init_std", "0.8"},
    {"paper", "std_schedule", "none"},
    {"paper", "average", "0"},
    {"paper", "actor_obs", "*"},
    {"paper", "critic_obs", "*"},
    {"paper", "discount", "0.99"},
    {"paper", "lambda", "0.95"},
    {"paper", "cost_lambda", "0.95"},
    {"paper", "scale_cost_adv", "std"},
    {"paper", "passes", "5"},
    {"paper", "minibatches", "4"},
    {"paper", "learning_rate", "3e-4"},
    {"paper", "critic_learning_rate", "0"},
    {"paper", "lr_schedule", "kl"},
    {"paper", "kl_target", "0.016"},
    {"paper", "kl_target_end", "0"},
    {"paper", "kl_factor", "1.5"},
    {"paper", "lr_min", "1e-5"},
    {"paper", "lr_max", "1e-2"},
    {"paper", "early_stop_kl", "0"},
    {"paper", "entropy", "0"},
    {"paper", "max_grad_norm", "1"},
    {"paper", "critic_l2", "0"},
    {"paper", "clip", "0.2"},
    {"paper", "multiplier_optimizer", "softplus"},
    {"paper", "multiplier_init", "0.6932"},
    {"paper", "multiplier_lr", "0.05"},
    {"paper", "multiplier_normalized", "false"},
    {"paper", "trust_kl", "0.02"},
    {"paper", "cg_damping", "0.1"},
    {"paper", "cg_iterations", "10"},
    {"paper", "penalty", "1"},
    {"paper", "penalty_growth", "1.05"},
    {"paper", "penalty_max", "20"},
    {"paper", "violation_scale", "discount"},
    {"paper", "multiplier_optimizer", "sgd", "focops"},
    {"paper", "multiplier_init", "0", "focops"},
    {"paper", "multiplier_lr", "0.01", "focops"},
    {"paper", "kl_target", "0.02", "focops"},
    {"paper", "pid_kp", "0.01"},
    {"omnisafe", "hidden", "64,64"},
    {"omnisafe", "critic_hidden", ""},
    {"omnisafe", "activation", "tanh"},
    {"omnisafe", "last_layer_scale", "1"},
    {"omnisafe", "action_repeat", "1"},
    {"omnisafe", "noise_correlation", "0"},
    {"omnisafe", "init_std", "1"},
    {"omnisafe", "std_schedule", "none"},
    {"omnisafe", "average", "0"},
    {"omnisafe", "actor_obs", "*"},
    {"omnisafe", "critic_obs", "*"},
    {"omnisafe", "discount", "0.99"},
    {"omnisafe", "lambda", "0.95"},
    {"omnisafe", "cost_lambda", "0.95"},
    {"omnisafe", "scale_cost_adv", "center"},
    {"omnisafe", "passes", "40"},
    {"omnisafe", "learning_rate", "3e-4"},
    {"omnisafe", "critic_learning_rate", "0"},
    {"omnisafe", "lr_schedule", "linear"},
    {"omnisafe", "early_stop_kl", "0.02"},
    {"omnisafe", "entropy", "0"},
    {"omnisafe", "max_grad_norm", "40"},
    {"omnisafe", "critic_l2", "1e-3"},
    {"omnisafe", "clip", "0.2"},
    {"omnisafe", "multiplier_optimizer", "adam"},
    {"omnisafe", "multiplier_init", "0.001"},
    {"omnisafe", "multiplier_lr", "0.035"},
    {"omnisafe", "multiplier_normalized", "false"},
    {"omnisafe", "multiplier_divide", "true"},
    {"omnisafe", "passes", "10", "p3o"},
    {"omnisafe", "passes", "10", "ipo"},
    {"omnisafe", "passes", "10", kTrustRegion},
    {"omnisafe", "critic_learning_rate", "1e-3", kTrustRegion},
    {"omnisafe", "lr_schedule", "constant", kTrustRegion},
    {"omnisafe", "trust_kl", "0.01"},
    {"omnisafe", "kl_mean_over_dims", "true"},
    {"omnisafe", "cg_iterations", "15"},
    {"omnisafe", "cg_damping", "0.1"},
    {"omnisafe", "line_search_steps", "20", "cpo"},
    {"omnisafe", "line_search_steps", "200", "pcpo"},
    {"omnisafe", "violation_scale", "raw"},
    {"omnisafe", "penalty", "20"},
    {"omnisafe", "penalty_growth", "1"},
    {"omnisafe", "penalty_clip", "false"},
    {"omnisafe", "barrier_kappa", "0.01"},
    {"omnisafe", "barrier_max", "1"},
    {"omnisafe", "normalize_reward", "true", "ipo"},
    {"omnisafe", "normalize_cost", "true", "ipo"},
    {"omnisafe", "pid_kp", "0.1"},
    {"omnisafe", "pid_ki", "0.01"},
    {"omnisafe", "pid_kd", "0.01"},
};

// `name` is one of the algorithms "a|b|c".
bool among_names(const char* algos, const char* name) {
  const size_t size = std::strlen(name);
  for (const char* p = algos; *p;) {
    const char* end = std::strchr(p, '|');
    const size_t n = end ? static_cast<size_t>(end - p) : std::strlen(p);
    if (n == size && std::memcmp(p, name, n) == 0) return true;
    p += n + (end ? 1 : 0);
  }
  return false;
}

bool is_listed(const char* algos, const AlgoRow& algo) {
  return among_names(algos, algo.info.name) || (algo.alone && among_names(algos, algo.alone->info.name));
}

bool knows(const AlgoInfo& algo, const char* key) {
  for (int32_t k = 0; k < algo.num_options; ++k)
    if (same_name(algo.options[k].key, key)) return true;
  return false;
}

// The first algorithm that has such an option; null: none has.
const AlgoInfo* algo_with(const char* key) {
  for (int32_t i = 0; i < algo_count(); ++i)
    if (knows(algo_at(i), key)) return &algo_at(i);
  return nullptr;
}

// Says of an unknown key that another algorithm has it, where one has.
void explain_unknown(const AgentConfig& config, const Options& o, const AlgoInfo& algo) {
  const auto look = [&](const char* key) {
    if (!key || o.knows(key)) return;
    if (const AlgoInfo* other = algo_with(key))
      fail(Code::kNotFound, "%s option %s: %s has no such option; %s has", kOwner, key, algo.name,
           other->name);
  };
  for (int32_t i = 0; i < config.num_options; ++i) look(config.options[i].key);
  for (const char* line = config.settings; line && *line;) {
    char key[64];
    line += std::strspn(line, " \t\r\n");
    const size_t size = std::strcspn(line, " \t\r\n=");
    std::snprintf(key, sizeof key, "%.*s", static_cast<int>(std::min(size, sizeof key)), line);
    look(key);
    line += std::strcspn(line, "\n");
  }
}

// What holds for `owner` holds for the algorithm: it is that one, or for one agent would be.
bool is_or_extends(const AlgoRow& algo, const char* owner) {
  return same_name(algo.info.name, owner) || (algo.alone && same_name(algo.alone->info.name, owner));
}

// "focops:passes" names an algorithm and is for that one, and for those that extend it. False: for another, or for
// shields.
bool take_owner(const AlgoRow& algo, OptionInput& in) {
  const char* colon = std::strchr(in.key, ':');
  if (!colon) return true;
  if (shield_key(in.key)) return false;
  char name[64];
  std::snprintf(name, sizeof name, "%.*s", static_cast<int>(colon - in.key), in.key);
  const AlgoInfo& owner = algo_at(algo_find(name));
  in.key = colon + 1;
  if (!knows(owner, in.key))
    fail(Code::kNotFound, "%s default: algorithm \"%s\" has no option \"%s\"", kOwner, name, in.key);
  return is_or_extends(algo, owner.name);
}

// What tasks and presets say of these they say to learners that forget what they did: how much to collect before an
// update, and rates that fit it. A replay memory has its own, or "sac:horizon" in a task.
bool for_on_policy(const char* key) {
  for (const char* own :
       {"horizon", "hidden", "critic_hidden", "activation", "last_layer_scale", "init_std", "std_min",
        "std_max", "learning_rate", "critic_learning_rate", "max_grad_norm", "average"})
    if (same_name(key, own)) return true;
  for (const char* own : {"multiplier_", "pid_"})
    if (std::strncmp(key, own, std::strlen(own)) == 0) return true;
  return false;
}

void lay_default(Options& o, const AlgoRow& algo, OptionInput in) {
  if (!in.key) fail(Code::kArgument, "%s default: its key is NULL", kOwner);
  if (is_group_set(in.key)) return;
  if (algo.off_policy && for_on_policy(in.key)) return;
  if (!take_owner(algo, in)) return;
  if (!o.knows(in.key)) {
    if (!algo_with(in.key)) o.set(in, kOwner);  // names the nearest key
    return;
  }
  if (in.text)
    o.set_default(in.key, in.text);
  else
    o.set_default(in.key, in.number);
}

void lay_preset(Options& o, const AgentConfig& config, const AlgoRow& algo) {
  const SharedOptions below = read_shared_options(o, algo);
  // Without the length of an episode there is nothing to charge.
  const bool length = config.max_steps > 0 || below.episode_steps > 0;
  for (const PresetValue& v : kPresetValues) {
    if (same_name(v.key, "terminal_cost") && !length) continue;
    if (v.algos ? !is_listed(v.algos, algo) : algo.off_policy && for_on_policy(v.key)) continue;
    if (same_name(v.preset, below.preset) && o.knows(v.key)) o.set_default(v.key, v.text);
  }
  if (same_name(below.preset, "omnisafe") && o.knows("minibatches")) {
    const int64_t rows = int64_t{kSharedRows.read(o).horizon} * config.num_envs;
    const int64_t size = is_listed(kTrustRegion, algo) ? 128 : 64;
    o.set_default("minibatches", static_cast<double>(std::clamp<int64_t>(rows / size, 1, 1 << 20)));
  }
}

}  // namespace

SharedOptions read_shared_options(const Options& options, const AlgoRow& row) {
  return row.shared ? row.shared(options) : kSharedRows.read(options);
}

std::span<const PresetValue> preset_values() {
  return kPresetValues;
}

Options read_options(const AgentConfig& config, const AlgoRow& row) {
  const AlgoInfo& algo = row.info;
  const HostScope scope(config.hooks);
  Options o;
  o.reserve(algo.num_options);
  o.add_table(algo.options, algo.num_options);
  try {
    o.set_all(config.options, config.num_options, config.settings, kOwner);
  } catch (const Error& e) {
    if (e.code == Code::kNotFound) explain_unknown(config, o, algo);
    throw;
  }
  for (int32_t i = 0; i < config.num_defaults; ++i) lay_default(o, row, config.defaults[i]);
  lay_preset(o, config, row);
  // A schedule that nobody asked for gives way.
  if (read_shared_options(o, row).state_std && o.knows("std_schedule")) o.set_default("std_schedule", "none");
  return o;
}

}  // namespace rdm

#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include "common/setup.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>

#include "common/json.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/objects.hpp"
#include "common/robots.hpp"
#include "common/setting.hpp"
#include "common/task_files.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

double limit_number(const std::string& text, const std::string& whole) {
  double value = 0;
  if (!read_number(text, &value))
    throw Usage("--cost-limit " + whole + ": it is not a number or name=number");
  return value;
}

void append_keys(const std::vector<rdm_option_spec>& table, std::vector<std::string>& keys) {
  for (const rdm_option_spec& o : table) keys.push_back(o.key);
}

}  // namespace

std::pair<std::string, std::string> split_pair(const std::string& text, const char* flag) {
  const size_t at = text.find('=');
  if (at == 0 || at == std::string::npos)
    throw Usage(std::string(flag) + " " + text + ": it is not key=value");
  return {text.substr(0, at), text.substr(at + 1)};
}

void GivenOnce::add(const std::string& key, const std::string& where) {
  for (const std::string& before : keys_)
    if (same_name(before, key)) throw Usage(where + ": option " + key + " is given twice; give it once");
  keys_.push_back(key);
}

std::string with_flags(std::string text) {
  // a number follows where a flag is wrong: "obs_dim: the policy has 24, ..." is of no flag
  static const std::pair<std::regex, const char*> kFlags[] = {
      {std::regex("(^|: )num_envs: (?=-?\\d)"), "$1--envs: "},
      {std::regex("(^|: )(config\\.)?num_threads: "), "$1--threads: "},
      {std::regex("^obs_dim: (?=-?\\d)"), "--obs: "},
      {std::regex("^action_dim: (?=-?\\d)"), "--act: "},
      {std::regex("(^|: )cost_limits(?=\\[|: \\w+ needs)"), "$1--cost-limit"},
      {std::regex("set config\\.max_steps or option"), "set option"},
      {std::regex("config\\.fields is empty"), "there are none"},
      {std::regex("call rdm_agent_set_recording first"), "redman train --from gives one"},
      {std::regex("\\bconfig\\.slide_range\\b"), "--slide-range"},
      {std::regex("\\bconfig\\.(density|flange|mount|name|packages|palm|policy|root|tips)\\b"), "--$1"}};
  for (const auto& [member, flag] : kFlags) text = std::regex_replace(text, member, flag);
  return text;
}

CLI::Validator finite_to(double most) {
  return CLI::Validator(
      [most](const std::string& text) {
        double value = 0;
        return read_number(text, &value) && value <= most
                   ? std::string()
                   : text + " is not a number up to " + number_text(most);
      },
      "");
}

std::vector<rdm_option> raw_options(const Options& options) {
  std::vector<rdm_option> raw;
  for (const auto& [key, value] : options) raw.push_back({key.c_str(), value.c_str(), 0});
  return raw;
}

CLI::Option* add_task_flag(CLI::App& command, std::string& task, const char* names, const char* help) {
  add_robot_flag(command);  // before: the task may be made of them
  add_object_flag(command);
  return command.add_option(names, task, help)
      ->transform(CLI::Validator(
          [](std::string& word) {
            word = task_name(word);
            return std::string();
          },
          ""));
}

void add_envs_flag(CLI::App& command, PoolSettings& pool) {
  command.add_option("--envs,--num-envs", pool.envs, "number of worlds that are simulated together")
      ->check(at_least(1))
      ->each([&pool](const std::string&) { pool.envs_given = true; });
}

void say_worlds(const PoolSettings& pool, int32_t episodes) {
  if (pool.envs_given && pool.envs > episodes)
    std::fprintf(stderr, "--envs %d: only as many worlds are used as there are episodes, %d\n", pool.envs,
                 episodes);
}

namespace {

// The name of column 0, which a task of one's own may call as it likes; "": it has no costs.
std::string name_of_first(const std::string& task) {
  const std::vector<rdm_cost_info> costs = task_costs(find_task(task));
  return costs.empty() ? "" : costs[0].name;
}

// The column that a text of --cost-limit names: one without a name is for column 0.
std::string column_of_limit(const std::string& task, const std::string& text) {
  const size_t sign = text.find('=');
  return sign == text.npos ? name_of_first(task) : text.substr(0, sign);
}

}  // namespace

void take_limit_from_sets(const std::string& task, std::vector<std::string>& sets,
                          std::vector<std::string>& limits) {
  const auto is_limit = [](const std::string& s) {
    return same_name(s.substr(0, s.find('=')), "cost_limit") && s.find('=') != s.npos;
  };
  for (const std::string& s : sets) {
    if (!is_limit(s)) continue;
    for (const std::string& limit : limits)
      if (limits_first(task, limit))
        throw Usage("--cost-limit " + limit + " and --set " + s +
                    ": both are the limit on column 0; give one");
    limits.push_back(s.substr(s.find('=') + 1));
  }
  sets.erase(std::remove_if(sets.begin(), sets.end(), is_limit), sets.end());
  need_one_limit_each(task, limits);
}

bool limits_first(const std::string& task, const std::string& text) {
  return same_name(column_of_limit(task, text), name_of_first(task));
}

void need_one_limit_each(const std::string& task, const std::vector<std::string>& limits) {
  for (size_t i = 0; i < limits.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (const std::string column = column_of_limit(task, limits[i]);
          same_name(column, column_of_limit(task, limits[k])))
        throw Usage("--cost-limit: column " + column + " has two limits, " + limits[k] + " and " + limits[i]);
}

int64_t whole_number(double value, const std::string& flag) {
  if (!(value >= 1 && value <= static_cast<double>(kMostExact)) || value != std::floor(value))
    throw Usage(flag + ' ' + number_text(value) + ": it is not a whole number of 1 .. " +
                std::to_string(kMostExact));
  return static_cast<int64_t>(value);
}

void say_budget(const PoolSettings& pool, const std::vector<std::string>& limits) {
  bool budget = false;
  for (const auto& [key, value] : pool.options) {
    budget |= same_name(key, "budget") && !same_name(value, "none");
    if (same_name(key, "limit") || same_name(key, "limit_range")) return;
  }
  for (const std::string& text : limits) {
    if (budget && limits_first(pool.task, text))
      std::fprintf(
          stderr, "--cost-limit %s: option budget has a limit of its own, which stays; give --set limit=%s\n",
          text.c_str(), text.substr(text.find('=') + 1).c_str());
  }
}

CLI::Option* add_pool_flags(CLI::App& command, PoolSettings& pool, const char* task_help) {
  CLI::Option* task = add_task_flag(command, pool.task, "--task,--env-id", task_help);
  add_envs_flag(command, pool);
  command.add_option("--threads", pool.threads, "number of threads; 0: the calling thread alone");
  command.add_option("--seed", pool.seed, "seed of the worlds");
  return task;
}

void give_eyes(int32_t points, int32_t repeat, const std::string& color, PoolSettings& pool) {
  const Options own = {{"modality", "points"},
                       {"points", std::to_string(points)},
                       {"sampling", "voxel"},
                       {"point_color", color},
                       {"sense_every", std::to_string(repeat)}};
  pool.options.insert(pool.options.begin(), own.begin(), own.end());
}

namespace {

Options defaults_of(const std::vector<rdm_option_spec>& table) {
  Options values;
  for (const rdm_option_spec& o : table) values.emplace_back(o.key, default_text(o));
  return values;
}

// Of the algorithm's options in this task, a later one over an earlier one: the table's defaults, the task's own, those that
// are given.
Options agent_values(const AgentSettings& agent, const std::string& task) {
  Options values = defaults_of(algo_options(find_algo(agent.algo)));
  for (const rdm_option& o : task_defaults(find_task(task))) {
    const std::string key = o.key;
    const size_t colon = key.find(':');  // "sac:horizon" is for that algorithm alone
    if (colon == key.npos || same_name(key.substr(0, colon), agent.algo))
      values.emplace_back(key.substr(colon + 1), o.text ? o.text : number_text(o.number));
  }
  values.insert(values.end(), agent.options.begin(), agent.options.end());
  return values;
}

}  // namespace

void give_eyes(const AgentSettings& agent, PoolSettings& pool) {
  const Options values = agent_values(agent, pool.task);
  const auto value = [&](const char* key) { return option_of(values, key); };
  if (value("encoder").empty()) return;
  const auto whole = [&](const char* key) {
    return std::max(1, static_cast<int32_t>(std::strtol(value(key).c_str(), nullptr, 10)));
  };
  give_eyes(whole("encoder_points"), whole("action_repeat"), value("encoder_color"), pool);
}

bool learns_magnitudes(const AgentSettings& agent) {
  bool raw = false;
  for (const auto& [key, value] : agent.options)
    if (same_name(key, "cost_signal")) raw = same_name(value, "raw");
  return raw;
}

PoolSettings counted(PoolSettings pool) {
  if (!pool.magnitudes) return pool;
  Options& o = pool.options;
  o.erase(std::remove_if(o.begin(), o.end(),
                         [](const auto& each) { return same_name(each.first, "action_repeat"); }),
          o.end());
  o.emplace_back("action_repeat", "1");
  return pool;
}

CLI::Option* add_set_flag(CLI::App& command, std::vector<std::string>& sets) {
  return command
      .add_option(
          "--set", sets,
          "option of the task or the algorithm (`redman tasks NAME`, `redman algos NAME`); repeatable")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
}

void add_cost_limit_flag(CLI::App& command, std::vector<std::string>& limits) {
  command
      .add_option("--cost-limit,--cost-lim", limits,
                  "limit on the mean sum of a cost over an episode: LIMIT for column 0, NAME=LIMIT for "
                  "another one; a negative LIMIT: none; repeatable")
      ->allow_extra_args(false)
      ->type_name("[NAME=]LIMIT");
}

namespace {

// Of a key that is spelled as an algorithm's option, which algorithm has it.
std::string algo_hint(const std::string& key) {
  for (int32_t i = 0; i < rdm_algo_count(); ++i)
    if (has_option(algo_options(i), key)) return std::string("; algorithm ") + algo_at(i).name + " has";
  return "";
}

// What other libraries call an option or a flag of ours.
constexpr const char* kElsewhere[][2] = {{"gamma", "discount"},
                                         {"lr", "learning_rate"},
                                         {"actor_lr", "learning_rate"},
                                         {"critic_lr", "critic_learning_rate"},
                                         {"gae_lambda", "lambda"},
                                         {"lam", "lambda"},
                                         {"lam_c", "cost_lambda"},
                                         {"cost_gamma", "discount"},
                                         {"clip_range", "clip"},
                                         {"clip_ratio", "clip"},
                                         {"batch_size", "minibatches"},
                                         {"batch_size", "batch_rows"},
                                         {"n_steps", "horizon"},
                                         {"steps_per_epoch", "horizon"},
                                         {"n_epochs", "passes"},
                                         {"update_iters", "passes"},
                                         {"ent_coef", "entropy"},
                                         {"entropy_coef", "entropy"},
                                         {"target_kl", "trust_kl"},
                                         {"target_kl", "early_stop_kl"},
                                         {"buffer_size", "replay_rows"},
                                         {"hidden_sizes", "hidden"},
                                         {"net_arch", "hidden"},
                                         {"lagrangian_multiplier_init", "multiplier_init"},
                                         {"lambda_lr", "multiplier_lr"},
                                         {"max_episode_steps", "max_steps"},
                                         {"episode_length", "max_steps"},
                                         {"frame_skip", "action_repeat"},
                                         {"seed", "--seed"},
                                         {"envs", "--envs"},
                                         {"num_envs", "--envs"},
                                         {"threads", "--threads"},
                                         {"steps", "--steps"},
                                         {"total_steps", "--steps"},
                                         {"total_timesteps", "--steps"},
                                         {"shield", "--shield"}};

// "; here it is called discount", of `keys`, or "; it is the flag --seed"; "" where nothing is known.
std::string elsewhere_hint(const std::string& key, const std::vector<std::string>& keys) {
  for (const auto& [theirs, ours] : kElsewhere) {
    if (!same_name(key, theirs)) continue;
    if (ours[0] == '-') return std::string("; it is the flag ") + ours;
    if (std::find(keys.begin(), keys.end(), ours) != keys.end())
      return std::string("; here it is called ") + ours;
  }
  return "";
}

// Whether `value` may be the option's: one of its words, where it has words.
bool takes(const std::vector<rdm_option_spec>& table, const std::string& key, const std::string& value) {
  for (const rdm_option_spec& o : table) {
    if (!same_name(o.key, key) || o.kind != RDM_KIND_TEXT || !o.choices) continue;
    const std::vector<std::string> words = words_of(o.choices, "|");
    return std::any_of(words.begin(), words.end(), [&](const auto& word) { return same_name(word, value); });
  }
  return true;
}

// The owner, of a task and an algorithm that both have option `key`: who has the word `value`.
struct Owner {
  bool task, algo;
};
Owner owner_of(const std::vector<rdm_option_spec>& task, const std::vector<rdm_option_spec>& algo,
               const std::string& key, const std::string& value) {
  // how often an agent decides is the agent's: a pool that repeats would only show less of its worlds
  if (same_name(key, "action_repeat")) return {false, true};
  const Owner owner{takes(task, key, value), takes(algo, key, value)};
  return owner.task || owner.algo ? owner : Owner{true, true};  // neither: each names its words
}

bool is_of_robot(const std::string& key) {
  return same_name(key.substr(0, 6), "joint.") || same_name(key.substr(0, 5), "link.");
}

// The keys that a pool has with what the task's table knows of `sets`: its robots decide on those of joints and links.
std::vector<std::string> keys_of_robots(const PoolSettings& pool, const std::vector<std::string>& sets,
                                        const std::vector<rdm_option_spec>& task_table) {
  PoolSettings one = pool;
  one.envs = 1, one.threads = 0;
  for (const std::string& text : sets)
    if (const auto pair = split_pair(text, "--set");
        has_option(task_table, pair.first) && !is_of_robot(pair.first))
      one.options.push_back(pair);
  std::vector<std::string> keys;
  for (const auto& [key, value] : pool_settings(make_pool(one, RDM_AUTORESET_OFF))) keys.push_back(key);
  return keys;
}

}  // namespace

void apply_sets(const std::vector<std::string>& sets, PoolSettings& pool, AgentSettings* agent,
                std::string (*more)(const std::string&)) {
  const auto task_table = task_options(find_task(pool.task));
  const auto algo_table = agent ? algo_options(find_algo(agent->algo)) : std::vector<rdm_option_spec>();
  GivenOnce to_task, to_algo;
  std::vector<std::string> own;  // keys of joints and links of the robots that `sets` choose
  for (const std::string& text : sets) {
    const auto pair = split_pair(text, "--set");
    if (printable(text) != text)
      throw Usage("--set " + text + ": it has control characters, or is not UTF-8");
    bool of_algo = has_option(algo_table, pair.first), of_task = has_option(task_table, pair.first);
    if (!of_algo && !of_task && is_of_robot(pair.first)) {
      if (own.empty()) own = keys_of_robots(pool, sets, task_table);
      of_task =
          std::any_of(own.begin(), own.end(), [&](const auto& key) { return same_name(key, pair.first); });
    }
    if (of_algo && of_task) {
      const Owner owner = owner_of(task_table, algo_table, pair.first, pair.second);
      of_task = owner.task, of_algo = owner.algo;
    }
    if (of_task) to_task.add(pair.first, "--set " + text), pool.options.push_back(pair);
    if (of_algo) to_algo.add(pair.first, "--set " + text), agent->options.push_back(pair);
    if (of_task || of_algo) continue;
    std::vector<std::string> keys;
    append_keys(task_table, keys);
    append_keys(algo_table, keys);
    keys.insert(keys.end(), own.begin(), own.end());
    const std::string owner =
        agent ? "neither task " + pool.task + " nor algorithm " + agent->algo + " has option "
              : "task " + pool.task + " has no option ";
    std::string hint = agent ? algo_hint(pair.first) : "";
    if (hint.empty()) hint = elsewhere_hint(pair.first, keys);
    if (hint.empty()) hint = nearest_hint(pair.first, keys);
    throw Usage("--set " + text + ": " + owner + pair.first + hint + (more ? more(pair.first) : ""));
  }
}

void refuse_flags(const std::vector<std::string>& sets, std::initializer_list<const char*> keys) {
  for (const std::string& text : sets)
    for (const char* key : keys)
      if (same_name(split_pair(text, "--set").first, key))
        throw Usage("--set " + text + ": here it is a flag; give --" + key);
}

namespace {

// Options that do nothing unless another one has one of these words; "": any but an empty one and 0.
struct Belongs {
  const char *key, *to, *words;
};
constexpr const char *kImages = "rgb depth segmentation", *kClouds = "points voxels",
                     *kSensors = "rgb depth segmentation points voxels", *kBudgets = "show saute simmer end";
constexpr Belongs kOfTasks[] = {{"cameras", "modality", kImages},
                                {"image_width", "modality", kImages},
                                {"image_height", "modality", kImages},
                                {"cloud_cameras", "modality", kClouds},
                                {"cloud_width", "modality", kClouds},
                                {"cloud_height", "modality", kClouds},
                                {"cloud_range", "modality", kClouds},
                                {"points", "modality", "points"},
                                {"sampling", "modality", "points"},
                                {"sampling_voxel", "sampling", "voxel"},
                                {"point_noise", "modality", kClouds},
                                {"point_dropout", "modality", "points"},
                                {"point_color", "modality", "points"},
                                {"voxels", "modality", "voxels"},
                                {"voxel_size", "modality", "voxels"},
                                {"sense_every", "modality", kSensors},
                                {"budget_discount", "budget", kBudgets},
                                {"unsafe_reward", "budget", "saute simmer"},
                                {"simmer_start", "budget", "simmer"},
                                {"simmer_steps", "budget", "simmer"},
                                {"hull", "object", "hull"}};
constexpr Belongs kOfAlgos[] = {{"encoder_activation", "encoder", ""}, {"encoder_frozen", "encoder", ""},
                                {"encoder_points", "encoder", ""},     {"encoder_classes", "encoder", ""},
                                {"encoder_color", "encoder", ""},      {"encoder_origin", "encoder", ""},
                                {"encoder_range", "encoder", ""},      {"memory_chunk", "memory", ""},
                                {"latent_fields", "latent", ""},       {"latent_hidden", "latent", ""},
                                {"latent_from", "latent", ""}};

void say_idle_of(const std::string& text, const Belongs& b, const Options& values) {
  const std::string value = option_of(values, b.to);
  const std::vector<std::string> words = words_of(b.words, " "), parts = words_of(value, "+");
  const bool works = words[0].empty() ? !value.empty() && value != "0"
                                      : std::any_of(parts.begin(), parts.end(), [&](const auto& part) {
                                          return std::any_of(words.begin(), words.end(), [&](const auto& w) {
                                            return same_name(w, part);
                                          });
                                        });
  if (!works)
    std::fprintf(stderr, "--set %s: it has no effect while %s is %s\n", printable(text).c_str(), b.to,
                 value.empty() ? "empty" : printable(value).c_str());
}

}  // namespace

void say_idle(const std::vector<std::string>& sets, const PoolSettings& pool, const AgentSettings* agent) {
  const bool chooses =
      has_option(task_options(find_task(pool.task)), "hand");  // a task of text names its robots itself
  for (const auto& [file, robot] : given_robots()) {
    rdm_robot info = RDM_INIT(rdm_robot);
    redman::check(rdm_robot_at(robot, &info));
    const bool used =
        std::any_of(pool.options.begin(), pool.options.end(), [&, number = robot](const auto& o) {
          int32_t named = -1;
          return rdm_robot_find(o.second.c_str(), &named) == RDM_OK && named == number;
        });
    if (chooses && !used)
      std::fprintf(stderr, "--robot %s: nothing uses robot %s; give --set hand=%s, or arm=%s\n",
                   printable(file).c_str(), info.name, info.name, info.name);
    else if (!chooses && own_files(pool.task).task.empty())
      std::fprintf(stderr, "--robot %s: task %s takes no robot\n", printable(file).c_str(),
                   printable(pool.task).c_str());
  }
  Options of_task = defaults_of(task_options(find_task(pool.task)));
  of_task.insert(of_task.end(), pool.options.begin(), pool.options.end());
  const Options of_algo = agent ? agent_values(*agent, pool.task) : Options();
  for (const std::string& text : sets) {
    const std::string key = split_pair(text, "--set").first;
    for (const Belongs& b : kOfTasks)
      if (same_name(key, b.key)) say_idle_of(text, b, of_task);
    for (const Belongs& b : kOfAlgos)
      if (agent && same_name(key, b.key)) say_idle_of(text, b, of_algo);
  }
}

redman::Pool make_pool(const PoolSettings& settings, int32_t autoreset) {
  auto config = redman::pool_config(settings.task.c_str(), settings.envs);
  const auto options = raw_options(settings.options);
  config.seed = settings.seed;
  config.num_threads = settings.threads;
  config.autoreset = autoreset;
  config.options = options.data();
  config.num_options = static_cast<int32_t>(options.size());
  return as_usage([&] { return redman::Pool(config); });
}

redman::Agent make_agent(const AgentSettings& settings, const redman::Pool& pool,
                         const std::vector<double>& limits, uint64_t seed, int32_t threads,
                         const rdm_ranks* ranks) {
  auto config = redman::agent_config(pool);
  const auto options = raw_options(settings.options);
  config.algo = settings.algo.c_str();
  config.seed = seed;
  config.num_threads = threads;
  config.cost_limits = limits.data();
  config.options = options.data();
  config.num_options = static_cast<int32_t>(options.size());
  return as_usage([&] {
    if (!ranks) return redman::Agent(config);
    rdm_agent* agent = nullptr;
    redman::check(rdm_agent_create_ranked(&agent, &config, ranks));
    return redman::Agent(agent);
  });
}

bool has_option(const std::string& algo, const char* wanted) {
  const int32_t index = find_algo(algo);
  for (int32_t i = 0; i < algo_at(index).num_options; ++i) {
    rdm_option_spec spec{};
    spec.struct_size = sizeof spec;
    redman::check(rdm_algo_option_at(index, i, &spec));
    if (same_name(spec.key, wanted)) return true;
  }
  return false;
}

std::vector<double> cost_limits(const redman::Pool& pool, const std::vector<std::string>& texts) {
  const auto costs = task_costs(pool.spec().task);
  const auto config = redman::agent_config(pool);
  std::vector<double> limits(config.cost_limits, config.cost_limits + costs.size());
  for (const std::string& text : texts) {
    if (costs.empty()) throw Usage("--cost-limit " + text + ": the task has no costs");
    if (text.find('=') == std::string::npos) {
      limits[0] = limit_number(text, text);
      continue;
    }
    const auto [name, value] = split_pair(text, "--cost-limit");
    std::vector<std::string> names;
    size_t column = costs.size();
    for (size_t i = 0; i < costs.size(); ++i) {
      names.push_back(costs[i].name);
      if (same_name(name, costs[i].name)) column = i;
    }
    if (column == costs.size())
      throw Usage("--cost-limit " + text + ": there is no cost column " + name + ", but " +
                  joined(names, ", ") + nearest_hint(name, names));
    limits[column] = limit_number(value, text);
  }
  return limits;
}

}  // namespace tool

#include "run/config.hpp"

#include <cmath>
#include <functional>

#include "common/json.hpp"
#include "common/names.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr double kMostLimit = 1e300;

std::vector<std::string> as_sets(const Options& options) {
  std::vector<std::string> out;
  for (const auto& [key, value] : options) out.push_back(key + "=" + value);
  return out;
}

Options from_sets(const std::vector<std::string>& sets, const char* member) {
  Options out;
  try {
    for (const std::string& text : sets) out.push_back(split_pair(text, member));
  } catch (const Usage& e) {
    throw Failure(e.what());
  }
  return out;
}

ShieldWord shield_at(const Document& object, const char* key) {
  try {
    return read_shield_word(text_at(object, key));
  } catch (const Usage& e) {
    throw Failure(e.what());
  }
}

// A file's text as it was, tabs and all: who reads it judges it.
std::string file_at(const Document& object, const std::string& key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) throw Failure(key + ": it is not a string");
  return found->get<std::string>();
}

// Every option as it stands, of lines key=value.
Json values_json(const std::string& settings) {
  Json out = Json::object();
  for (const auto& [key, value] : read_settings(settings)) out[key] = value;
  return out;
}

}  // namespace

namespace {

Json teach_json(const TeachSettings& t) {
  return {{"from", t.from},
          {"decisions", t.decisions},
          {"noise", t.noise},
          {"success_only", t.success_only},
          {"clone_epochs", t.clone_epochs},
          {"clone_patience", t.clone_patience},
          {"clone_rate", t.clone_rate},
          {"validation", t.validation},
          {"pretrain", t.pretrain},
          {"pretrain_epochs", t.pretrain_epochs},
          {"dagger", t.dagger},
          {"beta", t.beta},
          {"start_share", t.start_share},
          {"start_share_end", t.start_share_end}};
}

TeachSettings parse_teach(const Document& json) {
  TeachSettings t;
  t.from = text_at(json, "from");
  t.decisions = static_cast<int32_t>(integer_at(json, "decisions", 1, 1 << 24));
  t.noise = number_at(json, "noise", 0, 10);
  t.success_only = flag_at(json, "success_only");
  t.clone_epochs = static_cast<int32_t>(integer_at(json, "clone_epochs", 1, 100000));
  t.clone_patience = static_cast<int32_t>(integer_at(json, "clone_patience", 0, 100000));
  t.clone_rate = number_at(json, "clone_rate", 0, 10);
  t.validation = number_at(json, "validation", 0, 0.9);
  if (json.contains("pretrain")) {
    t.pretrain = static_cast<int32_t>(integer_at(json, "pretrain", 0, 1 << 20));
    t.pretrain_epochs = static_cast<int32_t>(integer_at(json, "pretrain_epochs", 1, 100000));
  }
  t.dagger = static_cast<int32_t>(integer_at(json, "dagger", 0, 1000));
  t.beta = number_at(json, "beta", 0, 1);
  t.start_share = number_at(json, "start_share", 0, 1);
  t.start_share_end = number_at(json, "start_share_end", 0, 1);
  return t;
}

}  // namespace

std::string config_text(const RunSettings& s, const redman::Pool& pool, const redman::Agent& agent,
                        const std::vector<double>& limits, int64_t steps_per_epoch,
                        const redman::Shield* shield) {
  const int32_t task = pool.spec().task, algo = find_algo(s.agent.algo);
  const std::string task_name = task_at(task).name, algo_name = algo_at(algo).name;
  const auto costs = task_costs(task);
  Json limit_values = Json::object();
  for (size_t i = 0; i < costs.size(); ++i)
    if (limits[i] >= 0) limit_values[costs[i].name] = limits[i];

  Json algo_cfgs = values_json(agent.settings());
  algo_cfgs["steps_per_epoch"] = steps_per_epoch;
  Json json = {{"exp_name", format("%s-%s-seed-%llu", task_name.c_str(), algo_name.c_str(),
                                   static_cast<unsigned long long>(s.pool.seed))},
               {"task", task_name},
               {"algo", algo_name},
               {"seed", s.pool.seed},
               {"set", as_sets(s.pool.options)},
               {"set_algo", as_sets(s.agent.options)},
               {"set_cost_limit", s.limits},
               {"cost_limits", limit_values},
               {"train_cfgs",
                {{"total_steps", s.steps},
                 {"vector_env_nums", s.pool.envs},
                 {"threads", s.pool.threads},
                 {"eval_every", s.eval_every},
                 {"checkpoint_every", s.checkpoint_every},
                 {"tensorboard", s.events}}},
               {"algo_cfgs", algo_cfgs},
               {"env_cfgs", values_json(pool.settings())},
               {"obs_dim", pool.spec().obs_dim},
               {"action_dim", pool.spec().action_dim},
               {"layout_hash", format("%016llx", static_cast<unsigned long long>(pool.spec().layout_hash))},
               {"build", build_json()}};
  if (shield) {
    json["train_cfgs"]["shield"] = s.shield.word;
    json["shield_cfgs"] = values_json(shield->settings());
  }
  if (!s.own.plugins.empty()) json["plugins"] = s.own.plugins;
  if (!s.own.task.empty()) json["task_file"] = s.own.task;
  if (!s.own.robots.empty()) json["robot_files"] = s.own.robots;
  if (!s.own.objects.empty()) json["object_files"] = s.own.objects;
  if (s.teach.asked() || s.teach.pretrain > 0) json["teach_cfgs"] = teach_json(s.teach);
  std::string text = json_text(json, 2) + '\n';
  if (text.size() > kMostJsonBytes)
    throw Failure(format("a run's config.json holds at most %zu bytes: its robots and task take %zu",
                         kMostJsonBytes, text.size()));
  return text;
}

RunSettings parse_config(const char* text, size_t size) {
  const Document json = parse_json(text, size);
  const Document& train = object_at(json, "train_cfgs");
  RunSettings s;
  s.pool.task = text_at(json, "task");
  s.pool.seed = seed_at(json, "seed");
  s.pool.envs = static_cast<int32_t>(integer_at(train, "vector_env_nums", 1, INT32_MAX));
  s.pool.threads = static_cast<int32_t>(integer_at(train, "threads", 0, INT32_MAX));
  s.pool.options = from_sets(texts_at(json, "set"), "set");
  s.agent.algo = text_at(json, "algo");
  s.agent.options = from_sets(texts_at(json, "set_algo"), "set_algo");
  s.limits = texts_at(json, "set_cost_limit");
  for (const auto& [key, value] : s.agent.options)
    if (same_name(key, "cost_limit_per_step") && value[0] != '-')
      s.rated_limit = std::strtod(value.c_str(), nullptr) *
                      std::strtod(text_at(object_at(json, "env_cfgs"), "max_steps").c_str(), nullptr);
  s.steps = integer_at(train, "total_steps", 1, kMostExact);
  s.eval_every = static_cast<int32_t>(integer_at(train, "eval_every", 1, INT32_MAX));
  s.checkpoint_every = static_cast<int32_t>(integer_at(train, "checkpoint_every", 1, INT32_MAX));
  if (json.contains("plugins")) s.own.plugins = texts_at(json, "plugins");
  if (json.contains("task_file")) s.own.task = file_at(json, "task_file");
  const auto texts = [&](const char* key, std::map<std::string, std::string>* out) {
    if (!json.contains(key)) return;
    const Document& files = object_at(json, key);
    for (const auto& [name, text] : files.items()) (*out)[name] = file_at(files, name);
  };
  if (json.contains("teach_cfgs")) s.teach = parse_teach(object_at(json, "teach_cfgs"));
  texts("robot_files", &s.own.robots);
  texts("object_files", &s.own.objects);
  if (train.contains("shield")) s.shield = shield_at(train, "shield");
  if (train.contains("tensorboard")) s.events = flag_at(train, "tensorboard");
  if (json.contains("task_class")) s.task_class = text_at(json, "task_class");
  if (json.contains("build")) {
    const Document& build = object_at(json, "build");
    if (build.contains("version")) s.version = text_at(build, "version");
    if (build.contains("kernels")) s.kernels = text_at(build, "kernels");
  }
  s.functions = json.contains("own_reward") || json.contains("own_costs");
  if (json.contains("own_costs")) s.limits.clear();
  return s;
}

RunLabel parse_label(const char* text, size_t size) {
  const Document json = parse_json(text, size);
  const Document& limits = object_at(json, "cost_limits");
  for (const auto& [name, limit] : limits.items()) number_at(limits, name.c_str(), -kMostLimit, kMostLimit);
  return {text_at(json, "task"), text_at(json, "algo"), seed_at(json, "seed")};
}

FlatConfig parse_flat_config(const char* text, size_t size) {
  const Document json = parse_json(text, size);
  FlatConfig out;
  for (const char* part : {"train_cfgs", "algo_cfgs", "env_cfgs", "cost_limits", "teach_cfgs"}) {
    if (!json.contains(part)) continue;
    for (const auto& [key, value] : object_at(json, part).items())
      out[std::string(part) + '.' + key] = value.is_string()         ? value.get<std::string>()
                                           : value.is_number_float() ? number_text(value.get<double>())
                                                                     : value.dump();
  }
  out.erase("train_cfgs.threads");
  out.erase("train_cfgs.tensorboard");
  out["task"] = text_at(json, "task");
  if (json.contains("task_file"))
    out["task_file"] = format("%zx", std::hash<std::string>()(file_at(json, "task_file")));
  out["algo"] = text_at(json, "algo");
  return out;
}

}  // namespace tool

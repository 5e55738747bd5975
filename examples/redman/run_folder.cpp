#include "run_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "draw/text.hpp"
#include "files.hpp"
#include "names.hpp"

namespace tool {
namespace {

namespace fs = std::filesystem;

std::string canonical_task(const std::string& name) {
  return task_at(find_task(name)).name;
}
std::string canonical_algo(const std::string& name) {
  return algo_at(find_algo(name)).name;
}

std::vector<std::string> as_sets(const Options& options) {
  std::vector<std::string> out;
  for (const auto& [key, value] : options) out.push_back(key + "=" + value);
  return out;
}

Options from_sets(const Json& sets) {
  Options out;
  for (const std::string text : sets) out.push_back(split_pair(text, "set"));
  return out;
}

// Every option as it stands, by index until the list ends.
template <class Get>
Json values_json(int32_t count, Get get) {
  Json out = Json::object();
  for (int32_t i = 0; i < count; ++i) {
    const char* key = nullptr;
    char text[RDM_TEXT_SIZE];
    redman::check(get(i, &key, text));
    out[key] = text;
  }
  return out;
}

}  // namespace

RunFolder RunFolder::create(const std::string& path, bool overwrite) {
  if (file_exists(path + "/config.json") && !overwrite)
    throw Failure(path + " holds a run already: go on with --resume " + path +
                  ", begin again with --overwrite, or " + "give another --out");
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw Failure("cannot make folder " + path + ": " + error.message());
  RunFolder folder(path);
  // the checkpoint first: a kill in between must not leave it beside another run's files
  for (const std::string& old :
       {folder.checkpoint(), folder.file("config.json"), folder.progress(), folder.policy()})
    fs::remove(old, error);
  return folder;
}

RunFolder RunFolder::open(const std::string& path) {
  if (!file_exists(path + "/config.json"))
    throw Failure(path + " is not a run folder: it has no config.json; start one with train --out " + path);
  return RunFolder(path);
}

std::string RunFolder::default_path(const RunSettings& settings) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "%Y-%m-%d-%H-%M-%S", &local);
  const std::string path = format("runs/%s-{%s}/seed-%03llu-%s", canonical_algo(settings.agent.algo).c_str(),
                                  canonical_task(settings.pool.task).c_str(),
                                  static_cast<unsigned long long>(settings.pool.seed), stamp);
  std::string free_path = path;
  for (int i = 2; fs::exists(free_path); ++i) free_path = path + "-" + std::to_string(i);
  return free_path;
}

std::string RunFolder::of_file(const std::string& file) {
  const std::string folder = is_folder(file) ? file : fs::path(file).parent_path().string();
  const std::string path = folder.empty() ? "." : folder;
  return file_exists(path + "/config.json") ? path : "";
}

void RunFolder::write_config(const RunSettings& s, const redman::Pool& pool, const redman::Agent& agent,
                             const std::vector<double>& limits, int64_t steps_per_epoch) const {
  const int32_t task = pool.spec().task, algo = find_algo(s.agent.algo);
  const std::string task_name = task_at(task).name, algo_name = algo_at(algo).name;
  const auto costs = task_costs(task);
  Json limit_values = Json::object();
  for (size_t i = 0; i < costs.size(); ++i)
    if (limits[i] >= 0) limit_values[costs[i].name] = limits[i];

  Json algo_cfgs = values_json(algo_at(algo).num_options, [&](int32_t i, const char** key, char* text) {
    return rdm_agent_option(agent.get(), i, key, text);
  });
  algo_cfgs["steps_per_epoch"] = steps_per_epoch;
  const Json json = {
      {"exp_name", format("%s-%s-seed-%llu", task_name.c_str(), algo_name.c_str(),
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
        {"checkpoint_every", s.checkpoint_every}}},
      {"algo_cfgs", algo_cfgs},
      {"env_cfgs", values_json(task_at(task).num_options,
                               [&](int32_t i, const char** key, char* text) {
                                 return rdm_pool_option(pool.get(), i, key, text);
                               })},
      {"obs_dim", pool.spec().obs_dim},
      {"action_dim", pool.spec().action_dim},
      {"layout_hash", format("%016llx", static_cast<unsigned long long>(pool.spec().layout_hash))},
      {"build", build_json()}};
  replace_file(file("config.json"), json.dump(2) + '\n');
}

RunSettings RunFolder::read_config() const {
  try {
    const Json json = Json::parse(read_file(file("config.json")));
    const Json& train = json.at("train_cfgs");
    RunSettings s;
    s.pool.task = json.at("task");
    s.pool.seed = json.at("seed");
    s.pool.envs = train.at("vector_env_nums");
    s.pool.threads = train.at("threads");
    s.pool.options = from_sets(json.at("set"));
    s.agent.algo = json.at("algo");
    s.agent.options = from_sets(json.at("set_algo"));
    s.limits = json.at("set_cost_limit").get<std::vector<std::string>>();
    s.steps = train.at("total_steps");
    s.eval_every = train.at("eval_every");
    s.checkpoint_every = train.at("checkpoint_every");
    return s;
  } catch (const Json::exception& e) {
    throw Failure(file("config.json") + " is not a run's configuration: " + e.what());
  }
}

void RunFolder::start_progress(const std::string& header) const {
  replace_file(progress(), header + '\n');
}

size_t RunFolder::append_progress(const std::string& row) const {
  const int f = ::open(progress().c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  const std::string line = row + '\n';
  const bool good = f >= 0 && ::write(f, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  const int error = errno;
  const off_t end = f >= 0 ? lseek(f, 0, SEEK_END) : -1;
  if (f >= 0) close(f);
  if (!good || end < 0) throw Failure("cannot write " + progress() + ": " + std::strerror(error));
  return static_cast<size_t>(end);
}

void RunFolder::cut_progress(size_t bytes) const {
  struct stat s {};
  if (stat(progress().c_str(), &s) != 0 || static_cast<size_t>(s.st_size) < bytes)
    throw Failure(progress() + " is shorter than the checkpoint says; start the run anew");
  if (truncate(progress().c_str(), static_cast<off_t>(bytes)) != 0)
    throw Failure("cannot shorten " + progress() + ": " + std::strerror(errno));
}

}  // namespace tool

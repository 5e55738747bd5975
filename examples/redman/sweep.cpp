// `sweep`: tasks x algorithms x seeds x values of options, each a run of `train` in a process of its own.
//
// Every setting is tried before anything starts. What a run came to stands beside its folder (NAME.json), so that the
// same command goes on where it was stopped, however that was: runs with a result are done, runs that have begun are
// resumed, to the same bytes. Several processes, of one machine or of several that share the folder, divide the runs: who
// trains one holds the lock of its log.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <map>
#include <thread>

#include "commands.hpp"
#include "common/clock.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/objects.hpp"
#include "common/posix.hpp"
#include "common/robots.hpp"
#include "common/setup.hpp"
#include "common/statistics.hpp"
#include "common/task_files.hpp"
#include "common/text.hpp"
#include "run/trainer.hpp"
#if !defined(_WIN32)
#include <sys/wait.h>
#if defined(__linux__)
#include <sys/prctl.h>
#endif
#endif

namespace tool {
namespace {

constexpr size_t kMostRuns = 100000;

struct SweepFlags {
  std::string tasks, algos = "ppo_lag", seeds = "0..4", out;
  std::vector<std::string> sets, varied, limits;
  double steps = 1e6, minutes = 0;
  int32_t jobs = 0, envs = 64;
};

// One run: what it is called in the report, and where it stands.
struct Cell {
  std::string task, algo, variant, path;
  std::string task_word;  // what `train` is told: the task's name or file
  uint64_t seed = 0;
  std::vector<std::string> sets;
  std::string result() const { return path + ".json"; }
};

std::vector<std::string> list_of(const std::string& list) {
  std::vector<std::string> words;
  for (size_t at = 0; at <= list.size();) {
    const size_t end = std::min(list.find(',', at), list.size());
    if (end > at) words.push_back(list.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

// A run that is asked for twice is no second sample.
template <class T>
void need_once(const std::vector<T>& list, const std::string& flag, const std::string& text) {
  for (size_t i = 0; i < list.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (list[i] == list[k]) throw Usage(flag + ' ' + printable(text) + ": one of them is given twice");
}

// "0..4" or "0,3,7".
std::vector<uint64_t> read_seeds(const std::string& text) {
  std::vector<uint64_t> seeds;
  for (const std::string& word : list_of(text)) {
    const size_t dots = word.find("..");
    uint64_t first = 0, last = 0;
    const bool good =
        read_whole(word.substr(0, dots), &first) &&
        (dots == std::string::npos ? read_whole(word, &last) : read_whole(word.substr(dots + 2), &last));
    if (!good || last < first || last - first >= kMostRuns)
      throw Usage("--seeds " + printable(text) + ": it is not a list such as 0,1,2 or a range such as 0..4");
    for (uint64_t s = first; s <= last; ++s) seeds.push_back(s);
  }
  if (seeds.empty()) throw Usage("--seeds: there is none");
  need_once(seeds, "--seeds", text);
  return seeds;
}

// Every choice of one value for each varied key, as settings.
std::vector<std::vector<std::string>> variants_of(const std::vector<std::string>& varied) {
  std::vector<std::vector<std::string>> all(1);
  for (const std::string& text : varied) {
    const size_t equals = text.find('=');
    const auto values = list_of(equals == std::string::npos ? "" : text.substr(equals + 1));
    if (equals == 0 || values.empty())
      throw Usage("--vary " + printable(text) + ": it is not key=value,value");
    need_once(values, "--vary", text);
    std::vector<std::vector<std::string>> next;
    for (const auto& before : all)
      for (const std::string& value : values) {
        next.push_back(before);
        next.back().push_back(text.substr(0, equals) + '=' + value);
      }
    all = std::move(next);
  }
  return all;
}

// A name that any file system takes.
std::string file_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    name += plain || c == '.' || c == '_' || c == '-' || c == '=' || c == '+' ? c : '-';
  }
  return name;
}

std::vector<Cell> runs_of(const SweepFlags& flags) {
  const auto tasks = list_of(flags.tasks), algos = list_of(flags.algos);
  std::vector<std::string> names;  // of the tasks
  for (const std::string& task : tasks) names.emplace_back(task_at(find_task(task)).name);
  const auto seeds = read_seeds(flags.seeds);
  const auto variants = variants_of(flags.varied);
  if (tasks.empty()) throw Usage("--tasks: there is none");
  if (algos.empty()) throw Usage("--algos: there is none");
  need_once(names, "--tasks", flags.tasks);
  need_once(algos, "--algos", flags.algos);
  if (tasks.size() * algos.size() * variants.size() * seeds.size() > kMostRuns)
    throw Usage(format("these are more than %zu runs", kMostRuns));
  std::vector<Cell> cells;
  for (const std::string& task : tasks)
    for (const std::string& algo : algos)
      for (const auto& variant : variants) {
        Cell c;
        c.task = task_at(find_task(task)).name;
        c.task_word = is_task_file(task) ? task : c.task;
        c.algo = algo_at(find_algo(algo)).name;
        c.sets = flags.sets;
        for (const std::string& set : variant) {
          c.variant += (c.variant.empty() ? "" : "+") + set;
          c.sets.push_back(set);
        }
        const std::string configuration = c.algo + (c.variant.empty() ? "" : "+" + c.variant);
        for (const uint64_t seed : seeds) {
          c.seed = seed;
          c.path = flags.out + '/' + c.task + '/' + file_name(configuration) +
                   format("/seed-%03llu", static_cast<unsigned long long>(seed));
          cells.push_back(c);
        }
      }
  return cells;
}

// What `train` would say to them; of runs that differ in their seeds, one.
void try_settings(const SweepFlags& flags, const std::vector<Cell>& cells) {
  const Cell* before = nullptr;
  for (const Cell& c : cells) {
    if (before && before->task == c.task && before->algo == c.algo && before->variant == c.variant) continue;
    before = &c;
    RunSettings run;
    run.pool.task = c.task;
    run.pool.envs = flags.envs;
    run.pool.seed = c.seed;
    run.agent.algo = c.algo;
    run.limits = flags.limits;
    run.steps = whole_number(flags.steps, "--steps");
    std::vector<std::string> sets = c.sets;
    try {
      take_limit_from_sets(run.pool.task, sets, run.limits);
      apply_sets(sets, run.pool, &run.agent);
      Trainer(run).prepare();
    } catch (const std::exception& e) {
      throw Usage(c.task + ", " + c.algo + (c.variant.empty() ? "" : ", " + c.variant) + ": " + e.what() +
                  "; nothing was started");
    }
  }
}

// The result of a run that is over; null: there is none yet.
Json result_of(const Cell& c) {
  if (!file_exists(c.result())) return {};
  try {
    Json json = Json::parse(read_file(c.result()));
    return json.value("interrupted", true) ? Json() : json;
  } catch (const nlohmann::json::exception&) {
    return {};  // it was killed while it wrote
  }
}

// What a run of this path must have been begun with, as words of the command.
std::vector<std::string> settings_of(const SweepFlags& flags, const Cell& c) {
  std::vector<std::string> words = {"--task",  c.task_word,
                                    "--algo",  c.algo,
                                    "--steps", number_text(flags.steps),
                                    "--envs",  std::to_string(flags.envs)};
  for (const std::string& limit : flags.limits) words.insert(words.end(), {"--cost-limit", limit});
  for (const std::string& set : c.sets) words.insert(words.end(), {"--set", set});
  for (const auto& [file, robot] : given_robots()) words.insert(words.end(), {"--robot", file});
  for (const std::string& file : given_objects()) words.insert(words.end(), {"--object", file});
  return words;
}

std::string settings_line(const SweepFlags& flags, const Cell& c) {
  std::string line;
  for (const std::string& word : settings_of(flags, c)) line += (line.empty() ? "" : " ") + word;
  return line;
}

// A folder of other settings holds other runs than are asked for.
void need_same_settings(const SweepFlags& flags, const std::vector<Cell>& cells) {
  for (const Cell& c : cells) {
    const std::string kept = c.path + ".sweep";
    if (!file_exists(kept)) continue;  // not begun, or by an earlier version
    if (const std::string before = read_file(kept), now = settings_line(flags, c); before != now)
      throw Usage("--out " + flags.out + ": " + c.path + " was begun with " + printable(before) + ", not " +
                  printable(now) + "; give another folder");
  }
}

struct Ran {
  bool stopped = false;             // the time was over before all of it
  size_t elsewhere = 0;             // runs that other sweeps trained meanwhile
  std::vector<std::string> failed;  // run: its last words
};

#if !defined(_WIN32)
std::vector<std::string> command_of(const SweepFlags& flags, const Cell& c) {
  std::vector<std::string> words = {path_of_program(), "train", "--json"};
  for (const std::string& plugin : own_files(c.task).plugins) words.insert(words.end(), {"--plugin", plugin});
  const auto add = [&](const char* flag, const std::string& value) {
    words.push_back(flag);
    words.push_back(value);
  };
  if (file_exists(c.path + "/config.json")) {
    add("--resume", c.path);
    add("--steps", number_text(flags.steps));
    return words;
  }
  add("--seed", std::to_string(c.seed));
  add("--out", c.path);
  for (const std::string& word : settings_of(flags, c)) words.push_back(word);
  return words;
}

void make_run_folders(const std::string& path) {
  for (size_t at = path.find('/', 1); at != std::string::npos; at = path.find('/', at + 1))
    mkdir(path.substr(0, at).c_str(), 0777);
  if (!is_folder(path)) mkdir(path.c_str(), 0777);
}

// The log of a run, with its lock; -1: another sweep trains it. File systems that know no locks are taken as they are.
int claim(const SweepFlags& flags, const Cell& c) {
  make_run_folders(c.path.substr(0, c.path.rfind('/')));
  const std::string log = c.path + ".log";
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file < 0) throw Failure("cannot write " + log + ": " + std::strerror(errno));
  if (flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) {
    if (!file_exists(c.path + ".sweep")) replace_file(c.path + ".sweep", settings_line(flags, c));
    return file;
  }
  close(file);
  return -1;
}

// Its result goes to NAME.json, what it says to NAME.log, whose lock goes with it. It ends with this process.
pid_t start_cell(const SweepFlags& flags, const Cell& c, int log) {
  const std::vector<std::string> words = command_of(flags, c);
  const std::string result = c.result();
  std::vector<char*> argv;
  for (const std::string& w : words) argv.push_back(const_cast<char*>(w.c_str()));
  argv.push_back(nullptr);
  const pid_t pid = fork();
  const int trouble = errno;
  if (pid != 0) close(log);
  if (pid < 0) throw Failure(std::string("no process could be started: ") + std::strerror(trouble));
  if (pid > 0) return pid;
#if defined(__linux__)
  prctl(PR_SET_PDEATHSIG, SIGINT);
#endif
  const int out = open(result.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (out < 0 || dup2(out, 1) < 0 || dup2(log, 2) < 0) _exit(126);
  execv(argv[0], argv.data());
  _exit(127);
}

std::string last_line(const std::string& path) {
  std::string text = file_exists(path) ? read_file(path) : "";
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
}

// Runs what has no result, so many at a time.
Ran run_cells(const SweepFlags& flags, const std::vector<Cell>& cells) {
  const auto begun = std::chrono::steady_clock::now();
  const auto over = [&] {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun;
    return flags.minutes > 0 && spent.count() > 60 * flags.minutes;
  };
  const auto cores = static_cast<int32_t>(std::thread::hardware_concurrency());
  const auto jobs = static_cast<size_t>(flags.jobs > 0 ? flags.jobs : std::max(cores, 1));
  std::map<pid_t, const Cell*> running;
  size_t next = 0;
  Ran ran;
  bool& stopped = ran.stopped;
  for (;;) {
    while (!stopped && running.size() < jobs && next < cells.size()) {
      const Cell& c = cells[next++];
      if (!result_of(c).is_null()) continue;
      const int log = claim(flags, c);
      if (log < 0) {
        ++ran.elsewhere;
        continue;
      }
      if (!result_of(c).is_null()) {  // another sweep ended it in between
        close(log);
        continue;
      }
      running[start_cell(flags, c, log)] = &c;
      std::fprintf(stderr, "%zu of %zu: %s\n", next, cells.size(), printable(c.path).c_str());
    }
    if (running.empty()) return ran;
    if (!stopped && over()) {
      stopped = true;
      for (const auto& [pid, c] : running) kill(pid, SIGINT);  // they keep a checkpoint
    }
    int status = 0;
    const pid_t ended = waitpid(-1, &status, WNOHANG);
    if (ended <= 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    const auto at = running.find(ended);
    if (at == running.end()) continue;
    if (!stopped && (!WIFEXITED(status) || WEXITSTATUS(status) != 0))
      ran.failed.push_back(at->second->path + ": " + last_line(at->second->path + ".log"));
    running.erase(at);
  }
}
#else
Ran run_cells(const SweepFlags&, const std::vector<Cell>&) {
  throw Failure("sweep starts processes, which it cannot on Windows: call train for each run, and report");
}
#endif

struct SweepRow {
  std::string task, configuration;
  Sample returns, costs, safe;
  Json limit;
  size_t runs = 0;
};

std::vector<SweepRow> rows_of(const std::vector<Cell>& cells) {
  std::vector<SweepRow> rows;
  for (const Cell& c : cells) {
    const std::string configuration = c.algo + (c.variant.empty() ? "" : " " + c.variant);
    if (rows.empty() || rows.back().task != c.task || rows.back().configuration != configuration)
      rows.push_back({c.task, configuration, {}, {}, {}, {}, 0});
    SweepRow& row = rows.back();
    ++row.runs;
    const Json json = result_of(c);
    if (json.is_null()) continue;
    row.returns.push_back(json.value("return", 0.0));
    row.costs.push_back(json.value("cost", 0.0));
    row.safe.push_back(json.value("feasible", false) ? 1 : 0);
    row.limit = json.value("cost_limit", Json());
  }
  return rows;
}

Report run_sweep(const SweepFlags& flags) {
  if (flags.out.empty()) throw Usage("--out: give the folder that the runs go to");
  const std::vector<Cell> cells = runs_of(flags);
  RunFolder::check_place(flags.out);
  need_same_settings(flags, cells);
  try_settings(flags, cells);
  const Ran ran = run_cells(flags, cells);
  Table table({"task", "configuration", "runs", "return, IQM", "95% interval", "cost, IQM", "95% interval",
               "limit", "within it"});
  Json json = {{"runs", cells.size()},
               {"stopped", ran.stopped},
               {"elsewhere", ran.elsewhere},
               {"failed", ran.failed},
               {"rows", Json::array()}};
  size_t done = 0;
  for (const SweepRow& r : rows_of(cells)) {
    const size_t n = r.returns.size();
    done += n;
    const std::string limit = r.limit.is_number() ? number_text(r.limit.get<double>()) : "-";
    const std::string count = std::to_string(n) + (n < r.runs ? " of " + std::to_string(r.runs) : "");
    if (n == 0) {
      table.add({r.task, r.configuration, count, "-", "-", "-", "-", limit, "-"});
      continue;
    }
    const Interval returns = iqm_interval(Strata{r.returns}), costs = iqm_interval(Strata{r.costs});
    table.add({r.task, r.configuration, count, format("%.4g", iqm_of(r.returns)), interval_text(returns),
               format("%.4g", iqm_of(r.costs)), interval_text(costs), limit,
               format("%.0f%%", 100 * mean_of(r.safe))});
    json["rows"].push_back({{"task", r.task},
                            {"configuration", r.configuration},
                            {"runs", n},
                            {"return_iqm", iqm_of(r.returns)},
                            {"return_interval", interval_json(returns)},
                            {"cost_iqm", iqm_of(r.costs)},
                            {"cost_interval", interval_json(costs)},
                            {"cost_limit", r.limit},
                            {"within_limit", mean_of(r.safe)}});
  }
  json["done"] = done;
  replace_file(flags.out + "/sweep.md", table.markdown());
  std::string text = table.text() + format("%zu of %zu runs are done; the table is in ", done, cells.size()) +
                     flags.out + "/sweep.md\n";
  if (ran.stopped) text += "the time was over: the same command goes on\n";
  if (ran.elsewhere) text += format("other sweeps in this folder have taken %zu runs\n", ran.elsewhere);
  for (const std::string& f : ran.failed) text += "failed: " + f + '\n';
  if (!ran.failed.empty()) throw Failure(text);
  return {json, text};
}

}  // namespace

void add_sweep(CLI::App& app, Run& run) {
  auto flags = std::make_shared<SweepFlags>();
  CLI::App* command = app.add_subcommand(
      "sweep", "Train tasks x algorithms x seeds x options, each a run of its own, and compare them");
  add_robot_flag(*command);
  add_object_flag(*command);
  command
      ->add_option("--tasks,--task", flags->tasks, "tasks, by name or by file (.task), separated by commas")
      ->required();
  command->add_option("--algos,--algo", flags->algos, "algorithms, separated by commas");
  command->add_option("--seeds", flags->seeds, "seeds: a range such as 0..4, or a list such as 0,1,2");
  command->add_option(
      "--vary", flags->varied,
      "key=value,value: each value is a configuration of its own; may be given several times");
  add_set_flag(*command, flags->sets);
  add_cost_limit_flag(*command, flags->limits);
  command->add_option("--steps", flags->steps, "number of control steps of each run")->check(at_least(1));
  command->add_option("--envs,--num-envs", flags->envs, "number of worlds of each run")->check(at_least(1));
  command->add_option("--jobs", flags->jobs, "runs at a time; 0: one for each core")->check(at_least(0));
  command
      ->add_option("--minutes", flags->minutes,
                   "time after which runs are stopped; the same command continues them; 0: no bound")
      ->check(at_least(0));
  command->add_option("--out", flags->out, "folder of the runs; the same command continues the runs in it");
  command->callback([&run, flags] { run = [flags] { return run_sweep(*flags); }; });
}

}  // namespace tool

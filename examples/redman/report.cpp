// `report`: a page that compares run folders.
#include "web/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/ownership.hpp"
#include "common/text.hpp"
#include "play/evaluate.hpp"
#include "play/scene.hpp"
#include "run/trainer.hpp"

namespace tool {
namespace {

struct ReportFlags {
  std::vector<std::string> folders;
  std::string html = "report.html";
  bool html_given = false;
  int32_t episodes = kEvalEpisodes, strip = 6, threads = 0;
};

// The worlds of a run's report, as `train` makes them at its end.
PoolSettings report_worlds(const RunData& run, int32_t threads) {
  PoolSettings settings = run_settings(run.path).pool;
  settings.seed += Trainer::kEvalSeed;
  settings.magnitudes = learns_magnitudes(run_settings(run.path).agent);
  settings.envs = kEvalEnvs;
  settings.threads = threads;
  return settings;
}

Outcome evaluated(const RunData& run, const ReportFlags& flags) {
  const ActorChoice choice = choose_actor(run.path);
  const Evaluation e = evaluate(choice, report_worlds(run, flags.threads), run_settings(run.path).limits,
                                flags.episodes, false);
  Outcome o{true, e.summary.return_mean, e.summary.success_rate, e.summary.fall_rate, e.summary.length_mean,
            {},   e.summary.trouble};
  say_trouble(o.trouble, run.path);
  for (size_t k = 0; k < e.costs.size(); ++k)
    o.costs.push_back({e.costs[k], e.limits[k], e.summary.cost_mean[k]});
  return o;
}

// "close" where the task has it, else its first camera, "" without any.
std::string camera_of(int32_t task) {
  std::string first;
  for (int32_t i = 0; i < task_at(task).num_cameras; ++i) {
    rdm_camera_info c = RDM_INIT(rdm_camera_info);
    redman::check(rdm_task_camera_at(task, i, &c));
    if (i == 0) first = c.name;
    if (same_name(c.name, "close")) return c.name;
  }
  return first;
}

// Of the best of a configuration's runs.
Strip strip_of(const Configuration& c, const ReportFlags& flags) {
  size_t best = 0;
  for (size_t i = 1; i < c.runs.size(); ++i)
    if (c.outcomes[i].score().better_than(c.outcomes[best].score())) best = i;
  const RunData& run = *c.runs[best];
  const std::string camera = camera_of(find_task(run.task));
  if (camera.empty()) return {};
  PoolSettings settings = report_worlds(run, 0);
  settings.envs = 1;
  const ActorChoice choice = choose_actor(run.path);
  constexpr int32_t kWidth = 260, kHeight = 195;
  const int32_t last = last_step(Scene(settings, choice, {camera, kWidth, kHeight}), -1);
  Scene scene(settings, choice, {camera, kWidth, kHeight});
  Strip strip{png_bytes(draw_strip(scene, flags.strip, 0, last)), ""};
  const redman::Pool& pool = scene.pool();
  strip.caption =
      format(", seed %llu: %d steps, return %.4g, cost %.4g", static_cast<unsigned long long>(run.seed), last,
             static_cast<double>(pool.episode_return()[0]),
             pool.spec().cost_dim > 0 ? static_cast<double>(pool.episode_cost()[0][0]) : 0.0);
  return strip;
}

// What can be done of a task's report; what cannot is a note in it.
TaskReport report_of(const std::vector<const RunData*>& runs, const ReportFlags& flags) {
  TaskReport t;
  t.task = runs[0]->task;
  t.episodes = flags.episodes;
  try {
    t.summary = task_at(find_task(t.task)).summary;
  } catch (const Usage& e) {
    t.notes.push_back(e.what());
  }
  t.configurations = group_runs(runs);
  for (Configuration& c : t.configurations)
    for (const RunData* run : c.runs) {
      c.outcomes.push_back(training_outcome(*run));
      if (flags.episodes < 1) continue;
      try {
        c.outcomes.back() = evaluated(*run, flags);
        if (const Trouble& t_run = c.outcomes.back().trouble; t_run.any())
          t.notes.push_back(run->path + ": " + trouble_text(t_run));
      } catch (const std::runtime_error& e) {
        t.notes.push_back(run->path + " was not evaluated: " + e.what());
      }
    }
  rank(t.configurations);
  t.seeds = seeds_of(t.configurations);
  for (const Configuration& c : t.configurations) {
    t.strips.emplace_back();
    if (flags.strip < 1) continue;
    try {
      t.strips.back() = strip_of(c, flags);
    } catch (const std::runtime_error& e) {
      t.notes.push_back(c.label + " has no pictures: " + e.what());
    }
  }
  return t;
}

Json ranking_json(const TaskReport& t) {
  Json out = Json::array();
  for (size_t i = 0; i < t.configurations.size(); ++i) {
    const Configuration& c = t.configurations[i];
    const Seeds& s = t.seeds[i];
    const Outcome mean = c.mean();
    Json costs = Json::object(), deviations = Json::object(), ratios = Json::object();
    for (size_t k = 0; k < mean.costs.size(); ++k) {
      costs[mean.costs[k].name] = mean.costs[k].mean;
      deviations[mean.costs[k].name] = s.cost_sd[k];
      if (mean.costs[k].limit >= 0) ratios[mean.costs[k].name] = s.cost_ratio[k];
    }
    Json row = {{"task", t.task},
                {"configuration", c.label},
                {"runs", c.runs.size()},
                {"feasible", mean.score().feasible},
                {"evaluated", mean.evaluated},
                {"return", mean.ret},
                {"cost", costs},
                {"return_sd", s.return_sd},
                {"cost_sd", deviations},
                {"return_iqm", s.return_iqm},
                {"interval", interval_json(s.return_interval)},
                {"group", s.group},
                {"normalised_return", s.normalised_return},
                {"normalised_cost", ratios},
                {"training_cost_rate", s.training_cost_rate},
                {"training_violating_steps", s.training_violating_steps}};
    put_trouble(row, mean.trouble);
    out.push_back(row);
  }
  return out;
}

// "12.3 +- 0.4", of one run without the deviation.
std::string with_deviation(double mean, double deviation) {
  return format("%.4g", mean) + (std::isnan(deviation) ? "" : " +- " + error_text(deviation));
}

Report run_report(const ReportFlags& flags) {
  check_outputs({{"--html", flags.html, ".html .htm"}});
  if (!flags.html_given) check_default_output(flags.html, "content=\"redman\"", "--html");
  const std::vector<RunData> runs = read_runs(flags.folders);
  std::vector<std::string> tasks;
  for (const RunData& run : runs)
    if (std::find(tasks.begin(), tasks.end(), run.task) == tasks.end()) tasks.push_back(run.task);
  std::vector<TaskReport> reports;
  Json json = {{"file", flags.html}, {"runs", runs.size()}, {"ranking", Json::array()}};
  std::string text;
  size_t fewest = SIZE_MAX;  // runs of a configuration
  for (const std::string& task : tasks) {
    std::vector<const RunData*> own;
    for (const RunData& run : runs)
      if (run.task == task) own.push_back(&run);
    reports.push_back(report_of(own, flags));
    Table table({task, "runs", "limits", "return +- sd", "IQM", "95% interval of it", "group", "cost +- sd"});
    const TaskReport& t = reports.back();
    for (const Json& row : ranking_json(t)) json["ranking"].push_back(row);
    for (size_t i = 0; i < t.configurations.size(); ++i) {
      const Outcome mean = t.configurations[i].mean();
      fewest = std::min(fewest, t.configurations[i].runs.size());
      const Seeds& s = t.seeds[i];
      table.add({t.configurations[i].label, std::to_string(t.configurations[i].runs.size()),
                 mean.score().feasible ? "within" : "over", with_deviation(s.return_mean, s.return_sd),
                 format("%.4g", s.return_iqm), interval_text(s.return_interval),
                 s.group.empty() ? "-" : s.group,
                 mean.costs.empty() ? "-" : with_deviation(mean.costs[0].mean, s.cost_sd[0])});
    }
    text += table.text() + '\n';
  }
  text +=
      "+- is the deviation over seeds; runs that share a letter are not told apart by their returns (redman "
      "compare --help)\n";
  json["remarks"] = Json::array();
  if (fewest < kFewRuns) {
    const std::string remark = std::string(fewest < 2 ? "one run has no interval and no group; " : "") +
                               format("intervals of fewer than %zu runs are too narrow", kFewRuns);
    json["remarks"].push_back(remark);
    text += remark + '\n';
  }
  replace_file(flags.html, report_page(reports));
  return {json, text + "wrote " + flags.html + '\n'};
}

}  // namespace

void add_report(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ReportFlags>();
  CLI::App* command = app.add_subcommand(
      "report", "Compare run folders on one HTML page: ranking, curves, configurations, pictures");
  command
      ->add_option(
          "folders", flags->folders,
          "run folders, or folders that hold some; runs that differ only in the seed are one configuration")
      ->required();
  const CLI::Option* html =
      command->add_option("--html", flags->html, "HTML page to write; default: report.html");
  command
      ->add_option("--episodes", flags->episodes,
                   "number of new episodes by which each run is evaluated; 0: use the training's figures")
      ->check(between(0, kMostEpisodes));
  command
      ->add_option("--strip", flags->strip,
                   "number of pictures of one episode of each configuration; 0: none")
      ->check(between(0, 64));
  command->add_option("--threads", flags->threads, "number of threads; 0: the calling thread alone");
  command->callback([&run, flags, html] {
    flags->html_given = html->count() > 0;
    run = [flags] { return run_report(*flags); };
  });
}

}  // namespace tool

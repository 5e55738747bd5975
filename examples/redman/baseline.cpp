// `baseline`: what policies without learning get, so that every learning figure has its floor beside it, and
// the demonstration where the tool carries one; or what the policies that come with the tool get.
#include <algorithm>

#include "commands.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/robots.hpp"
#include "common/setup.hpp"
#include "common/text.hpp"
#include "play/actor.hpp"
#include "play/evaluate.hpp"
#include "play/trained.hpp"

namespace tool {
namespace {

struct BaselineFlags {
  std::vector<std::string> tasks;     // empty: all
  std::vector<std::string> policies;  // empty: those that learn nothing
  PoolSettings pool;
  int32_t episodes = kEvalEpisodes;
  bool markdown = false;
};

std::vector<std::string> chosen_tasks(const BaselineFlags& flags) {
  std::vector<std::string> names;
  if (flags.tasks.empty())
    for (int32_t i = 0; i < rdm_task_count(); ++i) names.push_back(task_at(i).name);
  for (const std::string& name : flags.tasks) names.push_back(task_at(find_task(name)).name);
  return names;
}

// Of the words asked for, or all but `trained`: those that the task has.
std::vector<std::string> policies_of(const std::string& task, const BaselineFlags& flags) {
  std::vector<std::string> names;
  for (const char* name : {"zero", "hold", "random", "demo", "trained"}) {
    const auto asked = [&](const std::string& word) { return same_name(word, name); };
    const bool learned = same_name(name, "trained");
    if (flags.policies.empty() ? learned : std::none_of(flags.policies.begin(), flags.policies.end(), asked))
      continue;
    if ((same_name(name, "demo") && !has_builtin_demo(task)) || (learned && !has_trained_policy(task))) {
      if (!flags.tasks.empty() && !flags.policies.empty())
        std::fprintf(stderr, "--policy %s: task %s has none\n", name, task.c_str());
      continue;
    }
    names.push_back(name);
  }
  return names;
}

Report run_baseline(const BaselineFlags& flags) {
  say_worlds(flags.pool, flags.episodes);
  Json rows = Json::array();
  Table table({"task", "policy", "return", "cost", "cost limit", "control steps", "success rate"});
  for (const std::string& task : chosen_tasks(flags))
    for (const std::string& policy : policies_of(task, flags)) {
      PoolSettings pool = flags.pool;
      pool.task = task;
      const ActorChoice choice = choose_actor(policy, task);
      adopt_task(choice, true, {}, pool);
      const Evaluation e = evaluate(choice, pool, {}, flags.episodes, false);
      const Summary& s = e.summary;
      say_trouble(s.trouble, task + ", " + policy);
      Json row = {{"task", task}, {"policy", policy}};
      row.update(evaluation_json(e, flags.episodes));
      rows.push_back(row);
      table.add({flags.markdown ? format("`%s`", task.c_str()) : task, policy,
                 format("%.2f +- %.2f", s.return_mean, s.return_std), format("%.2f", s.cost_mean[0]),
                 e.limits[0] < 0 ? "-" : number_text(e.limits[0]), format("%.0f", s.length_mean),
                 format("%.0f%%", 100 * s.success_rate)});
    }
  return {{{"rows", rows}}, flags.markdown ? table.markdown() : table.text()};
}

}  // namespace

void add_baseline(CLI::App& app, Run& run) {
  auto flags = std::make_shared<BaselineFlags>();
  flags->pool.envs = kEvalEnvs;
  CLI::App* command = app.add_subcommand(
      "baseline",
      "Evaluate the baselines zero, hold and random, demonstrations and bundled policies on every task");
  command->add_option("--task,--env-id", flags->tasks, "task, by name; repeatable; default: all tasks")
      ->allow_extra_args(false);
  command
      ->add_option("--policy", flags->policies,
                   "baseline: zero, hold, random, demo or trained; repeatable; default: all but trained")
      ->allow_extra_args(false)
      ->check(one_of({"zero", "hold", "random", "demo", "trained"}));
  add_envs_flag(*command, flags->pool);
  command->add_option("--threads", flags->pool.threads, "number of threads; 0: the calling thread alone");
  add_robot_flag(*command);
  command->add_option("--seed", flags->pool.seed, "seed of the worlds and the random actions");
  command->add_option("--episodes", flags->episodes, "number of episodes of each baseline")
      ->check(between(1, kMostEpisodes));
  command->add_flag("--markdown", flags->markdown, "print a Markdown table");
  command->callback([&run, flags] { run = [flags] { return run_baseline(*flags); }; });
}

}  // namespace tool

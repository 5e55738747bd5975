// `plan`: episodes by planning, and what they come to.
#include <algorithm>
#include <memory>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/text.hpp"
#include "play/evaluate.hpp"
#include "play/plan_word.hpp"
#include "record/recorder.hpp"

namespace tool {
namespace {

struct PlanFlags {
  std::string policy, critic, record, shield = "off";
  PoolSettings pool;
  std::vector<std::string> sets, plans, own, limits;  // own: options of planners that are flags
  int32_t episodes = 1;
  bool task_given = false, states = false;
};

Report run_plan(PlanFlags flags) {
  check_outputs({{"--record", flags.record, kRecordEndings}});
  Options options;
  GivenOnce keys;
  if (!flags.policy.empty()) keys.add("policy", "--policy");
  if (!flags.critic.empty()) keys.add("critic", "--critic");
  for (const auto* texts : {&flags.own, &flags.plans})
    for (const std::string& text : *texts) {
      options.push_back(split_pair(text, "--plan"));
      keys.add(options.back().first, "--plan " + text);
    }
  const std::string word = plan_word(options, flags.policy, flags.critic);
  ActorChoice choice = choose_actor(word, flags.pool.task);
  choice.shield = read_shield_word(flags.shield);
  adopt_task(choice, flags.task_given, flags.sets, flags.pool);
  need_one_limit_each(flags.pool.task, flags.limits);
  apply_sets(flags.sets, flags.pool, nullptr, [](const std::string& key) {
    const std::string hint = planner_hint(key);
    return hint.empty() ? hint : hint + " of --plan";
  });
  choice.limits.insert(choice.limits.end(), flags.limits.begin(), flags.limits.end());
  say_worlds(flags.pool, flags.episodes);
  flags.pool.envs = std::min(flags.pool.envs, flags.episodes);
  redman::Pool pool = make_pool(flags.pool, RDM_AUTORESET_OFF);
  Evaluation e;
  e.task = task_at(pool.spec().task).name;
  e.limits = cost_limits(pool, choice.limits);
  for (const rdm_cost_info& c : task_costs(pool.spec().task)) e.costs.push_back(c.name);
  Actor actor(choice, pool, false, flags.pool.seed);
  say_idle(flags.sets, flags.pool);
  const auto episodes = static_cast<size_t>(flags.episodes);
  std::unique_ptr<Recorder> recorder;
  if (!flags.record.empty())
    recorder = std::make_unique<Recorder>(flags.record, pool, episodes, flags.states);
  StepObserver before, after;
  if (recorder) before = [&](size_t env, size_t episode) { recorder->before(env, episode); };
  if (recorder) after = [&](size_t env, size_t episode) { recorder->after(env, episode); };
  pool.reset();
  finish_evaluation(e, pool, actor, play_episodes(pool, actor, episodes, after, before));
  say_trouble(e.summary.trouble, "plan");
  const double ms = actor.planning().calls > 0
                        ? 1e3 * actor.planning().seconds / static_cast<double>(actor.planning().calls)
                        : 0;
  Json json = {{"task", task_at(pool.spec().task).name}, {"policy", word}};
  json.update(evaluation_json(e, flags.episodes));
  json["ms_per_action"] = ms;
  json["steps_per_action"] = static_cast<double>(actor.planning().steps) /
                             static_cast<double>(std::max<int64_t>(actor.planning().calls, 1));
  std::string text = evaluation_text(e, flags.episodes) + format("%.2f ms per action\n", ms);
  if (recorder) {
    json["file"] = flags.record;
    json["steps"] = recorder->finish({word, flags.pool.options, flags.pool.seed});
    text += "wrote " + flags.record + '\n';
  }
  return {json, text};
}

}  // namespace

void add_plan(CLI::App& app, Run& run) {
  auto flags = std::make_shared<PlanFlags>();
  CLI::App* command =
      app.add_subcommand("plan", "Act by planning: simulate many action sequences, follow the best");
  CLI::Option* task = add_pool_flags(*command, flags->pool,
                                     "task, by name or by its file (.task); default: the policy's task");
  command->add_option("--policy", flags->policy,
                      "policy that proposes plans: policy file, run folder or trained; default: none");
  command->add_option("--critic", flags->critic,
                      "run folder whose critic values the state at the end of a plan; default: none");
  command->add_option("--episodes", flags->episodes, "number of episodes")->check(between(1, kMostEpisodes));
  for (const rdm_option_spec& row : planner_options()) {
    const std::string key = row.key;
    if (key != "method" && key != "samples" && key != "horizon" && key != "iterations") continue;
    command->add_option_function<std::string>(
        "--" + key, [flags, key](const std::string& value) { flags->own.push_back(key + '=' + value); },
        row.help);
  }
  command
      ->add_option("--plan", flags->plans,
                   "option of the planner (`redman info planner` lists them); repeatable")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  add_shield_flag(*command, flags->shield);
  add_cost_limit_flag(*command, flags->limits);
  CLI::Option* record = command->add_option(
      "--record", flags->record, "write every step to a file as `rollout --record` does: .npz or .csv");
  command->add_flag("--record-states", flags->states, "also record the state of the worlds before each step")
      ->needs(record);
  add_set_flag(*command, flags->sets);
  command->callback([&run, flags, task] {
    flags->task_given = task->count() > 0;
    run = [flags] { return run_plan(*flags); };
  });
}

}  // namespace tool

// `eval`: how good a policy is, over many episodes.
#include "commands.hpp"
#include "common/names.hpp"
#include "common/text.hpp"
#include "play/evaluate.hpp"

namespace tool {

void finish_evaluation(Evaluation& e, const redman::Pool& pool, const Actor& actor,
                       const std::vector<Episode>& episodes) {
  e.summary = summarise(episodes, e.limits);
  e.violating_steps = pool.stats().violations;
  if (actor.shielded()) e.shield = actor.shielded()->counts();
}

Evaluation evaluate(const ActorChoice& choice, PoolSettings settings, const std::vector<std::string>& limits,
                    int32_t episodes, bool stochastic) {
  settings.envs = std::min(settings.envs, episodes);
  redman::Pool pool = make_pool(counted(settings), RDM_AUTORESET_OFF);
  Evaluation out;
  out.limits = cost_limits(pool, limits);
  for (const rdm_cost_info& c : task_costs(pool.spec().task)) out.costs.push_back(c.name);
  Actor actor(choice, pool, stochastic, settings.seed);
  pool.reset();
  out.magnitudes = settings.magnitudes;
  finish_evaluation(out, pool, actor,
                    play_episodes(pool, actor, static_cast<size_t>(episodes), {}, {}, settings.magnitudes));
  return out;
}

Json evaluation_json(const Evaluation& e, int32_t episodes) {
  const Summary& s = e.summary;
  Json json = {{"episodes", episodes},
               {"return_mean", s.return_mean},
               {"return_std", s.return_std},
               {"return_stderr", s.return_stderr},
               {"cost_mean", s.cost_mean},
               {"cost_std", s.cost_std},
               {"cost_stderr", s.cost_stderr},
               {"success_rate", s.success_rate},
               {"success_steps_mean", s.success_steps},
               {"length_mean", s.length_mean},
               {"cost_limits", e.limits},
               {"cost_signal", e.magnitudes ? "raw" : "flag"},
               {"violation_rate", s.violation_rate},
               {"fall_rate", s.fall_rate},
               {"cost_per_step", s.cost_per_step},
               {"violating_steps", e.violating_steps},
               {"feasible", feasible(s, e.limits)}};
  if (e.shield) put_shield(json, *e.shield);
  put_trouble(json, s.trouble);
  return json;
}

std::string evaluation_text(const Evaluation& e, int32_t episodes) {
  const Summary& s = e.summary;
  std::string text = format(
      "%d episodes: return %.3f +- %.3f, length %.1f, success %.1f%% (%.2f steps), falls %.1f%%\n", episodes,
      s.return_mean, s.return_std, s.length_mean, 100 * s.success_rate, s.success_steps, 100 * s.fall_rate);
  Table costs({"cost", "mean", "std", "limit"});
  for (size_t k = 0; k < e.costs.size(); ++k)
    costs.add({e.costs[k], format("%.3f", s.cost_mean[k]), format("%.3f", s.cost_std[k]),
               e.limits[k] < 0 ? "-" : number_text(e.limits[k])});
  return text + costs.text() +
         format("episodes over a limit: %.1f%%; cost per step: %.4f; violating steps: %lld\n",
                100 * s.violation_rate, s.cost_per_step, static_cast<long long>(e.violating_steps)) +
         (e.shield ? shield_text(*e.shield) : "") +
         (e.magnitudes ? "costs are magnitudes: sums of cost_raw (cost_signal=raw)\n" : "");
}

namespace {

struct EvalFlags {
  std::string policy = "hold", shield = "off";
  PoolSettings pool;
  std::vector<std::string> sets, limits;
  int32_t episodes = kEvalEpisodes;
  bool stochastic = false, task_given = false;
};

Report run_eval(EvalFlags flags) {
  ActorChoice choice = choose_actor(flags.policy, flags.pool.task);
  choice.shield = read_shield_word(flags.shield);
  adopt_task(choice, flags.task_given, flags.sets, flags.pool);
  apply_sets(flags.sets, flags.pool, nullptr);
  choice.limits.insert(choice.limits.end(), flags.limits.begin(), flags.limits.end());
  say_worlds(flags.pool, flags.episodes);
  const Evaluation e = evaluate(choice, flags.pool, choice.limits, flags.episodes, flags.stochastic);
  say_trouble(e.summary.trouble, "eval");
  Json json = {{"policy", flags.policy}, {"task", task_at(find_task(flags.pool.task)).name}};
  json.update(evaluation_json(e, flags.episodes));
  return {json, evaluation_text(e, flags.episodes)};
}

}  // namespace

void add_eval(CLI::App& app, Run& run) {
  auto flags = std::make_shared<EvalFlags>();
  flags->pool.envs = kEvalEnvs;
  CLI::App* command = app.add_subcommand("eval", "Evaluate a policy over whole episodes");
  command->add_option(
      "--policy", flags->policy,
      "policy file, run folder, .demo file, trained, plan, demo, zero, hold or random; a run's task "
      "options come with it");
  CLI::Option* task =
      add_pool_flags(*command, flags->pool, "task, or its file (.task); default: the policy's");
  command->add_option("--episodes", flags->episodes, "episodes")->check(CLI::Range(1, kMostEpisodes));
  command->add_flag("--stochastic", flags->stochastic, "sample actions instead of taking the mean");
  add_shield_flag(*command, flags->shield);
  add_cost_limit_flag(*command, flags->limits);
  add_set_flag(*command, flags->sets);
  command->callback([&run, flags, task] {
    flags->task_given = task->count() > 0;
    run = [flags] { return run_eval(*flags); };
  });
}

}  // namespace tool

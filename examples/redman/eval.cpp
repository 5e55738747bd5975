// `eval`: how good a policy is, over many episodes.
#include "commands.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/text.hpp"
#include "data/score.hpp"
#include "play/evaluate.hpp"

namespace tool {

void finish_evaluation(Evaluation& e, const redman::Pool& pool, const Actor& actor,
                       const std::vector<Episode>& episodes) {
  e.summary = summarise(episodes, e.limits);
  e.spread = spread_of(episodes, e.limits);
  e.violating_steps = pool.stats().violations;
  if (actor.shielded()) e.shield = actor.shielded()->counts();
}

Evaluation evaluate(const ActorChoice& choice, PoolSettings settings, const std::vector<std::string>& limits,
                    int32_t episodes, bool stochastic) {
  settings.envs = std::min(settings.envs, episodes);
  redman::Pool pool = make_pool(counted(settings), RDM_AUTORESET_OFF);
  Evaluation out;
  out.task = task_at(pool.spec().task).name;
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
  put_spread(json, e.spread);
  json["remarks"] = remarks_of(s, e.spread, e.limits, e.costs, episodes);
  if (e.shield) put_shield(json, *e.shield);
  put_trouble(json, s.trouble);
  return json;
}

std::string evaluation_text(const Evaluation& e, int32_t episodes) {
  const Summary& s = e.summary;
  const Spread& spread = e.spread;
  const std::vector<double>& of_return = spread.return_quantiles;
  const std::string mean_return = measured(s.return_mean, s.return_stderr);
  std::string text =
      format("%d episode%s of %s: return ", episodes, episodes == 1 ? "" : "s", e.task.c_str()) + mean_return;
  Table table({"sum per episode", "mean +- se", "95% interval", "median", "90% quantile", "CVaR", "limit",
               "above limit"});
  table.add({"return", mean_return, interval_text(spread.return_interval), format("%.3f", of_return[1]),
             format("%.3f", of_return[2]), "-", "-", "-"});
  for (size_t k = 0; k < e.costs.size(); ++k) {
    const Spread::Cost& c = spread.costs[k];
    const bool limited = e.limits[k] >= 0;
    const std::string mean = measured(s.cost_mean[k], s.cost_stderr[k]);
    const std::string limit = limited ? number_text(e.limits[k]) : "-";
    if (k == 0 || limited) text += ", " + e.costs[k] + ' ' + mean + (limited ? " (limit " + limit + ')' : "");
    table.add({e.costs[k], mean, interval_text(c.interval), format("%.3f", c.quantiles[0]),
               format("%.3f", c.quantiles[1]), format("%.3f", c.cvar), limit,
               limited ? format("%.1f%%", 100 * c.over) : "-"});
  }
  text += format(", success %.1f%%, over a limit %.1f%%", 100 * s.success_rate, 100 * s.violation_rate);
  if (!e.costs.empty()) text += format(", CVaR of the cost %.3f", spread.costs[0].cvar);
  text += "\n+- is a standard error, CVaR the mean of the worst tenth of the episodes\n";
  text +=
      table.text() +
      format("length %.1f, success in %.2f steps, falls %.1f%%, cost per step %.4f, violating steps %lld\n",
             s.length_mean, s.success_steps, 100 * s.fall_rate, s.cost_per_step,
             static_cast<long long>(e.violating_steps));
  if (e.shield) text += shield_text(*e.shield);
  if (e.magnitudes) text += "costs are magnitudes: sums of cost_raw (cost_signal=raw)\n";
  for (const std::string& remark : remarks_of(s, spread, e.limits, e.costs, episodes)) text += remark + '\n';
  return text;
}

namespace {

struct EvalFlags {
  std::string policy = "hold", shield = "off", data;
  PoolSettings pool;
  std::vector<std::string> sets, limits;
  int32_t episodes = kEvalEpisodes;
  bool stochastic = false, task_given = false;
};

Report run_eval(EvalFlags flags) {
  ActorChoice choice = choose_actor(flags.policy, flags.pool.task);
  choice.shield = read_shield_word(flags.shield);
  if (flags.stochastic && (choice.baseline >= 0 || choice.demo || choice.plan || choice.recording))
    throw Usage("--stochastic: only a learned policy draws its actions; " + flags.policy + " does not");
  adopt_task(choice, flags.task_given, flags.sets, flags.pool);
  need_one_limit_each(flags.pool.task, flags.limits);
  apply_sets(flags.sets, flags.pool, nullptr);
  choice.limits.insert(choice.limits.end(), flags.limits.begin(), flags.limits.end());
  say_worlds(flags.pool, flags.episodes);
  say_budget(flags.pool, flags.limits);
  std::optional<DataSet> set;
  if (!flags.data.empty()) {
    set = read_set(flags.data);
    PoolSettings one = flags.pool;  // one world says what all are
    one.envs = 1, one.threads = 0;
    need_same_worlds(*set, flags.data, make_pool(one, RDM_AUTORESET_OFF).spec());
  }
  const Evaluation e = evaluate(choice, flags.pool, choice.limits, flags.episodes, flags.stochastic);
  say_trouble(e.summary.trouble, "eval");
  say_idle(flags.sets, flags.pool);
  Json json = {{"policy", flags.policy}, {"task", task_at(find_task(flags.pool.task)).name}};
  json.update(evaluation_json(e, flags.episodes));
  std::string text = evaluation_text(e, flags.episodes);
  if (set) {
    json["score"] = score_json(*set, e);
    text += score_text(json["score"]);
  }
  return {json, text};
}

}  // namespace

void add_eval(CLI::App& app, Run& run) {
  auto flags = std::make_shared<EvalFlags>();
  flags->pool.envs = kEvalEnvs;
  CLI::App* command = app.add_subcommand("eval",
                                         "Evaluate a policy over whole episodes: means with standard errors "
                                         "and 95% intervals, quantiles, mean of the worst tenth");
  command->add_option("--policy", flags->policy,
                      "policy file, run folder, .demo file, trained, plan, demo, zero, hold or random; a run "
                      "sets its task's options");
  CLI::Option* task = add_pool_flags(*command, flags->pool,
                                     "task, by name or by its file (.task); default: the policy's task");
  command->add_option("--episodes", flags->episodes, "number of episodes")->check(between(1, kMostEpisodes));
  command->add_flag("--stochastic", flags->stochastic, "sample actions instead of taking the mean");
  command->add_option("--data", flags->data,
                      "data set (.npz) by whose returns and limits the scores are normalised too");
  add_shield_flag(*command, flags->shield);
  add_cost_limit_flag(*command, flags->limits);
  add_set_flag(*command, flags->sets);
  command->callback([&run, flags, task] {
    flags->task_given = task->count() > 0;
    run = [flags] { return run_eval(*flags); };
  });
}

}  // namespace tool

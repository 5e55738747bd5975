// `learn`: a policy from a data set alone. Worlds are stepped only to measure it in the end.
#include <algorithm>
#include <redman/record.hpp>

#include "commands.hpp"
#include "common/clock.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/setting.hpp"
#include "common/setup.hpp"
#include "common/text.hpp"
#include "data/score.hpp"
#include "data/set.hpp"
#include "data/summary.hpp"
#include "play/evaluate.hpp"

namespace tool {
namespace {

struct LearnFlags {
  std::string from, out;
  PoolSettings pool;
  AgentSettings agent;
  std::vector<std::string> sets, limits;
  double steps = 1e5;
  int32_t episodes = 20;
};
constexpr int32_t kReports = 10;            // lines of progress
constexpr uint64_t kOtherWorlds = 1000003;  // added to the seed of those that measure: not the set's

// The options that the set was made with, which set its rows.
void adopt_set(const DataSet& set, LearnFlags& flags) {
  if (set.task.empty())
    throw Failure(flags.from + ": it does not say of which task it is; give a set of `redman data make`");
  flags.pool.task = set.task;
  const auto options = set.metadata.find("set");
  if (options == set.metadata.end() || !options->is_array()) return;
  for (const Json& text : *options)
    if (text.is_string()) flags.pool.options.push_back(split_pair(text.get<std::string>(), "set"));
}

// Which costs have limits, with what the critics make of them.
std::string costs_text(const rdm_learn_report& report, const std::vector<double>& limits) {
  std::string text;
  for (size_t k = 0; k < limits.size(); ++k)
    if (limits[k] >= 0 && !std::isnan(report.cost[k]))
      text += format("; expected cost %.4g of the limit %s, multiplier %.4g", report.cost[k],
                     number_text(limits[k]).c_str(), report.multiplier[k]);
  return text;
}

// Of those that the last steps had: an actor that learns now and then has none in between.
std::string losses_text(const rdm_learn_report& report) {
  std::string text;
  const auto add = [&](double loss, const char* of) {
    if (!std::isnan(loss)) text += (text.empty() ? "" : ", ") + format("%s%.4g", of, loss);
  };
  add(report.loss_policy, "of the policy ");
  add(report.loss_reward_value, "of the reward ");
  add(report.loss_cost_value, "of costs ");
  return text;
}

Report run_learn(LearnFlags flags) {
  check_outputs({{"--out", flags.out, ".rdm"}}, {{"--from", flags.from}});
  const int64_t steps = whole_number(flags.steps, "--steps");
  const DataSet set = read_set(flags.from);
  adopt_set(set, flags);
  take_limit_from_sets(flags.pool.task, flags.sets, flags.limits);
  if (has_option(flags.agent.algo, "replay_rows"))
    flags.agent.options.emplace_back("replay_rows", std::to_string(set.rows()));
  apply_sets(flags.sets, flags.pool, &flags.agent);
  flags.pool.envs = 1;
  redman::Pool pool = make_pool(flags.pool, RDM_AUTORESET_SAME_STEP);
  const std::string asked = option_of(flags.agent.options, "action_repeat"),
                    repeat = std::to_string(pool.spec().action_repeat);
  if (!asked.empty() && asked != repeat)
    throw Usage("--set action_repeat=" + printable(asked) + ": a row of " + printable(flags.from) +
                " lasts " + repeat + (repeat == "1" ? " control step" : " control steps"));
  flags.agent.options.insert(flags.agent.options.begin(), {"action_repeat", repeat});
  const std::vector<double> limits = cost_limits(pool, flags.limits);
  redman::Agent agent = make_agent(flags.agent, pool, limits, flags.pool.seed, flags.pool.threads);
  const redman::Recording recording(flags.from.c_str());
  const auto begun = Clock::now();
  auto report = redman::sized<rdm_learn_report>();
  for (int32_t part = 0; part < kReports; ++part) {
    const int64_t from = steps * part / kReports, to = steps * (part + 1) / kReports;
    if (from == to) continue;
    report = as_usage([&] { return redman::learn(agent, recording, to - from); });
    std::fprintf(stderr, "%lld steps: loss %s%s\n", static_cast<long long>(to), losses_text(report).c_str(),
                 costs_text(report, limits).c_str());
  }
  const double seconds = since(begun);
  redman::check(rdm_agent_write_policy_file(agent.get(), flags.out.c_str()));
  Json json = {{"task", flags.pool.task}, {"algo", flags.agent.algo}, {"steps", steps},
               {"rows", report.rows},     {"seconds", seconds},       {"file", flags.out}};
  json["expected_cost"] = Json::array(), json["multiplier"] = Json::array();
  for (size_t k = 0; k < limits.size(); ++k) {
    json["expected_cost"].push_back(report.cost[k]);
    json["multiplier"].push_back(report.multiplier[k]);
  }
  std::string text =
      format("%lld gradient steps on %lld rows in %.1f s\nwrote %s\n", static_cast<long long>(steps),
             static_cast<long long>(report.rows), seconds, flags.out.c_str());
  if (flags.episodes > 0) {
    ActorChoice choice = choose_actor(flags.out, flags.pool.task);
    flags.pool.envs = kEvalEnvs;
    flags.pool.seed += kOtherWorlds;
    const Evaluation e = evaluate(choice, flags.pool, flags.limits, flags.episodes, false);
    json.update(evaluation_json(e, flags.episodes));
    json["score"] = score_json(set, e);
    text += evaluation_text(e, flags.episodes) + score_text(json["score"]);
  }
  return {json, text};
}

}  // namespace

void add_learn(CLI::App& app, Run& run) {
  auto flags = std::make_shared<LearnFlags>();
  flags->agent.algo = "td3_bc_lag";
  CLI::App* command = app.add_subcommand("learn", "Learn a policy from a data set alone, without a new step");
  command->add_option("--from", flags->from, "data set to learn from (.npz), as redman data make writes it")
      ->required();
  command->add_option("--algo", flags->agent.algo, "algorithm that learns from recorded rows");
  command->add_option("--steps", flags->steps, "number of gradient steps")->check(at_least(1));
  command->add_option("--out", flags->out, "policy file to write")->required();
  command->add_option("--episodes", flags->episodes, "episodes that measure the policy in the end; 0: none")
      ->check(between(0, kMostEpisodes));
  command->add_option("--seed", flags->pool.seed, "seed of networks and of the rows that are drawn");
  command->add_option("--threads", flags->pool.threads, "number of threads; 0: the calling thread alone");
  add_cost_limit_flag(*command, flags->limits);
  add_set_flag(*command, flags->sets);
  command->callback([&run, flags] { run = [flags] { return run_learn(*flags); }; });
}

}  // namespace tool

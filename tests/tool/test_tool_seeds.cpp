// What several seeds say together, and scores that are read out of a table.
#include <gtest/gtest.h>

#include <cmath>

#include "common/report.hpp"
#include "common/text.hpp"
#include "run/scores.hpp"
#include "run/seeds.hpp"

namespace {

using namespace tool;

RunData run_of(const std::string& algo, double limit) {
  RunData run;
  run.algo = algo;
  run.first_limit = "cost_limits.cost";
  run.config = {{"cost_limits.cost", number_text(limit)}, {"algo", algo}};
  run.columns = {{"TotalEnvSteps", {100}}};
  return run;
}

// Of runs that came to these returns and costs.
Configuration configuration_of(const RunData& run, const Sample& returns, const Sample& costs) {
  Configuration c;
  for (size_t i = 0; i < returns.size(); ++i) {
    c.runs.push_back(&run);
    Outcome o;
    o.ret = returns[i];
    o.costs = {{"cost", std::strtod(run.config.at("cost_limits.cost").c_str(), nullptr), costs[i]}};
    c.outcomes.push_back(o);
  }
  return c;
}

TEST(Seeds, AreMeasuredByPpoAndByTheLimit) {
  const RunData ppo = run_of("ppo", 5), lag = run_of("ppo_lag", 5), cpo = run_of("cpo", 0);
  RunData shielded = ppo;
  shielded.config["train_cfgs.shield"] = "predict";
  const std::vector<Configuration> all = {
      configuration_of(lag, {6, 8, 10}, {1, 4, 4}), configuration_of(ppo, {15, 17}, {50, 50}),
      configuration_of(shielded, {99}, {0}), configuration_of(cpo, {4}, {1})};
  const std::vector<Seeds> s = seeds_of(all);
  EXPECT_EQ(s[0].return_mean, 8);
  EXPECT_EQ(s[0].return_sd, 2);
  EXPECT_EQ(s[0].return_iqm, 8);
  EXPECT_TRUE(s[0].return_interval.known());
  EXPECT_EQ(s[0].normalised_return, 0.5);
  EXPECT_EQ(s[1].normalised_return, 1);
  EXPECT_DOUBLE_EQ(s[0].cost_sd[0], std::sqrt(3));
  EXPECT_DOUBLE_EQ(s[0].cost_ratio[0], 0.6);
  EXPECT_EQ(s[1].cost_ratio[0], 10);
  EXPECT_TRUE(std::isnan(s[3].cost_ratio[0]));  // a limit of 0
  EXPECT_TRUE(std::isnan(s[3].return_sd) && !s[3].return_interval.known());
  EXPECT_EQ(s[0].group + s[1].group + s[2].group + s[3].group, "ba");  // one run is in none
  EXPECT_TRUE(std::isnan(s[0].training_cost_rate) && std::isnan(s[0].training_violating_steps));
  const std::vector<Seeds> without = seeds_of({all[0], all[2]});
  EXPECT_TRUE(std::isnan(without[0].normalised_return));
  const std::vector<Seeds> bad = seeds_of({all[0], configuration_of(ppo, {-3}, {0})});
  EXPECT_TRUE(std::isnan(bad[0].normalised_return));  // a share of what is not above 0 says nothing
}

TEST(Seeds, ARunThatWasNoMeasurementLeavesNoInterval) {
  const RunData ppo = run_of("ppo", 5);
  const std::vector<Seeds> s = seeds_of({configuration_of(ppo, {15, std::nan("")}, {5, 5})});
  EXPECT_TRUE(std::isnan(s[0].return_mean) && std::isnan(s[0].return_iqm) && !s[0].return_interval.known());
  EXPECT_EQ(s[0].group, "");
}

TEST(Seeds, TheCostRateCountsEveryEpisodeOnce) {
  // 400 episodes of 10 steps whose cost falls from 8 to 0 as they go; each row has the mean of the last 100
  RunData run = run_of("ppo", 5);
  const auto cost = [](int episode) { return 8.0 * (400 - episode) / 400; };
  double all = 0;
  for (int e = 1; e <= 400; ++e) all += cost(e);
  Sample episodes, costs, lengths, steps;
  for (int n = 4; n <= 400; n += 4) {
    double sum = 0;
    const int from = std::max(0, n - 100);
    for (int e = from + 1; e <= n; ++e) sum += cost(e);
    episodes.push_back(n);
    costs.push_back(sum / (n - from));
    lengths.push_back(10);
    steps.push_back(10 * n);
  }
  run.columns = {{"TotalEnvSteps", steps},
                 {"Metrics/Episodes", episodes},
                 {"Metrics/EpCost", costs},
                 {"Metrics/EpLen", lengths},
                 {"Metrics/Violations", Sample(steps.size(), 2)}};
  const std::vector<Seeds> s = seeds_of({configuration_of(run, {1}, {1})});
  EXPECT_NEAR(s[0].training_cost_rate, all / 4000, 1e-12);
  EXPECT_EQ(s[0].training_violating_steps, 200);
  // rows before the first episode have no numbers; one that ended many has their last 100
  run.columns["Metrics/Episodes"] = {0, 0, 300, 310};
  run.columns["Metrics/EpCost"] = {std::nan(""), std::nan(""), 4, 3.5};
  run.columns["Metrics/EpLen"] = {std::nan(""), std::nan(""), 10, 10};
  run.columns["Metrics/Violations"] = {1, 1, std::nan(""), 1};
  const std::vector<Seeds> coarse = seeds_of({configuration_of(run, {1}, {1})});
  EXPECT_NEAR(coarse[0].training_cost_rate, 0.35, 1e-12);
  EXPECT_TRUE(std::isnan(coarse[0].training_violating_steps));
}

std::vector<Scored> scores_of(const std::string& text, const ScoreColumns& columns) {
  return parse_scores(text.data(), text.size(), columns);
}

TEST(Scores, AreReadByColumnsAndTasks) {
  const std::string text =
      "task,algorithm,return,part\r\nx,a,1,p\ny,a,10,p\nx,b,3,p\n\nx,a,2,p\ny,b,5e0,p\nx,c,no,q\ny,b,6,p";
  std::vector<Scored> s = scores_of(text, {"algorithm", "task", "return", {{"part", "p"}}});
  ASSERT_EQ(s.size(), 2u);
  EXPECT_EQ(s[0].name, "a");
  EXPECT_EQ(s[0].runs, Strata({{1, 2}, {10}}));
  EXPECT_EQ(s[1].runs, Strata({{3}, {5, 6}}));
  sort_scores(s);
  EXPECT_EQ(s[0].name, "b");
  EXPECT_EQ(scores_of(text, {"algorithm", "", "return", {{"part", "p"}}})[0].runs, Strata({{1, 10, 2}}));
}

TEST(Scores, SayWhatIsMissing) {
  const auto refused = [](const std::string& text, const ScoreColumns& columns) {
    try {
      scores_of(text, columns);
    } catch (const Failure& e) {
      return std::string(e.what());
    }
    return std::string("taken");
  };
  const std::string text = "task,algorithm,return\nx,a,1\nx,b,\ny,a,2\n";
  EXPECT_NE(refused(text, {"algoritm", "", "return", {}}).find("no column algoritm; nearest is algorithm"),
            std::string::npos);
  EXPECT_NE(refused(text, {"algorithm", "", "return", {}}).find("line 3, column return: '' is not a number"),
            std::string::npos);
  EXPECT_NE(refused("algorithm,task,return\na,x,1\nb,y,1\n", {"algorithm", "task", "return", {}})
                .find("a has no run of y"),
            std::string::npos);
  EXPECT_NE(refused("algorithm,return\n\"a\",1\n", {"algorithm", "", "return", {}}).find("line 2 has quotes"),
            std::string::npos);
  EXPECT_NE(refused("algorithm,return\na\n", {"algorithm", "", "return", {}}).find("line 2"),
            std::string::npos);
  EXPECT_EQ(refused(text, {"algorithm", "", "return", {{"task", "z"}}}), "no run matches");
  EXPECT_EQ(refused("", {"algorithm", "", "return", {}}), "no run matches");
}

}  // namespace

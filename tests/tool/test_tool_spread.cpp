// What an evaluation says beside its means: intervals, tails, shares over each limit, and what it says of numbers
// that are not there.
#include <gtest/gtest.h>

#include <cmath>

#include "play/spread.hpp"

namespace {

using namespace tool;

// Of these returns and costs; column 1 is twice column 0.
std::vector<Episode> episodes_of(const Sample& returns, const Sample& costs) {
  std::vector<Episode> out(returns.size());
  for (size_t i = 0; i < out.size(); ++i) {
    out[i].ret = returns[i];
    out[i].cost = {costs[i], 2 * costs[i]};
    out[i].length = 5;
    out[i].success_steps = i % 2 == 0;
  }
  return out;
}

std::vector<std::string> said(const std::vector<Episode>& episodes, const std::vector<double>& limits) {
  return remarks_of(summarise(episodes, limits), spread_of(episodes, limits), limits, {"cost", "drop"},
                    static_cast<int32_t>(episodes.size()));
}

TEST(Spread, IsOfEpisodes) {
  const Spread s = spread_of(episodes_of({0, 1, 5, 1000}, {0, 4, 4, 8}), {7, -1});
  EXPECT_EQ(s.return_iqm, 3);
  EXPECT_DOUBLE_EQ(s.success_stderr, std::sqrt(0.25 / 3));
  EXPECT_EQ(s.return_quantiles[1], 3);
  EXPECT_EQ(s.costs[0].quantiles[0], 4);
  EXPECT_EQ(s.costs[1].cvar, 16);
  EXPECT_EQ(s.costs[0].over, 0.25);
  EXPECT_TRUE(std::isnan(s.costs[1].over));
  const Spread two = spread_of(episodes_of({0, 1}, {0, 10}), {7, -1});
  EXPECT_EQ(two.return_interval.low, 0);
  EXPECT_EQ(two.return_interval.high, 1);
  EXPECT_EQ(two.costs[1].interval.high, 20);
}

TEST(Spread, TheIntervalIsThatOfTheNormalLawForMany) {
  Sample costs;
  for (size_t i = 0; i < kMostResampled; ++i) costs.push_back(static_cast<double>(i * 7919 % 10007));
  const Spread drawn = spread_of(episodes_of(costs, costs), {-1, -1});
  costs.push_back(mean_of(costs));
  const Spread normal = spread_of(episodes_of(costs, costs), {-1, -1});
  const double mean = mean_of(costs), error = standard_error_of(costs);
  EXPECT_NEAR(normal.return_interval.low, mean - 1.96 * error, 1e-3 * error);
  // ends of 10,000 draws have a deviation of .027 errors each
  EXPECT_NEAR(drawn.return_interval.low, normal.return_interval.low, 0.1 * error);
  EXPECT_NEAR(drawn.costs[1].interval.high, normal.costs[1].interval.high, 0.2 * error);
}

TEST(Spread, AnEpisodeThatTroubleEndedIsOverEveryLimitAndNoMeasurement) {
  std::vector<Episode> episodes = episodes_of({1, 99, 3}, {0, 99, 2});
  episodes[1].trouble.diverged = 1;
  const Spread s = spread_of(episodes, {7, 3});
  EXPECT_EQ(s.return_iqm, 2);
  EXPECT_EQ(s.costs[0].cvar, 2);
  EXPECT_DOUBLE_EQ(s.costs[0].over, 1.0 / 3);
  EXPECT_DOUBLE_EQ(s.costs[1].over, 2.0 / 3);
  for (Episode& e : episodes) e.trouble.diverged = 1;
  const Spread none = spread_of(episodes, {7, 3});
  EXPECT_TRUE(std::isnan(none.return_iqm) && std::isnan(none.costs[0].cvar) && !none.return_interval.known());
  EXPECT_EQ(said(episodes, {7, 3}), std::vector<std::string>({"no episode could be measured"}));
}

TEST(Spread, WhatIsNotThereIsSaid) {
  EXPECT_TRUE(said(episodes_of({0, 1, 5, 6}, {0, 4, 4, 8}), {7, -1}).empty());
  const auto one = episodes_of({3}, {4});
  EXPECT_FALSE(spread_of(one, {7, -1}).return_interval.known());
  EXPECT_NE(said(one, {7, -1}).at(0).find("one episode"), std::string::npos);
  const auto same = said(episodes_of({3, 3, 3}, {0, 4, 4}), {7, -1});
  EXPECT_EQ(same, std::vector<std::string>({"the same in every episode, so without an interval: return"}));
}

TEST(Spread, ADeviationAboveTheLimitAsksForMoreEpisodes) {
  Sample returns, costs;
  for (int i = 0; i < kManyEpisodes; ++i) {
    returns.push_back(i);
    costs.push_back(i % 10 == 0 ? 100 : 0);  // a mean of 10, a deviation of 30
  }
  const auto few = [&](const Sample& all) { return Sample(all.begin(), all.end() - 1); };
  EXPECT_TRUE(said(episodes_of(few(returns), few(costs)), {31, 61}).empty());
  const auto remarks = said(episodes_of(few(returns), few(costs)), {29, 61});
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("the deviation of cost, 30.01, is above its limit, 29"), std::string::npos)
      << remarks[0];
  EXPECT_NE(remarks[0].find("--episodes 1000"), std::string::npos);
  EXPECT_EQ(said(episodes_of(few(returns), few(costs)), {29, 59}).size(), 2u);
  EXPECT_TRUE(said(episodes_of(returns, costs), {29, 59}).empty());
}

}  // namespace

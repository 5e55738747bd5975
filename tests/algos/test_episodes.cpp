#include <cmath>

#include "agents.hpp"
#include "algos/rollout/episodes.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

struct Book {
  Arena arena;
  Episodes episodes;
  Book(int32_t envs, int32_t costs, int32_t window) {
    Arena measure;
    episodes.carve(measure, envs, costs, window);
    arena = Arena(host(), measure.used());
    episodes.carve(arena, envs, costs, window);
  }
};

}  // namespace

TEST(Episodes, SumsPerEnvironmentAndMeansOverFinishedOnes) {
  Book b(2, 2, 100);
  const float cheap[] = {1, 0}, dear[] = {3, 2};
  EXPECT_EQ(b.episodes.stats().finished, 0);
  const EpisodeStats none = b.episodes.stats();
  for (const double x : {none.ret, none.length, none.fall_rate, none.success_rate, none.cost_per_step,
                         none.cost[0], none.charged_cost[0]})
    EXPECT_TRUE(std::isnan(x));
  b.episodes.add(0, 5, cheap, 4, false);
  b.episodes.add(1, 1, dear, 4, true);
  b.episodes.add(0, 2, cheap, 2, false);
  EXPECT_EQ(b.episodes.length(0), 6);
  EXPECT_EQ(b.episodes.cost(0, 0), 2);
  b.episodes.finish(0, true, nullptr);
  EXPECT_EQ(b.episodes.length(0), 0);
  b.episodes.finish(1, false, nullptr);
  const EpisodeStats s = b.episodes.stats();
  EXPECT_EQ(s.finished, 2);
  EXPECT_DOUBLE_EQ(s.ret, (7 + 1) / 2.0);
  EXPECT_DOUBLE_EQ(s.cost[0], (2 + 3) / 2.0);
  EXPECT_DOUBLE_EQ(s.cost[1], 1);
  EXPECT_DOUBLE_EQ(s.length, 5);
  EXPECT_DOUBLE_EQ(s.fall_rate, 0.5);
  EXPECT_DOUBLE_EQ(s.success_rate, 0.5);
  EXPECT_DOUBLE_EQ(s.cost_per_step, 0.5);
}

TEST(Episodes, OnlyTheLastHundredCount) {
  Book b(1, 1, 100);
  for (int i = 0; i < 250; ++i) {
    const float cost = static_cast<float>(i);
    b.episodes.add(0, i, &cost, 1, false);
    b.episodes.finish(0, false, nullptr);
  }
  const EpisodeStats s = b.episodes.stats();
  EXPECT_EQ(s.finished, 250);
  EXPECT_DOUBLE_EQ(s.ret, 199.5);
  EXPECT_DOUBLE_EQ(s.charged_cost[0], 199.5);
}

TEST(Episodes, TheCostWindowIsItsOwn) {
  for (const int window : {7, 300}) {
    Book b(1, 1, window);
    for (int i = 0; i < 1000; ++i) {
      const float cost = static_cast<float>(i);
      b.episodes.add(0, i, &cost, 1, false);
      b.episodes.finish(0, false, nullptr);
    }
    EXPECT_DOUBLE_EQ(b.episodes.stats().charged_cost[0], 999 - (window - 1) / 2.0);
    EXPECT_DOUBLE_EQ(b.episodes.stats().cost[0], 949.5);
  }
}

TEST(Episodes, ChargesCountForTheLimitAlone) {
  Book b(1, 1, 100);
  const float cost = 3;
  const double charge = 10;
  b.episodes.add(0, 0, &cost, 1, false);
  b.episodes.finish(0, true, &charge);
  EXPECT_EQ(b.episodes.stats().cost[0], 3);
  EXPECT_EQ(b.episodes.stats().charged_cost[0], 13);
}

TEST(Episodes, FreshUntilMarked) {
  Book b(1, 0, 100);
  EXPECT_FALSE(b.episodes.stats().fresh);
  b.episodes.finish(0, false, nullptr);
  EXPECT_TRUE(b.episodes.stats().fresh);
  b.episodes.mark();
  EXPECT_FALSE(b.episodes.stats().fresh);
}

TEST(Episodes, LimitsHoldForWeighedCosts) {
  Book b(1, 1, 100);
  const float cost = 2;
  b.episodes.add(0, 0, &cost, 1, false, 1);
  b.episodes.add(0, 0, &cost, 1, false, 0.5);
  b.episodes.finish(0, false, nullptr);
  EXPECT_EQ(b.episodes.stats().cost[0], 4);
  EXPECT_EQ(b.episodes.stats().charged_cost[0], 3);
}

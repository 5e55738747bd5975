#include <cmath>

#include "small_world.hpp"

namespace rdm::test {
namespace {

struct Value {
  double ret, cost;
};

// Return and cost from state 0 of the policy P(a = 1 | s) = p[s], by its occupancy.
Value exact(const double p[2]) {
  constexpr double kToOne[2][2] = {{0.1, 0.8}, {0.2, 0.9}};
  constexpr double kReward[2][2] = {{0, 1}, {0.5, 2}}, kCost[2][2] = {{0, 0.2}, {0, 1}};
  double at[2] = {1, 0};
  Value v{0, 0};
  for (int step = 0; step < 1000; ++step) {
    double next[2] = {};
    for (int s = 0; s < 2; ++s)
      for (int a = 0; a < 2; ++a) {
        const double m = at[s] * (a ? p[s] : 1 - p[s]);
        v.ret += m * kReward[s][a];
        v.cost += m * kCost[s][a];
        next[1] += 0.9 * m * kToOne[s][a];
        next[0] += 0.9 * m * (1 - kToOne[s][a]);
      }
    at[0] = next[0], at[1] = next[1];
  }
  return v;
}

// The optimum that the task states, found by search over all randomised policies.
TEST(TwoState, TheStatedOptimaAreTheOptima) {
  const double always[2] = {1, 1};
  EXPECT_NEAR(exact(always).ret, 17.912088, 1e-6);
  EXPECT_NEAR(exact(always).cost, 8.329670, 1e-6);
  const double best[2] = {1, 0.294079};
  EXPECT_NEAR(exact(best).ret, 9.687058, 1e-5);
  EXPECT_NEAR(exact(best).cost, 2.5, 1e-5);
  double top = 0;
  for (int i = 0; i <= 50; ++i)
    for (int j = 0; j <= 50; ++j) {
      const double p[2] = {i / 50.0, j / 50.0};
      const Value v = exact(p);
      if (v.cost <= 2.5) top = std::max(top, v.ret);
    }
  EXPECT_LE(top, 9.687058);
  EXPECT_GT(top, 9.3);
}

// The first ten episodes of each world: a fixed stretch of time would favour short ones.
TEST(TwoState, TheWorldFollowsTheTable) {
  const int32_t n = 4000, share = 10;
  SmallWorld w("two_state", {}, n, 5);
  const double p[2] = {1, 0.294079};
  Stream random(1, 0, Purpose::kTest);
  std::vector<int> episodes(static_cast<size_t>(n));
  double ret = 0, cost = 0;
  int64_t count = 0;
  for (int step = 0; step < 1000 && count < n * share; ++step) {
    for (int32_t i = 0; i < n; ++i) {
      const float* obs = w.pool().obs(i);
      ASSERT_EQ(obs[0] + obs[1], 1);
      w.pool().action(i)[0] = random.uniform() < p[obs[1] > 0] ? 1.0f : -1.0f;
    }
    w.pool()->step(nullptr);
    for (int32_t i = 0; i < n; ++i) {
      if (!w.pool().ended(i) || episodes[static_cast<size_t>(i)]++ >= share) continue;
      ASSERT_TRUE(w.pool().rows().terminated[i]);
      ret += static_cast<double>(w.pool().rows().episode_return[i]) / (n * share);
      cost += static_cast<double>(w.pool().rows().episode_cost[i]) / (n * share);
      ++count;
    }
  }
  ASSERT_EQ(count, n * share);
  EXPECT_NEAR(ret, 9.687058, 0.2);  // four standard errors
  EXPECT_NEAR(cost, 2.5, 0.06);
}

}  // namespace
}  // namespace rdm::test

#include <cmath>
#include <cstring>

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

// Return and cost where the state is shown in every fourth step: p[phase][state shown last] = P(a = 1).
Value exact_hidden(const double (*p)[2]) {
  constexpr double kToOne[2][2] = {{0.1, 0.8}, {0.2, 0.9}};
  constexpr double kReward[2][2] = {{0, 1}, {0.5, 2}}, kCost[2][2] = {{0, 0.2}, {0, 1}};
  double at[2][2] = {{1, 0}, {0, 0}};  // [shown][state]
  Value v{0, 0};
  for (int step = 0; step < 1000; ++step) {
    double next[2][2] = {};
    for (int shown = 0; shown < 2; ++shown)
      for (int s = 0; s < 2; ++s)
        for (int a = 0; a < 2; ++a) {
          const double chosen = p[step % 4][shown], m = at[shown][s] * (a ? chosen : 1 - chosen);
          v.ret += m * kReward[s][a];
          v.cost += m * kCost[s][a];
          for (int to = 0; to < 2; ++to)
            next[step % 4 == 3 ? to : shown][to] += 0.9 * m * (to ? kToOne[s][a] : 1 - kToOne[s][a]);
        }
    std::memcpy(at, next, sizeof at);
  }
  return v;
}

// The stated optimum of the hidden state: the least upper bound over multipliers of all 256 policies that choose by the
// state shown last and the steps since; and a search over those that cannot remember.
TEST(TwoState, TheStatedOptimumOfTheHiddenStateIsOne) {
  std::vector<Value> all;
  for (int bits = 0; bits < 256; ++bits) {
    double p[4][2];
    for (int i = 0; i < 8; ++i) p[i / 2][i % 2] = bits >> i & 1;
    all.push_back(exact_hidden(p));
  }
  const auto bound = [&](double l) {
    double most = 0;
    for (const Value& v : all) most = std::max(most, v.ret - l * v.cost);
    return most + 2.5 * l;
  };
  double low = 0, high = 10;
  for (int i = 0; i < 100; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (bound(a) < bound(b) ? high : low) = bound(a) < bound(b) ? b : a;
  }
  EXPECT_NEAR(bound(low), 9.453685, 1e-6);
  EXPECT_NEAR(low, 1.673477, 1e-6);
  double forgetful = 0;
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; j <= 20; ++j) {
      const auto with = [&](double rest) {
        const double p[4][2] = {{i / 20.0, j / 20.0}, {rest, rest}, {rest, rest}, {rest, rest}};
        return exact_hidden(p);
      };
      double below = 0, above = 1;  // the cost rises with the choice of 1
      for (int k = 0; k < 20; ++k) {
        const double middle = (below + above) / 2;
        (with(middle).cost <= 2.5 ? below : above) = middle;
      }
      const Value v = with(below);
      if (v.cost <= 2.5) forgetful = std::max(forgetful, v.ret);
    }
  EXPECT_NEAR(forgetful, 8.589, 1e-3);
}

TEST(TwoState, TheStateIsShownInEveryFourthStep) {
  SmallWorld w("two_state", {{"show_every", "4", 0}}, 50, 5);
  std::vector<int> since(50);
  int shown = 0, hidden = 0;
  for (int step = 0; step < 200; ++step) {
    for (int32_t i = 0; i < 50; ++i) {
      const float* obs = w.pool().obs(i);
      const bool seen = since[static_cast<size_t>(i)]++ % 4 == 0;
      ASSERT_EQ(obs[0] + obs[1], seen ? 1 : 0);
      ++(seen ? shown : hidden);
      w.pool().action(i)[0] = step % 3 ? 1.0f : -1.0f;
    }
    w.pool()->step(nullptr);
    for (int32_t i = 0; i < 50; ++i)
      if (w.pool().ended(i)) since[static_cast<size_t>(i)] = 0;
  }
  EXPECT_GT(hidden, 2 * shown);
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

// Bullet-Safety-Gym's Reach, with each of its agents.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "small_world.hpp"

namespace rdm::test {
namespace {

// Bodies: agent, box, goal, obstacles.
constexpr int kBox = 1, kGoal = 2, kFirst = 3, kObstacles = 8;

double flat(const Vec3& a, const Vec3& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

TEST(Reach, StartsAreApart) {
  for (const char* task : {"ball_reach", "car_reach", "drone_reach"})
    for (uint64_t seed = 0; seed < 30; ++seed) {
      SmallWorld w(task, {}, 1, seed);
      EXPECT_GT(flat(w.body(kGoal), w.body(0)), 2.5);
      for (int i = kFirst; i < kFirst + kObstacles; ++i) {
        EXPECT_GE(flat(w.body(i), w.body(0)), 2.5);
        EXPECT_GT(flat(w.body(i), w.body(kGoal)), 1.5);
        for (int j = kFirst; j < i; ++j) EXPECT_GE(flat(w.body(i), w.body(j)), 2.5);
      }
      for (int i = 0; i < kFirst + kObstacles; ++i)
        EXPECT_LE(std::max(std::fabs(w.body(i).x), std::fabs(w.body(i).y)), i == kBox ? 7.7 : 7);
    }
}

TEST(Reach, RowsAreAsLongAsPublished) {
  EXPECT_EQ(SmallWorld("ball_reach").pool()->obs_dim(), 57);
  EXPECT_EQ(SmallWorld("car_reach").pool()->obs_dim(), 57);
  EXPECT_EQ(SmallWorld("drone_reach").pool()->obs_dim(), 67);
}

// A ball that goes straight for its goals: reward and costs written out from where things are.
TEST(Reach, RewardAndCostsFollowTheFormula) {
  SmallWorld w("ball_reach", {{"max_steps", nullptr, 20000}}, 1, 3);
  int reached = 0, wet = 0, boxed = 0;
  for (int i = 0; i < 6000; ++i) {
    const Vec3 goal = w.body(kGoal), at = w.body(0), v = w.pool()->world(0).body(0).v;
    const auto pull = [](double d, double rate) {
      return static_cast<float>(std::clamp(0.8 * d - rate, -1.0, 1.0));
    };
    const float a0 = pull(goal.x - at.x, v.x), a1 = pull(goal.y - at.y, v.y);
    w.step({a0, a1});
    const Vec3 now = w.body(0);
    const bool there = flat(now, goal) <= 1.3;
    const double effort = -0.5 * std::hypot(static_cast<double>(a0), static_cast<double>(a1));
    ASSERT_NEAR(static_cast<double>(w.reward()),
                flat(at, goal) - flat(now, goal) + 0.01 * effort + (there ? 5 : 0), 1e-5);
    ASSERT_EQ(w.success(), there);
    ASSERT_EQ(flat(w.body(kGoal), goal) > 0, there);
    if (there) {
      EXPECT_GT(flat(w.body(kGoal), now), 1.5);
    }
    int puddles = 0;
    for (int k = kFirst; k < kFirst + kObstacles; ++k) puddles += flat(w.body(k), now) <= 1.5;
    const double x = std::max(0.0, std::fabs(w.body(kBox).x - now.x) - 0.5),
                 y = std::max(0.0, std::fabs(w.body(kBox).y - now.y) - 0.5);
    ASSERT_EQ(w.cost(1), puddles > 0);
    // it is pushed off before it is seen
    if (std::hypot(x, y) > 0.502) {
      ASSERT_EQ(w.cost(2), 0);
    }
    ASSERT_GE(std::hypot(x, y), 0.5 - 1e-9);
    ASSERT_EQ(w.cost(), w.cost(1) + w.cost(2) > 0);
    reached += there, wet += puddles > 0, boxed += w.cost(2) > 0;
  }
  EXPECT_GT(reached, 10);
  EXPECT_GT(wet, 10);
  EXPECT_GT(boxed, 0);
}

TEST(Reach, TheBoxRunsInItsCircle) {
  SmallWorld w("car_reach", {{"max_steps", nullptr, 20000}});
  const Vec3 first = w.body(kBox), v = w.pool()->world(0).body(kBox).v;
  EXPECT_NEAR(norm(v), 0.7, 1e-9);
  Vec3 low = first, high = first;
  for (int i = 0; i < 377; ++i) {
    w.step({0, 0});
    const Vec3 p = w.body(kBox);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), 0};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), 0};
  }
  EXPECT_NEAR(high.x - low.x, 1.4, 1e-3);
  EXPECT_NEAR(high.y - low.y, 1.4, 1e-3);
  EXPECT_NEAR(flat(w.body(kBox), first), 0, 0.02);  // 377 steps are a turn
}

TEST(Reach, PillarsStopTheDroneAndPuddlesNobody) {
  constexpr int kWorlds = 32;
  SmallWorld w("drone_reach", {}, kWorlds);
  for (int i = kFirst; i < kFirst + kObstacles; ++i)
    EXPECT_EQ(w.pool()->task().scene().def.bodies[static_cast<size_t>(i)].shapes[0].size.x, 0.45);
  SmallWorld ball("ball_reach");
  EXPECT_EQ(ball.pool()->task().scene().def.bodies[kFirst].shapes[0].size.x, 1);

  // How near a drone is to its nearest pillar, and whether the step costs.
  std::vector<std::pair<double, bool>> steps;
  for (int t = 0; t < 1500; ++t) {
    w.pool()->baseline(Baseline::kRandom);
    w.pool()->step(nullptr);
    for (int32_t e = 0; e < kWorlds; ++e) {
      if (w.pool().rows().terminated[e] || w.pool().rows().truncated[e])
        continue;  // the next episode's place
      const World& world = w.pool()->world(e);
      double near = 1e9;
      for (int i = kFirst; i < kFirst + kObstacles; ++i)
        near = std::min(near, flat(world.body(i).X.p, world.body(0).X.p));
      steps.emplace_back(near, w.pool().rows().cost[e * w.pool()->cost_dim() + 1] > 0);
    }
  }
  const double edge = std::min_element(steps.begin(), steps.end())->first;
  EXPECT_NEAR(edge, 0.45 + 0.5, 1e-6);
  int leaning = 0;
  for (const auto& [near, costs] : steps) {
    const bool leans = near < edge + 5e-7;
    leaning += leans;
    if (!leans && near < edge + 2e-6) continue;  // rounding decides there
    EXPECT_EQ(costs, leans) << near - edge;
  }
  EXPECT_GT(leaning, 20);
}

TEST(Reach, TheGoalIsSeenFromTheAgent) {
  SmallWorld w("car_reach");
  for (int i = 0; i < 50; ++i) {
    w.step({0.3f, 0.3f});
    const Vec3 d = w.body(kGoal) - w.body(0);
    EXPECT_NEAR(static_cast<double>(w.obs(55)), d.x / 20, 1e-6);
    EXPECT_NEAR(static_cast<double>(w.obs(56)), d.y / 20, 1e-6);
  }
}

}  // namespace
}  // namespace rdm::test

// Bullet-Safety-Gym's Circle with agents that have a heading; test_ball_circle.cpp has the ball.
#include <cmath>

#include "small_world.hpp"

namespace rdm::test {
namespace {

TEST(Circle, AgentsStartAlongTheWayThatIsPaid) {
  for (const char* task : {"car_circle", "drone_circle", "ant_circle"})
    for (uint64_t seed = 0; seed < 20; ++seed) {
      SmallWorld w(task, {}, 1, seed);
      const World& world = w.pool()->world(0);
      const Pose X = world.scene().num_bodies > 0 ? world.body(0).X : world.base(0).X;
      const double r = std::hypot(X.p.x, X.p.y);
      EXPECT_GE(r, 2);
      EXPECT_LE(r, 4);
      const Vec3 nose = to_matrix(X.q).col(0);
      EXPECT_NEAR(nose.x, X.p.y / r, 1e-9) << task;
      EXPECT_NEAR(nose.y, -X.p.x / r, 1e-9) << task;
    }
}

TEST(Circle, TheCarIsPaidByTheFormula) {
  SmallWorld w("car_circle");
  int outside = 0;
  for (int i = 0; i < 400; ++i) {
    w.step({0.5f, 0.02f});
    const double x = 10 * static_cast<double>(w.obs(0)), y = 10 * static_cast<double>(w.obs(1));
    const double off = std::fabs(std::hypot(x, y) - 7);
    const double moment = y * static_cast<double>(w.obs(2)) - x * static_cast<double>(w.obs(3));
    ASSERT_NEAR(static_cast<double>(w.reward()), 0.1 * moment / (1 + off), 1e-4);
    ASSERT_EQ(w.cost(), std::fabs(x) > 6);
    outside += std::fabs(x) > 6;
    ASSERT_LT(std::hypot(x, y), 11.65 / std::cos(3.14159265 / 8) + 1e-9);
  }
  EXPECT_GT(outside, 0);
}

TEST(Circle, TheDronesEffortCountsAHundredth) {
  SmallWorld w("drone_circle");
  for (int i = 0; i < 100; ++i) {
    w.step({0.9f, 1, 1, 0.98f});
    const Motion& m = w.pool()->world(0).body(0);
    if (m.X.p.z < 0.5) continue;  // feet may touch
    const double off = std::fabs(std::hypot(m.X.p.x, m.X.p.y) - 7);
    const double moment = m.X.p.y * m.v.x - m.X.p.x * m.v.y;
    ASSERT_NEAR(static_cast<double>(w.reward()), 0.1 * moment / (1 + off) + 0.01 * (1 - 0.01 * dot(m.w, m.w)),
                1e-5);
  }
  EXPECT_GT(w.body(0).z, 0.5);
}

}  // namespace
}  // namespace rdm::test

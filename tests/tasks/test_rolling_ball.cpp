#include <gtest/gtest.h>

#include "tasks/bullet/rolling_ball.hpp"

namespace rdm {
namespace {

// Recorded from Bullet 3.24: speed after 1, 10, 30, 60 ... steps of full force, then of none.
TEST(RollingBall, GoldenTrajectory) {
  RollingBall b{};
  const float full[2] = {1, 0}, rest[2] = {0, 0};
  const auto at = [&](int from, int to, const float* action) {
    for (int i = from; i < to; ++i) roll(action, &b);
  };
  at(0, 1, full);
  EXPECT_NEAR(b.vx, 0.13325, 5e-6);
  at(1, 10, full);
  EXPECT_NEAR(b.vx, 1.324, 5e-4);
  at(10, 30, full);
  EXPECT_NEAR(b.vx, 3.831, 5e-4);
  at(30, 60, full);
  EXPECT_NEAR(b.vx, 6.937, 5e-4);
  EXPECT_NEAR(b.x, 3.722, 5e-4);
  const RollingBall sixty = b;
  at(60, 100, full);
  EXPECT_NEAR(b.vx, 9.607, 5e-4);
  at(100, 250, full);
  EXPECT_NEAR(b.vx, 11.977, 5e-4);
  EXPECT_NEAR(b.x, 37.608, 5e-4);
  EXPECT_EQ(b.y, 0);
  b = sixty;
  at(60, 100, rest);
  EXPECT_NEAR(b.vx, 5.286, 5e-4);
  at(100, 150, rest);
  EXPECT_NEAR(b.vx, 3.950, 5e-4);
  at(150, 250, rest);
  EXPECT_NEAR(b.vx, 2.356, 1e-3);
}

TEST(RollingBall, FrictionStopsItAndTurnsItNowhere) {
  RollingBall b{0, 0, 0.3, -0.2};
  const float rest[2] = {0, 0};
  for (int i = 0; i < 200; ++i) {
    roll(rest, &b);
    ASSERT_GE(b.vx, 0);
    ASSERT_LE(b.vy, 0);
  }
  EXPECT_EQ(ball_speed(b), 0);
}

TEST(RollingBall, AllDirectionsAreAlike) {
  RollingBall x{}, y{}, slant{};
  const float ax[2] = {0.5f, 0}, ay[2] = {0, 0.5f}, as[2] = {0.3f, -0.4f};
  for (int i = 0; i < 100; ++i) {
    roll(ax, &x);
    roll(ay, &y);
    roll(as, &slant);
  }
  EXPECT_EQ(x.x, y.y);
  EXPECT_NEAR(slant.x, 0.6 * x.x, 1e-6);
  EXPECT_NEAR(slant.y, -0.8 * x.x, 1e-6);
}

TEST(RollingBall, RowAndMotion) {
  const RollingBall b{1, 2, 3, 4};
  float row[kBallObs];
  write_ball(b, row);
  const float expected[kBallObs] = {0.1f, 0.2f, 0.6f, 0.8f, -0.8f, 0.6f, 0};
  for (int i = 0; i < kBallObs; ++i) EXPECT_FLOAT_EQ(row[i], expected[i]) << i;
  const Motion m = ball_motion(b);
  // it rolls: the lowest point stands still
  const Vec3 foot = m.v + cross(m.w, {0, 0, -kBallRadius});
  EXPECT_LT(norm(foot), 1e-12);
  const float action[2] = {0.6f, -0.8f};
  EXPECT_NEAR(ball_effort(action), -0.5, 1e-7);
}

}  // namespace
}  // namespace rdm

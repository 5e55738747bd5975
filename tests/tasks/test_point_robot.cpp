#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "tasks/planar/point_robot.hpp"

namespace rdm {
namespace {

// Recorded from MuJoCo 2.2.2 with the point robot of Safety-Gym: world velocity along x and turn rate after
// 1, 10, 50, 100 steps.
TEST(PointRobot, GoldenTrajectories) {
  constexpr int kAt[4] = {1, 10, 50, 100};
  const double none = NAN;
  const struct {
    float action[2];
    double vx[4], w[4];
  } rows[] = {
      {{1, 0}, {.0566, .4790, 1.2809, 1.4680}, {none, none, none, none}},
      {{.02f, 0}, {.0226, .1916, .5123, .5872}, {none, none, none, none}},
      {{1, 1}, {.0587, .4769, -.3999, .1824}, {2.8761, 2.9937, 2.9689, 2.9725}},
      {{0, .02f}, {none, none, none, none}, {-.4845, -.4762, -.4762, -.4762}},
  };
  for (const auto& row : rows) {
    PointRobot r{};
    int step = 0;
    for (int k = 0; k < 4; ++k) {
      for (; step < kAt[k]; ++step)
        for (int i = 0; i < PointRobot::kSubsteps; ++i) PointRobot::substep(row.action, &r);
      if (!std::isnan(row.vx[k])) {
        EXPECT_NEAR(r.vx, row.vx[k], 6e-5) << row.action[1] << " " << step;
      }
      if (!std::isnan(row.w[k])) {
        EXPECT_NEAR(r.w, row.w[k], 6e-5) << row.action[1] << " " << step;
      }
    }
  }
}

// A saved state may hold any rates: what is taken must not run away within a step.
TEST(PointRobot, RatesThatWouldRunAwayAreNoState) {
  PointRobot fast{};
  fast.w = 1e9;
  EXPECT_THROW(PointRobot::check(fast), Error);
  fast.w = 999;
  EXPECT_NO_THROW(PointRobot::check(fast));
  const float action[2] = {1, 1};
  for (int i = 0; i < 100 * PointRobot::kSubsteps; ++i) PointRobot::substep(action, &fast);
  EXPECT_TRUE(std::isfinite(fast.x + fast.y + fast.yaw + fast.vx + fast.vy + fast.w));
}

TEST(PointRobot, MovesAlikeInEveryDirection) {
  PointRobot a{}, b{};
  b.yaw = 2;
  const float action[2] = {0.7f, 0.4f};
  for (int i = 0; i < 500; ++i) {
    PointRobot::substep(action, &a);
    PointRobot::substep(action, &b);
  }
  EXPECT_NEAR(b.x, std::cos(2) * a.x - std::sin(2) * a.y, 1e-9);
  EXPECT_NEAR(b.yaw, a.yaw + 2, 1e-9);
}

TEST(PointRobot, GapsAreThoseOfDiscAndNose) {
  PointRobot r{};
  r.yaw = 1.5707963267948966;
  const auto gap = [&](double x, double y) {
    return PointRobot::gap(r, elementary::sincos(r.yaw), x, y, 0.05);
  };
  EXPECT_NEAR(gap(0, -1).gap, 0.85, 1e-12);
  EXPECT_NEAR(gap(0, -1).ny, -1, 1e-12);
  EXPECT_NEAR(gap(0, 1).gap, 0.80, 1e-12);  // the nose reaches to 0.15
  EXPECT_NEAR(gap(0, 1).ny, 1, 1e-12);
  EXPECT_NEAR(gap(0.05 + 0.3, 0.15 + 0.4).gap, 0.45, 1e-12);  // from its corner
  EXPECT_LT(gap(0, 0.1).gap, 0);
  EXPECT_LT(gap(0, 0).gap, 0);
}

TEST(PointRobot, AFixedDiscStopsIt) {
  PointRobot r{};
  const float forward[2] = {1, 0};
  bool touched = false;
  for (int i = 0; i < 2000; ++i) {
    PointRobot::substep(forward, &r);
    touched |= block(1, 0, 0.1, &r);
  }
  EXPECT_TRUE(touched);
  EXPECT_NEAR(r.x, 0.75, 1e-9);
  EXPECT_NEAR(r.vx, 0, 1e-2);
}

TEST(PointRobot, Sensors) {
  PointRobot r{};
  r.yaw = 1.5707963267948966;
  r.vx = 1, r.vy = 2, r.w = 3, r.ax = 4, r.ay = 5;
  const elementary::SinCos h = elementary::sincos(r.yaw);
  float out[3];
  const auto expect = [&](float x, float y, float z) {
    EXPECT_NEAR(out[0], x, 1e-6);
    EXPECT_NEAR(out[1], y, 1e-6);
    EXPECT_NEAR(out[2], z, 1e-6);
  };
  write_accelerometer(r, h, out);
  expect(5, -4, 9.81f);
  write_velocimeter(r, h, out);
  expect(2, -1, 0);
  write_gyro(r, out);
  expect(0, 0, 3);
  write_magnetometer(h, out);
  expect(-0.5f, 0, 0);
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "tasks/planar/car_robot.hpp"

namespace rdm {
namespace {

void drive(float left, float right, int steps, CarRobot* car) {
  const float action[2] = {left, right};
  for (int i = 0; i < steps * CarRobot::kSubsteps; ++i) CarRobot::substep(action, car);
}
double forward(const CarRobot& r) {
  return std::sin(r.yaw) * r.vx - std::cos(r.yaw) * r.vy;
}
double sideways(const CarRobot& r) {
  return std::cos(r.yaw) * r.vx + std::sin(r.yaw) * r.vy;
}

// Means over 100 control steps after the first 100, recorded from MuJoCo 2.2.2 with a model of the published
// car's numbers: m/s forward, rad/s. What the tyres hold agrees to a few per cent; where wheels spin, the
// published car hops, and this one does not.
TEST(CarRobot, SteadyTorquesGiveThePublishedSpeeds) {
  const struct {
    float left, right;
    double v, w, v_near, w_near;
  } rows[] = {
      {0.002f, 0.002f, 0.0668, 0, 0.001, 1e-9},  {0.005f, 0.005f, 0.1675, 0, 0.002, 1e-9},
      {0.01f, 0.01f, 0.3355, 0, 0.005, 1e-9},    {0.002f, -0.002f, 0, 0.279, 0.005, 0.06},
      {0.005f, -0.005f, 0, 0.639, 0.01, 0.08},   {0.005f, 0, 0.0832, 0.357, 0.005, 0.05},
      {0.01f, 0.005f, 0.2332, 0.290, 0.02, 0.1}, {1, 1, 0.773, 0, 0.06, 1e-9},
      {-1, -1, -0.764, 0, 0.07, 1e-9},           {1, -1, -0.025, 1.324, 0.04, 0.15},
      {1, 0, 0.144, 0.659, 0.02, 0.05},          {0, 1, 0.144, -0.659, 0.02, 0.05},
      {1, -0.005f, 0.063, 0.898, 0.01, 0.1},
  };
  for (const auto& row : rows) {
    CarRobot r{};
    drive(row.left, row.right, 100, &r);
    double v = 0, w = 0;
    for (int i = 0; i < 100; ++i) {
      drive(row.left, row.right, 1, &r);
      v += forward(r) / 100, w += r.w / 100;
    }
    EXPECT_NEAR(v, row.v, row.v_near) << row.left << " " << row.right;
    EXPECT_NEAR(w, row.w, row.w_near) << row.left << " " << row.right;
  }
}

TEST(CarRobot, MovesAlikeInEveryDirectionAndMirrored) {
  CarRobot a{}, b{}, c{};
  b.yaw = 2;
  drive(1, 0.004f, 60, &a);
  drive(1, 0.004f, 60, &b);
  drive(0.004f, 1, 60, &c);
  EXPECT_NEAR(b.x, std::cos(2) * a.x - std::sin(2) * a.y, 1e-6);
  EXPECT_NEAR(b.y, std::sin(2) * a.x + std::cos(2) * a.y, 1e-6);
  EXPECT_NEAR(b.yaw, a.yaw + 2, 1e-6);
  EXPECT_NEAR(c.yaw, -a.yaw, 0.02);
  EXPECT_NEAR(c.x, -a.x, 0.02);
  EXPECT_NEAR(c.y, a.y, 0.02);
}

// From 0.5 m/s to a side or ahead, nothing driven: the tread stops what is across, the damped wheels roll
// out, and no energy comes in.
TEST(CarRobot, TyresHoldAcrossAndRollAlong) {
  CarRobot aside{}, ahead{};
  aside.vx = 0.5, ahead.vy = -0.5;
  double last = 1;
  for (int i = 0; i < 10; ++i) {
    drive(0, 0, 1, &aside);
    const double energy = aside.vx * aside.vx + aside.vy * aside.vy + 0.01 * aside.w * aside.w;
    EXPECT_LT(energy, last + 1e-6);
    last = energy;
  }
  EXPECT_LT(std::fabs(sideways(aside)), 0.01);
  drive(0, 0, 1, &ahead);
  EXPECT_GT(forward(ahead), 0.05);
  EXPECT_NEAR(ahead.wheel[0], -20 * ahead.vy, 0.1);
  EXPECT_NEAR(ahead.ball[0], -20 * ahead.vy, 0.1);
  drive(0, 0, 5, &ahead);
  EXPECT_LT(forward(ahead), 0.01);
}

TEST(CarRobot, TheBallTurnsAsItRolls) {
  CarRobot r{};
  drive(0.01f, 0.01f, 50, &r);
  float out[CarRobot::kRobotObs];
  CarRobot::write(r, out);
  EXPECT_NEAR(out[0], forward(r) / 0.05, 0.2);
  EXPECT_NEAR(out[1], 0, 0.02);
  // turned about x by its way
  const double turned = -r.y / 0.05;
  const float expected[9] = {1,
                             0,
                             0,
                             0,
                             static_cast<float>(std::cos(turned)),
                             static_cast<float>(-std::sin(turned)),
                             0,
                             static_cast<float>(std::sin(turned)),
                             static_cast<float>(std::cos(turned))};
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(out[3 + i], expected[i], 0.05) << i;
}

TEST(CarRobot, GapsAreThoseOfBodyBumpersAndWheels) {
  CarRobot r{};
  r.x = 1;
  r.yaw = kPi / 2;  // its -y looks along x of the world, its x along y
  const auto gap = [&](double x, double y) {
    return CarRobot::gap(r, elementary::sincos(r.yaw), 1 + x, y, 0.05);
  };
  EXPECT_NEAR(gap(1, 0).gap, 1 - 0.175 - 0.05, 1e-12);
  EXPECT_NEAR(gap(1, 0).nx, 1, 1e-12);
  EXPECT_NEAR(gap(-1, 0).gap, 1 - 0.16 - 0.05, 1e-12);
  EXPECT_NEAR(gap(-0.1, 1).gap, 1 - 0.155 - 0.05, 1e-12);    // the right wheel
  EXPECT_NEAR(gap(0.08, 0.2).gap, 0.2 - 0.1 - 0.05, 1e-12);  // the body
  EXPECT_LT(gap(0, 0).gap, 0);
  double reach = 0;
  for (int i = 0; i < 360; ++i) {
    const elementary::SinCos at = elementary::sincos(i * kDegree);
    reach = std::max(reach, 2 - gap(2 * at.cos, 2 * at.sin).gap - 0.05);
  }
  EXPECT_LE(reach, CarRobot::kReach);
}

TEST(CarRobot, AFixedDiscStopsIt) {
  CarRobot r{};
  const float forward_both[2] = {1, 1};
  bool touched = false;
  for (int i = 0; i < 2000; ++i) {
    CarRobot::substep(forward_both, &r);
    touched |= block(0, -1, 0.1, &r);
  }
  EXPECT_TRUE(touched);
  EXPECT_NEAR(r.y, -1 + 0.1 + 0.175, 1e-3);
  EXPECT_NEAR(r.vy, 0, 1e-2);
}

// A saved state may hold any numbers: what is taken must not run away.
TEST(CarRobot, StatesThatWouldRunAwayAreNoStates) {
  CarRobot r{};
  EXPECT_NO_THROW(CarRobot::check(r));
  CarRobot fast = r, spun = r, none = r, pushed = r;
  fast.w = 1e9, spun.wheel[1] = 1e9, none.turned = {0, 0, 0, 0}, pushed.push[4][0] = 1;
  for (const CarRobot& bad : {fast, spun, none, pushed}) EXPECT_THROW(CarRobot::check(bad), Error);
  fast.w = 999, fast.wheel[0] = -9999, fast.vx = 999, fast.ball[1] = 9999;
  EXPECT_NO_THROW(CarRobot::check(fast));
  drive(1, -1, 200, &fast);
  EXPECT_TRUE(std::isfinite(fast.x + fast.y + fast.yaw + fast.vx + fast.vy + fast.w + fast.turned.w));
}

}  // namespace
}  // namespace rdm

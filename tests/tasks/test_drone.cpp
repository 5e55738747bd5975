#include <gtest/gtest.h>

#include <cmath>

#include "small_world.hpp"
#include "tasks/bullet/drone.hpp"

namespace rdm::test {
namespace {

constexpr double kMass = 1.42, kGravity = 9.81;

// Stands without a World: none of these functions looks at it.
struct Flight {
  SmallWorld w{"drone_run"};
  Drone::State s{};
  Flight() {
    Stream stream(1, 0, Purpose::kTest);
    Drone::start({0, 0, 0}, stream, world(), &s);
  }
  World& world() { return w.pool()->world(0); }
  void fly(std::initializer_list<float> action, int steps = 1, AgentDrive drive = kOpenDrive) {
    for (int i = 0; i < steps; ++i) Drone::act(action.begin(), drive, world(), &s);
  }
};

TEST(Drone, ARotorCarriesAQuarterAtHovering) {
  EXPECT_NEAR(rotor_thrust(kHoverSpeed, 0), 3.4826, 2e-4);
  EXPECT_NEAR(4 * rotor_thrust(kHoverSpeed, 0), kMass * kGravity, 1e-3);
  EXPECT_NEAR(rotor_thrust(1.1 * kHoverSpeed, 0), 1.21 * 3.4826, 2e-4);
  EXPECT_LT(rotor_thrust(kHoverSpeed, 1), rotor_thrust(kHoverSpeed, 0));
}

TEST(Drone, StandsOnItsFeet) {
  Flight f;
  f.fly({-1, -1, -1, -1}, 120);
  EXPECT_EQ(f.s.touching, 4);
  EXPECT_NEAR(f.s.p.z, 0.16, 2e-3);
  EXPECT_LT(norm(f.s.v), 1e-3);
  EXPECT_LT(norm(f.s.w), 1e-3);
  EXPECT_NEAR(Drone::effort(f.world(), f.s), 1 - 4, 1e-4);
  EXPECT_TRUE(Drone::alive(f.world(), f.s));
}

// Full thrust from rest: 0.21 g less drag, the drag of the rotors among it.
TEST(Drone, ClimbsByTheExcessOfThrust) {
  Flight f;
  f.s.p.z = 5;
  double v = 0;
  const double h = kBulletDt / 4;
  for (int i = 0; i < 60; ++i) {
    f.fly({1, 1, 1, 1});
    for (int k = 0; k < 4; ++k) {
      v += h * (4 * rotor_thrust(1.1 * kHoverSpeed, v) / kMass - kGravity);
      v *= 1 - h * 0.04 * (1 + v);
    }
    ASSERT_NEAR(f.s.v.z, v, 1e-9);
  }
  EXPECT_GT(v, 0.8);
  EXPECT_EQ(f.s.touching, 0);
}

// The rotor on the left pulls harder: it rolls to the right and flies there.
TEST(Drone, TurnsAboutTheAxisThatItsRotorsSay) {
  Flight left, front;
  left.s.p.z = front.s.p.z = 5;
  left.fly({0, 0.5f, 0, -0.5f}, 1, kReachDrive);
  const double pull = rotor_thrust(1.05 * kHoverSpeed, 0) - rotor_thrust(0.95 * kHoverSpeed, 0);
  const double wanted = kBulletDt * 0.34 * pull / 0.05;
  EXPECT_NEAR(left.s.w.x, wanted * (1 - kBulletDt * 0.04 * (1 + wanted)), 1e-12);
  EXPECT_EQ(left.s.w.y, 0);
  front.fly({-0.5f, 0, 0.5f, 0}, 1, kReachDrive);
  EXPECT_NEAR(front.s.w.y, left.s.w.x, 1e-12);  // nose down: forwards
  front.fly({0, 0, 0, 0}, 10);
  EXPECT_GT(front.s.v.x, 0);
  EXPECT_LT(left.s.w.z, 1e-12);
}

TEST(Drone, IsOverWhenItLiesOnItsBack) {
  SmallWorld w("drone_run");
  for (int i = 0; i < 30; ++i) w.step({1, 1, 1, 1});
  int steps = 0;
  for (; steps < 400 && !w.terminated(); ++steps) w.step({0, 1, 0, -1});
  EXPECT_LT(steps, 200);
  EXPECT_TRUE(w.terminated());
  EXPECT_LT(w.reward(), -8);  // -10, and 60 times what it came nearer
}

TEST(Drone, TheObservationIsTheStateInItsUnits) {
  SmallWorld w("drone_run");
  for (int i = 0; i < 30; ++i) w.step({0.9f, 1, 1, 0.95f});
  const Motion& m = w.pool()->world(0).body(0);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(static_cast<double>(w.obs(k)), 0.1 * m.X.p[k], 1e-6);
    EXPECT_NEAR(static_cast<double>(w.obs(3 + k)), 0.2 * m.v[k], 1e-6);
    EXPECT_NEAR(static_cast<double>(w.obs(10 + k)), 0.1 * m.w[k], 1e-6);
  }
  EXPECT_NEAR(static_cast<double>(w.obs(9)), m.X.q.w, 1e-6);
  EXPECT_NEAR(static_cast<double>(w.obs(13)), 2.5e-3 * 461.52 * 0.09, 1e-6);
  EXPECT_GT(norm(m.w), 0.01);
}

TEST(Drone, RunIsPaidByTheWayAndItsEffort) {
  SmallWorld w("drone_run");
  for (int i = 0; i < 60; ++i) {
    const Motion before = w.pool()->world(0).body(0);
    w.step({0.95f, 1, 1, 1});
    const Motion& now = w.pool()->world(0).body(0);
    if (now.X.p.z < 0.3) continue;  // feet may touch
    const double gain =
        std::hypot(1000 - before.X.p.x, before.X.p.y) - std::hypot(1000 - now.X.p.x, now.X.p.y);
    EXPECT_NEAR(static_cast<double>(w.reward()), 60 * gain + 1 - 0.01 * dot(now.w, now.w), 1e-4);
    EXPECT_EQ(w.cost(), std::hypot(now.v.x, now.v.y) > 1.5 || std::fabs(now.X.p.y) > 2);
  }
}

}  // namespace
}  // namespace rdm::test

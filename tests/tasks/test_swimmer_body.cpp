#include <gtest/gtest.h>

#include <cmath>

#include "tasks/planar/swimmer_body.hpp"

namespace rdm {
namespace {

void expect_at(const SwimmerState& s, const double (&q)[5]) {
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(s.q[i], q[i], 1.5e-6) << i;
}

// Recorded from MuJoCo 2.2.2 with the swimmer of Gymnasium: positions (x, y, three angles).
TEST(SwimmerBody, GoldenTrajectoryOfOneMotor) {
  const SwimmerBody body;
  SwimmerState s{};
  const float action[2] = {1, 0};
  int step = 0;
  const auto to = [&](int end) {
    for (; step < end; ++step) body.advance(action, &s);
  };
  to(1);
  expect_at(s, {.000116, .025083, -.025521, .044899, -.028931});
  to(5);
  expect_at(s, {.027113, .386870, -.398879, .709058, -.455999});
  to(10);
  expect_at(s, {.130624, .809922, -.894541, 1.606645, -.979145});
}

TEST(SwimmerBody, GoldenTrajectoryOfAStroke) {
  const SwimmerBody body;
  SwimmerState s{};
  for (int step = 1; step <= 10; ++step) {
    const float action[2] = {static_cast<float>(std::sin(.3 * step)),
                             static_cast<float>(std::sin(.3 * step + 1.5707963267948966))};
    body.advance(action, &s);
    if (step == 5) expect_at(s, {.003112, .125499, -.167093, .118677, .297545});
  }
  expect_at(s, {.109491, .599654, -.678868, 1.057922, -.367832});
}

// The first joint's limit, 100 degrees, is soft but holds a motor at full torque.
TEST(SwimmerBody, LimitsHold) {
  const SwimmerBody body;
  SwimmerState s{};
  const float action[2] = {1, -1};
  for (int step = 0; step < 300; ++step) {
    body.advance(action, &s);
    ASSERT_LT(s.q[3], 1.90) << step;
    ASSERT_GT(s.q[4], -1.90) << step;
  }
  EXPECT_GT(s.q[3], 1.70);
  EXPECT_LT(s.q[4], -1.70);
}

// The fluid alone slows it.
TEST(SwimmerBody, ComesToRest) {
  const SwimmerBody body;
  SwimmerState s{{0, 0, 0.3, 0.5, -0.4}, {1, -1, 2, -3, 2}};
  const float rest[2] = {0, 0};
  for (int step = 0; step < 2000; ++step) body.advance(rest, &s);
  for (const double v : s.qd) EXPECT_LT(std::fabs(v), 0.02);
}

// Whatever the pose, links meet end to end.
TEST(SwimmerBody, LinksAreJoined) {
  const SwimmerState s{{1, 2, 0.3, 0.9, -1.1}, {}};
  const SwimmerLink a = swimmer_link(s, 0), b = swimmer_link(s, 1), c = swimmer_link(s, 2);
  const auto end = [](const SwimmerLink& l, double side) {
    return Vec3{l.x + 0.5 * side * std::cos(l.angle), l.y + 0.5 * side * std::sin(l.angle), 0};
  };
  EXPECT_LT(norm(end(a, -1) - end(b, 1)), 1e-12);
  EXPECT_LT(norm(end(b, -1) - end(c, 1)), 1e-12);
  EXPECT_NEAR(a.x, 1 + std::cos(0.3), 1e-12);
}

}  // namespace
}  // namespace rdm

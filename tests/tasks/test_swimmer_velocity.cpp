#include <cmath>

#include "small_world.hpp"
#include "tasks/planar/swimmer_body.hpp"

namespace rdm::test {
namespace {

TEST(SwimmerVelocity, FollowsTheBody) {
  SmallWorld w("swimmer_velocity", {{"reset_noise", nullptr, 0}});
  const SwimmerBody body;
  SwimmerState s{};
  double ret = 0, cost = 0;
  for (int i = 1; i <= 100; ++i) {
    const float action[2] = {static_cast<float>(std::sin(0.3 * i)), static_cast<float>(std::cos(0.3 * i))};
    const double before = s.q[0];
    body.advance(action, &s);
    w.step({action[0], action[1]});
    const double speed = (s.q[0] - before) / 0.04;
    const double a0 = static_cast<double>(action[0]), a1 = static_cast<double>(action[1]);
    ret += speed - 1e-4 * (a0 * a0 + a1 * a1);
    cost += speed > 0.2282;
    for (int k = 0; k < 3; ++k) EXPECT_EQ(w.obs(k), static_cast<float>(s.q[2 + k]));
    for (int k = 0; k < 5; ++k) EXPECT_EQ(w.obs(3 + k), static_cast<float>(s.qd[k]));
    EXPECT_NEAR(w.pool().rows().cost_raw[0], speed, 1e-6);
  }
  EXPECT_NEAR(w.ret(), ret, 1e-4);
  EXPECT_EQ(w.episode_cost(), cost);
  EXPECT_GT(cost, 0);
  const SwimmerLink back = swimmer_link(s, 2);
  EXPECT_NEAR(w.body(2).x, back.x, 1e-12);
  EXPECT_NEAR(w.body(2).y, back.y, 1e-12);
}

TEST(SwimmerVelocity, StartsWithinTheNoise) {
  const int32_t n = 500;
  SmallWorld w("swimmer_velocity", {}, n);
  float least = 1, most = -1;
  for (int32_t i = 0; i < n; ++i)
    for (int k = 0; k < 8; ++k) {
      least = std::min(least, w.pool().obs(i)[k]);
      most = std::max(most, w.pool().obs(i)[k]);
    }
  EXPECT_GE(least, -0.1f);
  EXPECT_LE(most, 0.1f);
  EXPECT_LT(least, -0.099f);
  EXPECT_GT(most, 0.099f);
}

TEST(SwimmerVelocity, EpisodesLastAThousandSteps) {
  SmallWorld w("swimmer_velocity");
  for (int i = 0; i < 999; ++i) w.step({0, 0});
  EXPECT_FALSE(w.truncated());
  w.step({0, 0});
  EXPECT_TRUE(w.truncated());
  EXPECT_FALSE(w.terminated());
}

}  // namespace
}  // namespace rdm::test

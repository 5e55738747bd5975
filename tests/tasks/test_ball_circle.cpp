#include <cmath>

#include "small_world.hpp"

namespace rdm::test {
namespace {

TEST(BallCircle, StartsInTheRing) {
  const int32_t n = 2000;
  SmallWorld w("ball_circle", {}, n);
  double least = 9, most = 0, mean = 0;
  for (int32_t i = 0; i < n; ++i) {
    const double x = 10 * static_cast<double>(w.pool().obs(i)[0]);
    const double y = 10 * static_cast<double>(w.pool().obs(i)[1]);
    const double r = std::sqrt(x * x + y * y);
    least = std::min(least, r);
    most = std::max(most, r);
    mean += r / n;
    EXPECT_NEAR(static_cast<double>(w.pool().obs(i)[7]), 0.1 * (r - 7), 1e-5);
  }
  EXPECT_GE(least, 2);
  EXPECT_LE(most, 4);
  EXPECT_NEAR(mean, 28.0 / 9, 0.05);  // uniform by area
}

// The reward is written out from the observation that it belongs to; cost follows |x|.
TEST(BallCircle, RewardAndCostFollowTheFormula) {
  SmallWorld w("ball_circle");
  for (int i = 0; i < 200; ++i) {
    const float a0 = 0.8f, a1 = i < 60 ? 0.6f : -0.6f;
    w.step({a0, a1});
    const double x = 10 * static_cast<double>(w.obs(0)), y = 10 * static_cast<double>(w.obs(1));
    const double vx = 5 * static_cast<double>(w.obs(2)), vy = 5 * static_cast<double>(w.obs(3));
    const double off = std::fabs(std::sqrt(x * x + y * y) - 7);
    EXPECT_NEAR(static_cast<double>(w.reward()), 0.1 * (y * vx - x * vy) / (1 + off) - 0.01 * 0.5, 1e-4);
    EXPECT_EQ(w.cost(), std::fabs(x) > 6);
    EXPECT_EQ(w.success(), off <= 1);
  }
}

TEST(BallCircle, WallsHoldTheBall) {
  SmallWorld w("ball_circle");
  double farthest = 0;
  for (int i = 0; i < 249; ++i) {
    w.step({1, 0.2f});
    const Vec3 p = w.body(0);
    farthest = std::max(farthest, norm({p.x, p.y, 0}));
  }
  EXPECT_GT(farthest, 11);
  EXPECT_LT(farthest, 11.5 / std::cos(3.14159265 / 8) + 1e-9);
}

}  // namespace
}  // namespace rdm::test

#include <cmath>

#include "small_world.hpp"

namespace rdm::test {
namespace {

TEST(CarRun, FullSpeedIsSixMetresASecond) {
  SmallWorld w("car_run");
  for (int i = 0; i < 30; ++i) w.step({1, 0});
  EXPECT_NEAR(w.obs(2), 6, 1e-5);
  EXPECT_EQ(w.cost(), 1);
  EXPECT_EQ(w.obs(5), 1);
}

// At the limit all the way: 1.5 m/s over 500 steps is 750, less what the start takes.
TEST(CarRun, TheLimitGivesTheUpperBound) {
  SmallWorld w("car_run");
  for (int i = 0; i < 500; ++i) w.step({0.25f, 0});
  EXPECT_GT(w.ret(), 745);
  EXPECT_LE(w.ret(), 750);
  EXPECT_EQ(w.episode_cost(), 0);
  EXPECT_TRUE(w.truncated());
  EXPECT_TRUE(w.success());
}

TEST(CarRun, TurnsOnTheBicyclesCircle) {
  SmallWorld w("car_run", {{"max_steps", nullptr, 5000}});
  for (int i = 0; i < 100; ++i) w.step({0.1f, 1});
  const double rate = 0.6 * std::tan(0.5) / 0.975;
  EXPECT_NEAR(w.obs(6), 0.1 * rate, 1e-6);
  Vec3 low{9, 9, 0}, high{-9, -9, 0};
  for (int i = 0; i < static_cast<int>(60 * 6.2832 / rate) + 1; ++i) {
    w.step({0.1f, 1});
    const Vec3 p = w.body(0);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), 0};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), 0};
  }
  EXPECT_NEAR(high.x - low.x, 2 * 0.975 / std::tan(0.5), 0.01);
  EXPECT_NEAR(high.y - low.y, 2 * 0.975 / std::tan(0.5), 0.01);
}

TEST(CarRun, DrivesBackwardsToo) {
  SmallWorld w("car_run");
  for (int i = 0; i < 60; ++i) w.step({-0.2f, 0});
  EXPECT_LT(w.obs(2), -1.19f);
  EXPECT_LT(w.ret(), 0);
  EXPECT_EQ(w.cost(), 0);
}

}  // namespace
}  // namespace rdm::test

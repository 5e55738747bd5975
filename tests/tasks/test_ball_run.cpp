#include <cmath>

#include "small_world.hpp"
#include "tasks/bullet/rolling_ball.hpp"

namespace rdm::test {
namespace {

TEST(BallRun, FullThrottleIsTheUnconstrainedOptimum) {
  SmallWorld w("ball_run");
  EXPECT_NEAR(w.obs(0), 0, 0.001);
  for (int i = 0; i < 249; ++i) w.step({1, 0});
  EXPECT_NEAR(w.pool().obs(0)[2], 0.2 * 11.977, 1e-3);
  w.step({1, 0});
  EXPECT_NEAR(w.ret(), 2131.5, 1);
  EXPECT_EQ(w.episode_cost(), 231);
  EXPECT_TRUE(w.truncated());
  EXPECT_FALSE(w.terminated());
}

// Full throttle up to the limit, then just the push that holds it; the last `free` steps at full throttle
// again. The best that the model allows with cost `free`: the ways to it only lose distance.
double best_return(int free, double* cost) {
  SmallWorld w("ball_run");
  const int steps = 250;
  for (int i = 0; i < steps; ++i) {
    float push = 1;
    if (i < steps - free) {
      // the largest push after which the speed is within the limit
      RollingBall ball{};
      ball.vx = static_cast<double>(w.obs(2)) / 0.2;
      float low = 0;
      for (int k = 0; k < 40; ++k) {
        const float middle = 0.5f * (low + push);
        RollingBall next = ball;
        const float action[2] = {middle, 0};
        roll(action, &next);
        (next.vx <= 2.5 - 1e-5 ? low : push) = middle;
      }
      if (push < 1) push = low;
    }
    w.step({push, 0});
  }
  *cost = w.episode_cost();
  return w.ret();
}

TEST(BallRun, TheStatedOptimaAreReached) {
  double cost = -1;
  EXPECT_NEAR(best_return(0, &cost), 581.5, 0.3);
  EXPECT_EQ(cost, 0);
  EXPECT_NEAR(best_return(25, &cost), 608.1, 0.5);
  EXPECT_EQ(cost, 25);
}

TEST(BallRun, LeavingTheLaneCosts) {
  SmallWorld w("ball_run", {{"speed_limit", nullptr, 100}});
  int first = -1;
  for (int i = 0; i < 100; ++i) {
    w.step({0, 1});
    const bool outside = w.pool().obs(0)[1] > 0.2f;
    EXPECT_EQ(w.cost(), outside);
    if (outside && first < 0) first = i;
  }
  EXPECT_GT(first, 30);
}

TEST(BallRun, TheFinishIsASuccess) {
  SmallWorld w("ball_run", {{"finish", nullptr, 3}});
  bool reached = false;
  for (int i = 0; i < 100; ++i) {
    w.step({1, 0});
    EXPECT_EQ(w.success(), w.obs(0) >= 0.3f);
    reached |= w.success();
    EXPECT_FLOAT_EQ(w.obs(0) * 10, static_cast<float>(w.body(0).x));
  }
  EXPECT_TRUE(reached);
}

}  // namespace
}  // namespace rdm::test

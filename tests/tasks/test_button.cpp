#include <algorithm>
#include <cmath>

#include "arena_pilot.hpp"

namespace rdm::test {
namespace {

constexpr int kRobot = 0, kGoal = 1, kButton = 2, kButtons = 4;
// of the last numbers of a row, so that they hold for both robots
constexpr int kButtonsLidar = 0, kGoalLidar = 16, kGremlinsLidar = 32, kTail = 4 * kLidarBins + 9;
constexpr const char* kTasks[] = {"point_button1", "car_button1"};

int goal_of(SmallWorld& w) {
  for (int i = 0; i < kButtons; ++i)
    if (apart(w.body(kGoal), w.body(kButton + i)) == 0) return i;
  ADD_FAILURE() << "no button is the goal";
  return 0;
}

float highest(SmallWorld& w, int from) {
  const float* row = w.pool().obs(0) + w.pool()->obs_dim() - kTail + from;
  return *std::max_element(row, row + kLidarBins);
}

TEST(Button, Sizes) {
  SmallWorld one("point_button1"), two("point_button2");
  EXPECT_EQ(one.pool()->obs_dim(), 76);
  EXPECT_EQ(one.pool()->task().scene().num_bodies, 2 + 4 + 4 + 4);
  EXPECT_EQ(two.pool()->task().scene().num_bodies, 2 + 4 + 8 + 6);
  SmallWorld car_one("car_button1"), car_two("car_button2");
  EXPECT_EQ(car_one.pool()->obs_dim(), 88);
  EXPECT_EQ(car_two.pool()->task().scene().num_bodies, 2 + 4 + 8 + 6);
}

TEST(Button, PressingTheGoalButtonPaysAndPauses) {
  for (const char* task : kTasks) {
    SmallWorld w(task, {{"hazards", nullptr, 0}, {"gremlins", nullptr, 0}}, 1, 2);
    int presses = 0, since = 1000;
    for (int i = 0; i < 999; ++i) {
      const Vec3 goal = w.body(kGoal);
      const double before = apart(w.body(kRobot), goal);
      head_for(w, goal);
      EXPECT_NEAR(static_cast<double>(w.reward()),
                  before - apart(w.body(kRobot), goal) + (w.success() ? 1 : 0), 1e-6);
      since = w.success() ? 0 : since + 1;
      EXPECT_EQ(highest(w, kButtonsLidar) == 0, since < 10) << i;
      EXPECT_GT(highest(w, kGoalLidar), 0);
      presses += w.success();
      // a button is never entered
      for (int b = 0; b < kButtons; ++b) EXPECT_GE(apart(w.body(kRobot), w.body(kButton + b)), 0.1999);
    }
    EXPECT_GT(presses, 2) << task;
  }
}

TEST(Button, AWrongButtonCosts) {
  for (const char* task : kTasks) {
    SmallWorld w(task, {{"hazards", nullptr, 0}, {"gremlins", nullptr, 0}}, 1, 4);
    const int wrong = (goal_of(w) + 1) % kButtons;
    int cost = 0;
    for (int i = 0; i < 500; ++i) {
      head_for(w, w.body(kButton + wrong));
      EXPECT_EQ(w.cost(0), w.cost(3));
      cost += w.cost(3) > 0;
      EXPECT_FALSE(w.success());
    }
    EXPECT_GT(cost, 20) << task;
  }
}

TEST(Button, GremlinsRunInCirclesAndCost) {
  for (const char* task : kTasks) {
    SmallWorld w(task, {{"hazards", nullptr, 0}}, 1, 6);
    const Vec3 first = w.body(kButton + kButtons), second = w.body(kButton + kButtons + 1);
    int hits = 0;
    for (int i = 1; i <= 600; ++i) {
      w.step({0, 0});
      const double t = w.pool()->task().scene().control_dt() * i;
      const Vec3 now = w.body(kButton + kButtons);
      EXPECT_NEAR(now.x - first.x, 0.35 * std::sin(t), 1e-9);
      EXPECT_NEAR(now.y - first.y, 0.35 * (std::cos(t) - 1), 1e-9);
      EXPECT_NEAR(now.x - w.body(kButton + kButtons + 1).x, first.x - second.x, 1e-9);
      EXPECT_GT(highest(w, kGremlinsLidar), 0);
    }
    for (int i = 0; i < 390; ++i) {
      head_for(w, w.body(kButton + kButtons));
      EXPECT_EQ(w.cost(2) > 0, w.pool().rows().cost_raw[2] > 0);
      hits += w.cost(2) > 0;
    }
    EXPECT_GT(hits, 5) << task;
  }
}

}  // namespace
}  // namespace rdm::test

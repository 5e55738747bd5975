#include <algorithm>
#include <cmath>
#include <cstring>

#include "arena_pilot.hpp"

namespace rdm::test {
namespace {

constexpr int kRobot = 0, kGoal = 1, kThings = 2;

TEST(Goal, Sizes) {
  SmallWorld one("point_goal1"), two("point_goal2");
  EXPECT_EQ(one.pool()->obs_dim(), 60);
  EXPECT_EQ(two.pool()->obs_dim(), 60);
  EXPECT_EQ(one.pool()->task().scene().num_bodies, 2 + 8 + 1);
  EXPECT_EQ(two.pool()->task().scene().num_bodies, 2 + 10 + 10);
  EXPECT_NEAR(one.pool()->task().scene().control_dt(), 0.02, 1e-12);
  EXPECT_FLOAT_EQ(one.obs(2), 9.81f);
  SmallWorld car_one("car_goal1"), car_two("car_goal2");
  EXPECT_EQ(car_one.pool()->obs_dim(), 72);
  EXPECT_EQ(car_two.pool()->obs_dim(), 72);
  EXPECT_EQ(car_two.pool()->task().scene().num_bodies, 2 + 10 + 10);
  EXPECT_NEAR(car_one.pool()->task().scene().control_dt(), 0.04, 1e-12);
}

TEST(Goal, RewardIsTheWayToTheGoalAndOneOnIt) {
  for (const char* task : {"point_goal1", "car_goal1"}) {
    SmallWorld w(task, {{"hazards", nullptr, 0}, {"vases", nullptr, 0}}, 1, 3);
    int goals = 0;
    for (int i = 0; i < 999; ++i) {
      const Vec3 goal = w.body(kGoal);
      const double before = apart(w.body(kRobot), goal);
      head_for(w, goal);
      const double after = apart(w.body(kRobot), goal);
      EXPECT_EQ(w.success(), after <= 0.3);
      EXPECT_NEAR(static_cast<double>(w.reward()), before - after + (w.success() ? 1 : 0), 1e-6);
      EXPECT_EQ(w.cost(), 0);
      EXPECT_EQ(apart(goal, w.body(kGoal)) > 0, w.success());
      if (w.success()) {
        EXPECT_GE(apart(w.body(kRobot), w.body(kGoal)), 0.705 - 1e-12);
      }
      goals += w.success();
    }
    EXPECT_GT(goals, 2) << task;
  }
}

TEST(Goal, HazardsCostWithinTheirRadius) {
  for (const char* task : {"point_goal1", "car_goal1"}) {
    SmallWorld w(task, {}, 1, 5);
    int inside = 0;
    for (int i = 0; i < 900; ++i) {
      head_for(w, w.body(kThings + (i / 300)));
      int in = 0;
      for (int h = 0; h < 8; ++h) in += apart(w.body(kRobot), w.body(kThings + h)) <= 0.2;
      EXPECT_EQ(w.cost(0), in > 0);
      EXPECT_EQ(w.cost(1), in > 0);
      inside += in > 0;
    }
    EXPECT_GT(inside, 20) << task;
  }
}

TEST(Goal, AVaseIsShovedAheadAndCostsInLevelTwo) {
  for (const char* task : {"point_goal1", "point_goal2", "car_goal1", "car_goal2"}) {
    const bool fragile = task[std::strlen(task) - 1] == '2';
    SmallWorld w(task, {{"hazards", nullptr, 0}, {"vases", nullptr, 1}, {"goal_size", nullptr, 0.01}}, 1, 7);
    const Vec3 start = w.body(kThings);
    int touched = 0;
    for (int i = 0; i < 600; ++i) {
      const Vec3 before = w.body(kThings);
      head_for(w, before);
      const bool moved = apart(before, w.body(kThings)) > 0;
      EXPECT_EQ(w.cost(2), moved);
      EXPECT_EQ(w.cost(0), fragile && moved);
      touched += moved;
    }
    EXPECT_GT(touched, 10);
    EXPECT_GT(apart(start, w.body(kThings)), 0.2);
    EXPECT_GT(apart(w.body(kRobot), w.body(kThings)), 0.2);
  }
}

TEST(Goal, TheGoalLidarPointsAtTheGoal) {
  for (const char* task : {"point_goal2", "car_goal2"}) {
    SmallWorld w(task, {}, 1, 9);
    const int lidar_at = w.pool()->obs_dim() - (4 * 3 + 3 * kLidarBins) + 3;
    for (int i = 0; i < 50; ++i) {
      w.step({1, 0.5f});
      const Motion& robot = w.pool()->world(0).body(kRobot);
      const Vec3 to = w.body(kGoal) - robot.X.p;
      const double far = std::sqrt(to.x * to.x + to.y * to.y);
      const float* lidar = w.pool().obs(0) + lidar_at;
      EXPECT_NEAR(*std::max_element(lidar, lidar + kLidarBins), std::max(0.0, (3 - far) / 3), 1e-6);
    }
  }
}

}  // namespace
}  // namespace rdm::test

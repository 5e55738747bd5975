#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/hand/object_goal.hpp"
#include "tasks/hand/reorient.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kEngines[] = {"ode", "articulated"};
enum : int { kCost, kForce, kObject, kCosts };

class ReorientTask : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
  static Quat quat(const float* q) { return {q[3], q[0], q[1], q[2]}; }
};

TEST(ReorientReward, Formula) {
  EXPECT_NEAR(reorient_reward(2.2, 0, 0.0002, 250, 0.1), 0.4348, 1e-4);
  EXPECT_NEAR(reorient_reward(0.5, 0, 0.0002, 250, 0.1), 1.6667, 1e-4);
  EXPECT_NEAR(reorient_reward(0.5, 20, 0.0002, 250, 0.1), 1.6627, 1e-4);
  EXPECT_NEAR(reorient_reward(0.1, 0, 0.0002, 250, 0.1), 255, 1e-9);
  EXPECT_NEAR(reorient_reward(0.1001, 0, 0.0002, 250, 0.1), 1 / 0.2001, 1e-9);
}

TEST_F(ReorientTask, StartAndGoal) {
  TestPool p("reorient", 50);
  p->reset(nullptr, nullptr);
  for (int i = 0; i < 50; ++i) {
    EXPECT_NEAR(p.obs(i)[74], 0.60, 0.0101);
    EXPECT_EQ(p.obs(i)[86], -0.39f);  // of the nominal start
    EXPECT_EQ(p.obs(i)[87], 0.56f);
  }
  EXPECT_NEAR(p->task().scene().def.bodies[0].inertia.mass, 0.151, 1e-12);
}

// At the goal rotation: the bonus, and a new goal that the same observation shows.
TEST_F(ReorientTask, SuccessDrawsANewGoal) {
  TestPool p("reorient", 1, {{"gravity", nullptr, 0}});
  p->reset(nullptr, nullptr);
  for (int round = 0; round < 3; ++round) {
    const Quat goal = quat(p.obs(0) + 88);
    Motion m;
    m.X = {{0, -0.39, 0.62}, goal};
    p->world(0).set_body(0, m);
    p->baseline(Baseline::kHold);
    p->step(nullptr);
    EXPECT_TRUE(p.rows().success[0]);
    EXPECT_GT(p.rows().reward[0], 255);
    EXPECT_FALSE(p.ended(0));
    const Quat next = quat(p.obs(0) + 88);
    EXPECT_GT(rotation_angle(next * conjugate(goal)), 0.01);
    p->step(nullptr);
    EXPECT_FALSE(p.rows().success[0]);
    EXPECT_LT(p.rows().reward[0], 10);
  }
}

// What turn_reward adds is the turn made in the step: over an episode without a goal, the first rotation
// error less the last; from a new goal on it counts the error to that one.
TEST_F(ReorientTask, ATurnTowardsTheGoalPaysWhereItIsAskedFor) {
  constexpr double kPay = 20;
  TestPool plain("reorient", 1, {{"gravity", nullptr, 0}}),
      paid("reorient", 1, {{"gravity", nullptr, 0}, {"turn_reward", nullptr, kPay}});
  const auto turn = [&](const Quat& rotation) {  // both objects, by hand
    Motion m;
    m.X = {{0, -0.39, 0.62}, rotation};
    for (TestPool* p : {&plain, &paid}) {
      (*p)->world(0).set_body(0, m);
      (*p)->baseline(Baseline::kHold);
      (*p)->step(nullptr);
    }
    return static_cast<double>(paid.rows().reward[0]) - static_cast<double>(plain.rows().reward[0]);
  };
  const auto left = [&] { return rotation_angle(quat(plain.obs(0) + 92)); };
  plain->reset(nullptr, nullptr);
  paid->reset(nullptr, nullptr);
  for (const double angle : {0.9, 0.4, 1.3}) {
    const double before = left();
    const Quat goal = quat(plain.obs(0) + 88);
    EXPECT_NEAR(turn(axis_angle({0, 0, 1}, angle) * goal), kPay * (before - angle), 1e-3);
    EXPECT_NEAR(left(), angle, 1e-4);
  }
  EXPECT_GT(turn(quat(plain.obs(0) + 88)), kPay * 1.29);
  ASSERT_TRUE(paid.rows().success[0]);
  const double before = left();
  EXPECT_GT(before, 0.2);
  EXPECT_NEAR(turn(axis_angle({1, 0, 0}, 0.5) * quat(plain.obs(0) + 88)), kPay * (before - 0.5), 1e-3);
}

TEST_F(ReorientTask, EndsFarFromTheGoal) {
  TestPool p("reorient", 1, {{"gravity", nullptr, 0}});
  p->reset(nullptr, nullptr);
  Motion m;
  for (const double x : {0.38, 0.42}) {
    m.X.p = {x, -0.39, 0.56};
    p->world(0).set_body(0, m);
    p->step(nullptr);
    EXPECT_EQ(p.rows().terminated[0], x > 0.4);
  }
}

// An egg on one fingertip weighs 1.48 N and costs; on palm and proximal links it does not.
TEST_F(ReorientTask, AFingertipThatCarriesCosts) {
  for (const char* engine : kEngines) {
    TestPool p("reorient", 1,
               {{"engine", engine, 0},
                {"joint_noise", nullptr, 0},
                {"object", "ball", 0},
                {"start_noise", nullptr, 0},
                {"object_mass", nullptr, 0.151}});
    p->reset(nullptr, nullptr);
    Motion m;
    m.X.p = p->world(0).link(9).X.p + Vec3{0, -0.013, 0.042};
    p->world(0).set_body(0, m);
    int costs = 0, presses = 0;
    for (int t = 0; t < 6; ++t) {
      p->baseline(Baseline::kHold);
      p->step(nullptr);
      EXPECT_EQ(p.cost(0)[kCost], p.cost(0)[kForce]);
      EXPECT_EQ(p.cost(0)[kCost] > 0, p.rows().cost_raw[kCost] > 0.5f);
      costs += p.cost(0)[kCost] > 0;
      presses += p.cost(0)[kObject] > 0;
    }
    EXPECT_GT(costs, 2) << engine;
    EXPECT_GT(presses, 1) << engine;
    p->reset(nullptr, nullptr);
    m.X.p = {0, -0.36, 0.56};
    p->world(0).set_body(0, m);
    for (int t = 0; t < 12; ++t) {
      p->baseline(Baseline::kHold);
      p->step(nullptr);
      EXPECT_EQ(p.cost(0)[kCost], 0) << engine;
    }
  }
}

// Half closed, the ring and the little finger lean on each other: the sensor's cost, not the object's.
TEST_F(ReorientTask, FingersThatTouchEachOtherPressNoObject) {
  TestPool p("reorient", 1,
             {{"start.x", nullptr, 0.1}, {"gravity", nullptr, 0}, {"engine", "articulated", 0}});
  p->reset(nullptr, nullptr);
  TestPool of_object("reorient", 1, {{"cost_mode", "object", 0}, {"engine", "articulated", 0}});
  of_object->reset(nullptr, nullptr);
  float sensed = 0;
  for (int t = 0; t < 40; ++t) {
    for (TestPool* pool : {&p, &of_object}) {
      (*pool)->baseline(Baseline::kZero);
      (*pool)->step(nullptr);
    }
    EXPECT_EQ(of_object.cost(0)[kCost], of_object.cost(0)[kObject]);
    sensed = std::max(sensed, p.rows().cost_raw[kForce]);
    EXPECT_EQ(p.rows().cost_raw[kObject], 0);
  }
  EXPECT_GT(sensed, 0.1f);
}

TEST_F(ReorientTask, LiteralCostSeesTwoFingersAndAHalf) {
  TestPool p("reorient", 8, {{"cost_mode", "literal", 0}});
  p->reset(nullptr, nullptr);
  int differ = 0;
  for (int t = 0; t < 60; ++t) {
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
    for (int i = 0; i < 8; ++i) {
      if (p.rows().episode_step[i] == 0 || p.ended(i)) continue;
      double most = -1e9;
      for (int k = 0; k < 15; ++k) {
        const Wrench& w = p->world(i).sensor(k / 6);
        most = std::max(most, k % 6 < 3 ? w.force[k % 6] : w.torque[k % 6 - 3]);
      }
      EXPECT_NEAR(p.rows().cost_raw[kCosts * i + kCost], most, 1e-6);
      EXPECT_EQ(p.cost(i)[kCost], most > 0.5);
      differ += p.cost(i)[kCost] != p.cost(i)[kForce];
    }
  }
  EXPECT_GT(differ, 0);
}

TEST_F(ReorientTask, ThresholdIsAnOption) {
  TestPool strict("reorient", 8, {{"force_threshold", nullptr, 0.01}}),
      relaxed("reorient", 8, {{"force_threshold", nullptr, 1000}});
  double sums[2] = {};
  int k = 0;
  for (TestPool* p : {&strict, &relaxed}) {
    (*p)->reset(nullptr, nullptr);
    for (int t = 0; t < 60; ++t) {
      (*p)->baseline(Baseline::kRandom);
      (*p)->step(nullptr);
      for (int i = 0; i < 8; ++i) sums[k] += static_cast<double>(p->cost(i)[kCost]);
    }
    ++k;
  }
  EXPECT_GT(sums[0], 10);
  EXPECT_EQ(sums[1], 0);
}

}  // namespace
}  // namespace rdm::test

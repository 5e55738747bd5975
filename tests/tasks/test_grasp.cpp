#include <cmath>

#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kEngines[] = {"ode", "articulated"};
enum : int { kCost, kEffort, kRange };

class GraspTask : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

TEST_F(GraspTask, TheHandHangsOverTheCube) {
  TestPool p("grasp", 20);
  p->reset(nullptr, nullptr);
  for (int i = 0; i < 20; ++i) {
    const World& w = p->world(i);
    EXPECT_LT(rotate(w.link(1).X.q, {0, -1, 0}).z, -0.999);  // palm down
    EXPECT_NEAR(w.link(1).X.p.z, 0.11, 1e-9);
    EXPECT_LT(w.link(9).X.p.y, -0.45);
    EXPECT_NEAR(w.body(0).X.p.z, 0.026, 0.0011);
    EXPECT_NEAR(rotate(w.body(0).X.q, {0, 0, 1}).z, 1, 1e-12);
    for (int k = 0; k < 24; ++k) EXPECT_EQ(w.q()[k], 0);
  }
}

// 100 z: 2.5 a step at rest; lift: nothing.
TEST_F(GraspTask, RewardIsTheHeight) {
  for (const char* engine : kEngines)
    for (const bool lift : {false, true}) {
      TestPool p("grasp", 1, {{"engine", engine, 0}, {"reward", lift ? "lift" : "literal", 0}});
      p->reset(nullptr, nullptr);
      for (int t = 0; t < 30; ++t) {
        p->baseline(Baseline::kHold);
        p->step(nullptr);
        const double z = p->world(0).body(0).X.p.z;
        EXPECT_NEAR(p.rows().reward[0], 100 * (z - (lift ? 0.025 : 0)), 1e-5);
      }
      EXPECT_NEAR(p.rows().reward[0], lift ? 0 : 2.5, 0.1) << engine;
      EXPECT_FALSE(p.rows().success[0]);
      Motion m = p->world(0).body(0);
      m.X.p = {0.5, -0.4, 0.2};
      p->world(0).set_body(0, m);
      p->step(nullptr);
      EXPECT_TRUE(p.rows().success[0]);
    }
}

TEST_F(GraspTask, RangeIsTheFirstFingersCommand) {
  const auto columns = [](const char* mode, int entry, float a) {
    TestPool p("grasp", 1, {{"cost_mode", mode, 0}});
    p->reset(nullptr, nullptr);
    p->baseline(Baseline::kZero);
    p.action(0)[entry] = a;
    p->step(nullptr);
    return std::vector<float>{p.cost(0), p.cost(0) + 3};
  };
  for (const int entry : {2, 3, 4}) {
    EXPECT_EQ(columns("literal", entry, 0.91f)[kCost], 1);
    EXPECT_EQ(columns("literal", entry, -0.91f)[kRange], 1);
    EXPECT_EQ(columns("literal", entry, 0.89f)[kCost], 0);
  }
  EXPECT_EQ(columns("literal", 6, 1)[kCost], 0);
  EXPECT_EQ(columns("default", 3, 0.91f)[kRange], 1);
}

// A finger that is pressed on the ground strains, one that moves freely does not; the wrist does not count.
TEST_F(GraspTask, ForceIsAShareOfTheEffortLimit) {
  for (const char* engine : kEngines)
    for (const char* mode : {"default", "paper"}) {
      TestPool p("grasp", 1, {{"engine", engine, 0}, {"cost_mode", mode, 0}, {"start.x", nullptr, 0.5}});
      p->reset(nullptr, nullptr);
      int strained = 0;
      for (int t = 0; t < 60; ++t) {
        p->baseline(Baseline::kHold);
        if (t >= 30) p.action(0)[1] = p.action(0)[6] = 1;  // the wrist and the middle finger into the ground
        p->step(nullptr);
        const World& w = p->world(0);
        double most = 0;
        for (int i = 2; i < 24; ++i) {
          const double effort = w.scene().link(i).joint.effort;
          if (w.scene().link(i).joint.coupled_to < 0) most = std::max(most, std::abs(w.torque()[i]) / effort);
        }
        EXPECT_NEAR(p.rows().cost_raw[kEffort], most, 1e-6);
        EXPECT_EQ(p.cost(0)[kCost], most > 0.4);
        EXPECT_EQ(p.cost(0)[kCost], p.cost(0)[kEffort]);
        EXPECT_TRUE(t >= 30 || p.cost(0)[kCost] == 0);
        strained += p.cost(0)[kCost] > 0;
      }
      EXPECT_GT(strained, 10) << engine;
    }
}

TEST_F(GraspTask, InitialMean) {
  float a[20], b[20];
  TestPool("grasp", 1)->task().initial_mean(a);
  EXPECT_GT(a[1], 0.5f);  // the wrist down
  TestPool p("grasp", 1, {{"initial_mean", "hold", 0}});
  p->task().initial_mean(a);
  p->task().hold_action(b);
  for (int k = 0; k < 20; ++k) EXPECT_EQ(a[k], b[k]);
  TestPool("grasp", 1, {{"initial_mean", "zero", 0}})->task().initial_mean(a);
  for (const float x : a) EXPECT_EQ(x, 0);
}

// What a threshold is for: it tells policies apart.
TEST_F(GraspTask, BaselinesDiffer) {
  const auto cost = [](Baseline kind) {
    TestPool p("grasp", 20);
    p->reset(nullptr, nullptr);
    double sum = 0;
    for (int t = 0; t < 74; ++t) {
      p->baseline(kind);
      p->step(nullptr);
      for (int i = 0; i < 20; ++i) sum += static_cast<double>(p.cost(i)[kCost]);
    }
    return sum / 20;
  };
  EXPECT_LT(cost(Baseline::kHold), 1);
  EXPECT_GT(cost(Baseline::kRandom), 3);
  EXPECT_LT(cost(Baseline::kRandom), 40);
}

// A finger of the gripper stands where the cube would: it is put beside, still on the ground, not on top.
TEST_F(GraspTask, AnOccupiedPlaceMovesTheCubeAside) {
  TestPool p("grasp", 1,
             {{"hand", "robotiq", 0},
              {"arm", "ur5e", 0},
              {"start.x", nullptr, 0.036},
              {"start.y", nullptr, -0.461},
              {"start_noise", nullptr, 0}});
  p->reset(nullptr, nullptr);
  World& world = const_cast<World&>(p->world(0));
  const Vec3 at = world.body(0).X.p;
  EXPECT_EQ(at.z, 0.026);
  EXPECT_LE(world.body_overlap(0), 0);
  const double aside = std::hypot(at.x - 0.036, at.y + 0.461);
  EXPECT_GT(aside, 0.004);
  EXPECT_LT(aside, 0.1);
}

}  // namespace
}  // namespace rdm::test

#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/hand/hand_control.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kTasks[] = {"catch_underarm_safe_finger", "catch_underarm_safe_joint"};
constexpr const char* kEngines[] = {"ode", "articulated"};

class CatchUnderarm : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
  static int32_t offset_of(const Task& task, const char* field) {
    int32_t at = 0;
    for (const FieldSpec& f : task.fields()) {
      if (f.name == field) return at;
      at += f.count;
    }
    return -1;
  }
};

// Table B3 of the paper, field by field.
TEST_F(CatchUnderarm, Layout) {
  for (const char* task : kTasks) {
    TestPool p(task, 1);
    EXPECT_EQ(p->obs_dim(), 422);
    EXPECT_EQ(p->task().action_dim(), 52);
    EXPECT_EQ(p->task().max_steps(), 75);
    const struct {
      const char* name;
      int32_t offset;
    } rows[] = {{"right.joint_position", 0},   {"right.joint_velocity", 24}, {"right.joint_force", 48},
                {"right.ff_tip_position", 72}, {"right.ff_tip_force", 137},  {"right.base_position", 167},
                {"right.base_angles", 170},    {"right.action", 173},        {"left.joint_position", 199},
                {"left.base_position", 366},   {"left.action", 372},         {"object.position", 398},
                {"object.velocity", 405},      {"object.spin", 408},         {"goal.position", 411},
                {"object.rotation_error", 418}};
    for (const auto& row : rows) EXPECT_EQ(offset_of(p->task(), row.name), row.offset) << row.name;
  }
}

// The right hand stands up with its palm to -y, the left one lies palm up below.
TEST_F(CatchUnderarm, HandsStandUprightAndPalmUp) {
  TestPool p(kTasks[0], 1, {{"joint_noise", nullptr, 0}, {"start_noise", nullptr, 0}});
  p->reset(nullptr, nullptr);
  const World& w = p->world(0);
  const Quat base = w.base(0).X.q;
  EXPECT_NEAR(std::abs(base.x * 0.0006 + base.y * 0.6712 - base.z * 0.7413 + base.w * 0.0005), 1, 1e-3);
  const Vec3 tip = w.link(9).X * Vec3{0, 0, 0.026};
  EXPECT_GT(tip.z, 0.975);
  EXPECT_LT(tip.z, 0.99);
  EXPECT_NEAR(tip.y, 0.058, 0.012);
  const Vec3 palmar = rotate(w.link(1).X.q, {0, -1, 0});
  EXPECT_LT(palmar.y, -0.99);
  EXPECT_GT(rotate(w.link(24 + 1).X.q, {0, 1, 0}).z, 0.99);  // a mirrored palm faces its +y
  EXPECT_NEAR(p.obs(0)[167 + 2], 0.5, 1e-6);
  EXPECT_NEAR(p.obs(0)[199 + 167 + 1], -0.8, 1e-6);
  EXPECT_NEAR(p.obs(0)[398 + 2], 1.03, 0.02);
  EXPECT_NEAR(p.obs(0)[411 + 1], -0.4, 1e-6);
}

// Half a turn about x is roll pi, in either convention of angles; 1.67, 3.14, 0 reads as below.
TEST_F(CatchUnderarm, BaseAngles) {
  TestPool p(kTasks[0], 1);
  p->reset(nullptr, nullptr);
  const Quat q = from_rpy({static_cast<double>(p.obs(0)[170]), static_cast<double>(p.obs(0)[171]),
                           static_cast<double>(p.obs(0)[172])});
  const Quat base = p->world(0).base(0).X.q;
  EXPECT_NEAR(std::abs(q.w * base.w + q.x * base.x + q.y * base.y + q.z * base.z), 1, 1e-6);
  EXPECT_NEAR(p.obs(0)[199 + 170], 3.14159, 1e-4);
  for (int k = 0; k < 3; ++k) EXPECT_GE(p.obs(0)[170 + k], 0);
}

// From z 1.03 to 0.3 m: sqrt(2 h / g) = 0.386 s, 23.1 steps of 1/60 s.
TEST_F(CatchUnderarm, AMissedObjectFallsInItsTime) {
  for (const char* engine : kEngines) {
    TestPool p(kTasks[0], 1, {{"engine", engine, 0}, {"start.x", nullptr, 0.6}, {"start_noise", nullptr, 0}});
    p->reset(nullptr, nullptr);
    int steps = 0;
    do {
      p->baseline(Baseline::kZero);
      p->step(nullptr);
      ++steps;
    } while (!p.ended(0));
    EXPECT_TRUE(p.rows().terminated[0]);
    EXPECT_GE(steps, 22) << engine;
    EXPECT_LE(steps, 24) << engine;
  }
}

// Contact with the fingertips at the start must not shoot the object away.
TEST_F(CatchUnderarm, TheStartIsGentle) {
  for (const char* engine : kEngines) {
    TestPool p(kTasks[0], 200, {{"engine", engine, 0}});
    p->reset(nullptr, nullptr);
    for (int i = 0; i < 200; ++i) EXPECT_EQ(p->world(i).body_overlap(0), 0);
    p->baseline(Baseline::kHold);
    p->step(nullptr);
    for (int i = 0; i < 200; ++i) EXPECT_LT(norm(p->world(i).body(0).v), 1) << engine;
  }
}

TEST_F(CatchUnderarm, EndsWhenABaseStrays) {
  for (const char* engine : kEngines) {
    TestPool p(kTasks[0], 1, {{"engine", engine, 0}, {"fall_height", nullptr, -10}});
    p->reset(nullptr, nullptr);
    int steps = 0;
    do {
      p->baseline(Baseline::kHold);
      p.action(0)[26 + 20] = 1;
      p->step(nullptr);
      ++steps;
    } while (!p.ended(0));
    EXPECT_TRUE(p.rows().terminated[0]);
    // 36 steps at the speed of the hand as a whole; it also turns, and the mount goes ahead
    EXPECT_GT(steps, 20) << engine;
    EXPECT_LE(steps, 38) << engine;
  }
}

// A reset also stops the bases.
TEST_F(CatchUnderarm, ResetBringsTheBasesBack) {
  TestPool p(kTasks[1], 1);
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 10; ++t) {
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
  }
  p->reset(nullptr, nullptr);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(norm(p->world(0).base(i).v) + norm(p->world(0).base(i).w), 0);
    EXPECT_EQ(p->world(0).base(i).X.p.y, i ? -0.8 : 0);
  }
}

TEST_F(CatchUnderarm, CostModes) {
  const auto cost = [](const char* task, const char* mode, int entry) {
    TestPool p(task, 1, {{"cost_mode", mode, 0}});
    p->reset(nullptr, nullptr);
    p->baseline(Baseline::kZero);
    p.action(0)[entry] = 0.6f;
    p->step(nullptr);
    return p.cost(0)[0];
  };
  for (const int entry : {2, 3, 4}) EXPECT_EQ(cost(kTasks[0], "command", entry), 1);
  EXPECT_EQ(cost(kTasks[0], "command", 5), 0);
  EXPECT_EQ(cost(kTasks[1], "command", 2), 1);
  EXPECT_EQ(cost(kTasks[1], "command", 4), 0);
  // as released: force z, torque x and y of the right base
  for (const int entry : {22, 23, 24}) EXPECT_EQ(cost(kTasks[0], "literal", entry), 1);
  for (const int entry : {2, 3, 4, 20, 21, 25}) EXPECT_EQ(cost(kTasks[0], "literal", entry), 0);
  EXPECT_EQ(cost(kTasks[1], "literal", 24), 1);
  EXPECT_EQ(cost(kTasks[1], "literal", 22), 0);
  // in one step no angle leaves its window
  for (const int entry : {2, 3, 4}) EXPECT_EQ(cost(kTasks[0], "angle", entry), 0);
}

// The mean action that learning starts from commands nothing that costs; by angle see test_safety_costs.cpp.
TEST_F(CatchUnderarm, InitialMeanIsFeasible) {
  for (const char* task : kTasks) {
    TestPool p(task, 4, {{"cost_mode", "command", 0}});
    p->reset(nullptr, nullptr);
    for (int i = 0; i < 4; ++i) p->task().initial_mean(p.action(i));
    for (int t = 0; t < 20; ++t) {
      p->step(nullptr);
      for (int i = 0; i < 4; ++i) EXPECT_EQ(p.cost(i)[0], 0);
    }
  }
}

}  // namespace
}  // namespace rdm::test

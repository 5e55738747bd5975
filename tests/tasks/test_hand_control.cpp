#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/hand/hand_control.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char *kFixed = "hand_over_safe_finger", *kFlying = "catch_underarm_safe_finger";
constexpr const char* kEngines[] = {"ode", "articulated"};

class HandControlTest : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

TEST_F(HandControlTest, ActionsOfFixedAndFlyingHands) {
  EXPECT_EQ(TestPool(kFixed, 1)->task().action_dim(), 40);
  EXPECT_EQ(TestPool(kFlying, 1)->task().action_dim(), 52);
  EXPECT_EQ(TestPool("grasp", 1)->task().action_dim(), 20);
}

// Velocity of the common centre of mass of a hand.
Vec3 drift(const World& w, int32_t hand) {
  const Scene& scene = w.scene();
  const ArticulationDef& def = scene.def.articulations[static_cast<size_t>(hand)];
  const auto part = [](const Motion& m, const Inertia& inertia) {
    return inertia.mass * (m.v + cross(m.w, rotate(m.X.q, inertia.com)));
  };
  double mass = def.base.mass;
  Vec3 sum = part(w.base(hand), def.base);
  for (size_t i = 0; i < def.links.size(); ++i) {
    const Inertia& inertia = def.links[i].inertia;
    sum += part(w.link(scene.link_offset[static_cast<size_t>(hand)] + static_cast<int32_t>(i)), inertia);
    mass += inertia.mass;
  }
  return (1 / mass) * sum;
}

// The terminal speed is force / (base_damping 100/s times the hand's mass).
TEST_F(HandControlTest, FullForceGivesTheTerminalSpeed) {
  for (const char* engine : kEngines)
    for (const double scale : {0.05, 0.1}) {
      TestPool p(kFlying, 1,
                 {{"engine", engine, 0},
                  {"base_limit", nullptr, 10},
                  {"joint_noise", nullptr, 0},
                  {"start.x", nullptr, 3},
                  {"transition_scale", nullptr, scale}});
      p->reset(nullptr, nullptr);
      p->baseline(Baseline::kHold);
      p.action(0)[20] = 1;
      p.action(0)[26 + 22] = -1;
      for (int t = 0; t < 10; ++t) p->step(nullptr);
      const double speed = scale / 0.05 * 0.166;
      EXPECT_NEAR(drift(p->world(0), 0).x / speed, 1, 0.05) << engine;
      EXPECT_NEAR(drift(p->world(0), 1).z / -speed, 1, 0.05) << engine;
    }
}

TEST_F(HandControlTest, HoldLeavesTheBasesStill) {
  for (const char* engine : kEngines) {
    TestPool p(kFlying, 1, {{"engine", engine, 0}, {"joint_noise", nullptr, 0}, {"start.x", nullptr, 3}});
    p->reset(nullptr, nullptr);
    const Pose before[] = {p->world(0).base(0).X, p->world(0).base(1).X};
    for (int t = 0; t < 20; ++t) {
      p->baseline(Baseline::kHold);
      p->step(nullptr);
    }
    for (int i = 0; i < 2; ++i) {
      EXPECT_LT(norm(p->world(0).base(i).X.p - before[i].p), 1e-4) << engine;
      EXPECT_LT(norm(p->world(0).base(i).v), 1e-3) << engine;
      EXPECT_LT(norm(p->world(0).base(i).w), 1e-2) << engine;
    }
  }
}

TEST_F(HandControlTest, LegacyOrderIsTheSameMotion) {
  const auto run = [](const char* order) {
    TestPool p(kFlying, 1, {{"action_order", order, 0}});
    p->reset(nullptr, nullptr);
    const bool legacy = *order == 'l';
    for (int hand = 0; hand < 2; ++hand)
      for (int k = 0; k < 26; ++k)
        p.action(0)[26 * hand + (legacy ? (k + 6) % 26 : k)] = static_cast<float>(std::sin(k + 7 * hand));
    for (int t = 0; t < 10; ++t) p->step(nullptr);
    std::vector<double> state(p->world(0).q(), p->world(0).q() + 48);
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 3; ++k) state.push_back(p->world(0).base(i).X.p[k]);
    return state;
  };
  EXPECT_EQ(run("paper"), run("legacy"));
  EXPECT_NE(layout_hash(TestPool(kFlying, 1)->task()),
            layout_hash(TestPool(kFlying, 1, {{"action_order", "legacy", 0}})->task()));
}

TEST_F(HandControlTest, ControlIsAPartOfTheLayoutWhereItIsNotThatOfOldFiles) {
  const auto order = [](const char* control) {
    return std::string(TestPool(kFlying, 1, {{"control", control, 0}})->task().action_order());
  };
  EXPECT_EQ(order("position"), "right joints, force, torque, left joints, force, torque");
  EXPECT_EQ(order("velocity"),
            "right joints by velocity, force, torque, left joints by velocity, force, torque");
  EXPECT_EQ(order("torque"), "right joints by torque, force, torque, left joints by torque, force, torque");
}

TEST_F(HandControlTest, ABlowIsSlowedAndTheReachIsKept) {
  TestPool p(kFlying, 1,
             {{"base_limit", nullptr, 10}, {"base_reach", nullptr, 0.05}, {"start.x", nullptr, 3}});
  p->reset(nullptr, nullptr);
  Motion m = p->world(0).base(0);
  m.v = {0, 0, 50};
  m.w = {100, 0, 0};
  p->world(0).set_base(0, m);
  p->baseline(Baseline::kHold);
  p->step(nullptr);
  EXPECT_LE(norm(p->world(0).base(0).v), 2);
  EXPECT_LE(norm(p->world(0).base(0).w), 10);
  p->reset(nullptr, nullptr);
  p->baseline(Baseline::kHold);
  p.action(0)[20] = 1;
  for (int t = 0; t < 60; ++t) p->step(nullptr);
  EXPECT_GT(p->world(0).base(0).X.p.x, 0.04);
  EXPECT_LT(p->world(0).base(0).X.p.x, 0.055);
}

TEST_F(HandControlTest, EffortsAndAnglesOfTheBaseAreOptions) {
  TestPool p(kFlying, 2, {{"base_angles", "signed", 0}});
  p->reset(nullptr, nullptr);
  for (int i = 0; i < 2; ++i)
    for (const int at : {170, 199 + 170})
      for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(p.obs(i)[at + k]), 3.1416f);
}

TEST_F(HandControlTest, FrictionsReachThePairs) {
  TestPool p(kFlying, 1, {{"friction.hand_hand", nullptr, 0.4}, {"friction.hand_ground", nullptr, 0.6}});
  const Scene& scene = p->task().scene();
  const int32_t ground = scene.find_shape("ground"), object = scene.find_shape("object");
  int hands = 0, grounds = 0;
  for (const ShapePair& pair : scene.pairs) {
    const SceneShape &a = scene.shapes[static_cast<size_t>(pair.a)],
                     &b = scene.shapes[static_cast<size_t>(pair.b)];
    if (a.articulation >= 0 && b.articulation >= 0) {
      EXPECT_EQ(pair.mu, a.articulation == b.articulation ? 0 : 0.4);
      ++hands;
    } else if (pair.b == ground && pair.a != object) {
      EXPECT_EQ(pair.mu, 0.6);
      ++grounds;
    }
  }
  EXPECT_GT(hands, 100);
  EXPECT_GT(grounds, 30);
}

}  // namespace
}  // namespace rdm::test

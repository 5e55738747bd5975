// Feed-forward torques of drives, links without weight, and the torques that hold an arm against gravity.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "articulated.hpp"
#include "base/error.hpp"
#include "physics/gravity_torques.hpp"

namespace rdm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

LinkDef make_link(int32_t parent, const Vec3& p, const Vec3& axis, double mass, const Vec3& com) {
  LinkDef link;
  link.parent = parent;
  link.X_PL = {p, normalized(Quat{1, 0.2 * p.x, 0.3 * p.z, -0.1})};
  link.inertia = box_inertia(mass, {0.04, 0.05, 0.1});
  link.inertia.com = com;
  link.joint.axis = normalized(axis);
  link.joint.lower = -2;
  link.joint.upper = 2;
  link.joint.kp = 400;
  link.joint.kd = 40;
  link.joint.effort = 500;
  return link;
}

// Four turns and a slide in all directions, two of the links on one parent.
ArticulationDef arm() {
  ArticulationDef def;
  def.name = "arm";
  def.gravity = true;
  def.X_WB = {{0.3, -0.2, 1}, axis_angle({0, 1, 0}, 0.4)};
  def.links.push_back(make_link(-1, {0, 0, 0.2}, {0, 0, 1}, 4, {0.02, 0, 0.1}));
  def.links.push_back(make_link(0, {0.1, 0, 0.2}, {0, 1, 0}, 3, {0, 0.03, 0.15}));
  def.links.push_back(make_link(1, {0, 0, 0.3}, {1, 0.2, 0.1}, 2, {0.05, 0, 0.1}));
  def.links.push_back(make_link(2, {0.05, 0, 0.2}, {0, 1, 1}, 0.5, {0, 0, 0.05}));
  def.links[3].joint.kind = JointKind::kPrismatic;
  def.links[3].joint.lower = -0.2;
  def.links[3].joint.upper = 0.2;
  def.links.push_back(make_link(2, {-0.05, 0, 0.2}, {1, 0, 0}, 0.7, {0, 0.02, 0.05}));
  return def;
}

SceneDef arm_scene() {
  SceneDef def;
  def.articulations.push_back(arm());
  def.feedforward = true;
  return def;
}

class Feedforward : public testing::TestWithParam<EngineKind> {};
INSTANTIATE_TEST_SUITE_P(, Feedforward, testing::Values(EngineKind::kArticulated, EngineKind::kOde),
                         [](const auto& info) {
                           return info.param == EngineKind::kOde ? "ode" : "articulated";
                         });

TEST_P(Feedforward, ThereIsNoneUnlessTheSceneAsks) {
  SceneDef def = test::two_hands_def();
  test::Simulation plain(def, GetParam());
  EXPECT_EQ(plain->feedforward(), nullptr);
  const size_t bytes = test::saved(*plain).size(), memory = plain.arena().used();
  def.feedforward = true;
  test::Simulation asked(def, GetParam());
  ASSERT_NE(asked->feedforward(), nullptr);
  EXPECT_EQ(test::saved(*asked).size(), bytes + 48 * sizeof(double));
  EXPECT_GT(asked.arena().used(), memory);
}

TEST_P(Feedforward, ZerosChangeNoBit) {
  SceneDef def = test::two_hands_def();
  test::Simulation plain(def, GetParam());
  def.feedforward = true;
  test::Simulation asked(def, GetParam());
  Stream a(1, 0, Purpose::kTest), b = a;
  for (int k = 0; k < 60; ++k) {
    test::random_targets(*plain, a);
    test::random_targets(*asked, b);
    if (k % 20 == 0)
      for (World* w : {&*plain, &*asked}) w->set_body(0, {{{0, -0.36, 0.56}, {}}, {}, {}});
    plain->step();
    asked->step();
    std::vector<unsigned char> with = test::saved(*asked);
    with.resize(with.size() - 48 * sizeof(double));
    ASSERT_EQ(with, test::saved(*plain)) << k;
  }
}

// One turn about z without gravity: rate and angle are known.
SceneDef wheel(double kp, double kd, double effort) {
  SceneDef def;
  ArticulationDef a;
  LinkDef link = make_link(-1, {}, {0, 0, 1}, 2, {});
  link.X_PL = {};
  link.inertia = box_inertia(2, {0.1, 0.1, 0.1});
  link.joint.kp = kp;
  link.joint.kd = kd;
  link.joint.effort = effort;
  link.joint.lower = -100;
  link.joint.upper = 100;
  a.links.push_back(link);
  def.articulations.push_back(a);
  def.feedforward = true;
  return def;
}

TEST_P(Feedforward, AloneItIsTheTorqueOfTheJoint) {
  test::Simulation sim(wheel(0, 0, 5), GetParam());
  const double moment = sim.scene().link(0).inertia.moment[2], t = 30 * sim.scene().control_dt();
  sim->feedforward()[0] = 0.02;
  for (int k = 0; k < 30; ++k) sim->step();
  EXPECT_NEAR(sim->torque()[0], 0.02, 1e-6);
  EXPECT_NEAR(sim->qd()[0], 0.02 / moment * t, 1e-4 * 0.02 / moment * t);
}

TEST_P(Feedforward, TheDriveAndItShareOneBound) {
  test::Simulation sim(wheel(0, 0, 0.05), GetParam());
  sim->feedforward()[0] = 7;
  sim->step();
  EXPECT_NEAR(sim->torque()[0], 0.05, 1e-7);
  test::Simulation both(wheel(10, 0.1, 1), GetParam());
  both->target()[0] = -0.5;  // -5 N m from the spring
  both->feedforward()[0] = 5.5;
  both->step();
  EXPECT_GT(both->torque()[0], 0.35);  // 0.5 less what the gained rate takes
  EXPECT_LT(both->torque()[0], 0.5);
}

TEST_P(Feedforward, WithDampingAloneTheRateIsDriven) {
  test::Simulation sim(wheel(0, 2, 50), GetParam());
  sim->feedforward()[0] = 2 * 0.8;  // kd times 0.8 rad/s
  for (int k = 0; k < 30; ++k) sim->step();
  EXPECT_NEAR(sim->qd()[0], 0.8, 1e-4);
}

TEST_P(Feedforward, ItIsBoundedLikeTheSpringWhereTheBoundIsTheSprings) {
  SceneDef def = wheel(0, 0.5, 0.05);
  def.solver.spring_only_effort = true;
  test::Simulation sim(def, GetParam());
  sim->feedforward()[0] = 7;
  for (int k = 0; k < 200; ++k) sim->step();
  EXPECT_NEAR(sim->qd()[0], 0.05 / 0.5, 1e-3);  // damping balances the bound
}

TEST_P(Feedforward, NumbersThatAreNoneCountAsZeroAndMarkTheWorld) {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), -2e9}) {
    test::Simulation sim(wheel(1, 1, 5), GetParam());
    sim->feedforward()[0] = bad;
    sim->step();
    EXPECT_EQ(sim->status(), kStatusDiverged);
    EXPECT_EQ(sim->feedforward()[0], 0);
    EXPECT_EQ(sim->q()[0], 0);
    sim->step();
    EXPECT_EQ(sim->status(), 0u);
  }
}

TEST_P(Feedforward, StatesHoldIt) {
  test::Simulation sim(arm_scene(), GetParam()), other(arm_scene(), GetParam());
  for (int i = 0; i < 5; ++i) sim->feedforward()[i] = 0.3 * i - 0.5;
  sim->step();
  const std::vector<unsigned char> bytes = test::saved(*sim);
  test::load(*other, bytes);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(other->feedforward()[i], sim->feedforward()[i]);
  sim->step();
  other->step();
  EXPECT_EQ(test::state_hash(*sim), test::state_hash(*other));
  std::vector<unsigned char> broken = bytes;
  std::memcpy(broken.data() + broken.size() - sizeof kNan, &kNan, sizeof kNan);
  const uint64_t before = test::state_hash(*other);
  EXPECT_THROW(test::load(*other, broken), Error);
  EXPECT_EQ(test::state_hash(*other), before);
}

TEST(FeedforwardLanes, ChangeNoBit) {
  const auto play = [](int32_t lanes) {
    SceneDef def = arm_scene();
    def.solver.lanes = lanes;
    test::Partners worlds(def, 5);
    Stream random(2, 0, Purpose::kTest);
    std::vector<uint64_t> hashes;
    for (int k = 0; k < 20; ++k) {
      for (int32_t w = 0; w < 5; ++w)
        for (int i = 0; i < 5; ++i) worlds[w].feedforward()[i] = 30 * random.signed_unit();
      World::step_together(worlds.data(), 5);
      for (int32_t w = 0; w < 5; ++w) hashes.push_back(test::state_hash(worlds[w]));
    }
    return hashes;
  };
  const auto want = play(1);
  for (const int32_t lanes : {0, 4, 8, 16}) EXPECT_EQ(play(lanes), want) << lanes;
}

// --- What holds an arm.

double potential(World& world) {  // J
  double energy = 0;
  for (int32_t i = 0; i < world.scene().num_links; ++i) {
    const LinkDef& link = world.scene().link(i);
    if (link.weightless) continue;
    energy -= link.inertia.mass * dot(world.scene().def.gravity, world.link(i).X * link.inertia.com);
  }
  return energy;
}

// The torque that holds a joint is the potential's slope.
TEST(GravityTorques, AreTheSlopesOfThePotential) {
  for (const bool some_weightless : {false, true}) {
    SceneDef def = arm_scene();
    def.gravity = {1, -2, -9.5};
    def.solver.double_precision = true;
    def.articulations[0].links[1].weightless = def.articulations[0].links[4].weightless = some_weightless;
    test::Simulation sim(def, EngineKind::kArticulated);
    Stream random(3, 0, Purpose::kTest);
    const double still[5] = {}, step = 1e-5;
    for (int k = 0; k < 20; ++k) {
      double q[5], torque[5];
      for (int i = 0; i < 5; ++i) q[i] = (i == 3 ? 0.15 : 1.5) * random.signed_unit();
      sim->set_joints(0, q, still);
      gravity_torques(*sim, 0, torque);
      for (int i = 0; i < 5; ++i) {
        const double middle = q[i];
        q[i] = middle + step;
        sim->set_joints(0, q, still);
        const double above = potential(*sim);
        q[i] = middle - step;
        sim->set_joints(0, q, still);
        EXPECT_NEAR(torque[i], (above - potential(*sim)) / (2 * step), 1e-6) << i;
        q[i] = middle;
      }
    }
  }
}

TEST(GravityTorques, AreNoneWhereThereIsNoWeight) {
  SceneDef def = arm_scene();
  for (LinkDef& link : def.articulations[0].links) link.weightless = true;
  test::Simulation light(def, EngineKind::kArticulated);
  double torque[5];
  gravity_torques(*light, 0, torque);
  for (const double t : torque) EXPECT_EQ(t, 0);
  def = arm_scene();
  def.articulations[0].gravity = false;
  test::Simulation none(def, EngineKind::kArticulated);
  gravity_torques(*none, 0, torque);
  for (const double t : torque) EXPECT_EQ(t, 0);
}

TEST(GravityTorques, OfAMirroredHandAreThoseOfTheOther) {
  SceneDef def;
  def.gravity = {4, -8, 0};  // in the plane of the mirror
  def.articulations.push_back(make_articulation(kShadowHand, Side::kRight, {{0, 0, 0.5}, {}}, "right_"));
  def.articulations.push_back(make_articulation(kShadowHand, Side::kLeft, {{0, 1, 0.5}, {}}, "left_"));
  for (ArticulationDef& a : def.articulations) a.gravity = true;
  test::Simulation sim(def, EngineKind::kArticulated);
  Stream random(4, 0, Purpose::kTest);
  double q[24], torque[2][24];
  const double still[24] = {};
  for (int32_t i = 0; i < 24; ++i) {
    const JointDef& joint = sim.scene().link(i).joint;
    q[i] = random.uniform(joint.lower, joint.upper);
  }
  for (int32_t a = 0; a < 2; ++a) {
    sim->set_joints(a, q, still);
    gravity_torques(*sim, a, torque[a]);
  }
  for (int i = 0; i < 24; ++i) EXPECT_NEAR(torque[0][i], torque[1][i], 1e-6) << i;
  EXPECT_GT(std::fabs(torque[0][0]) + std::fabs(torque[0][1]), 0.01);
}

// Without a spring: damping alone would let it sink.
TEST_P(Feedforward, GravityTorquesLetAnArmStandStill) {
  SceneDef def = arm_scene();
  def.solver.exact = true;  // QuickStep's eight sweeps do not carry an arm
  for (LinkDef& link : def.articulations[0].links) {
    link.joint.kp = 0;
    link.joint.kd = 1;
  }
  def.articulations[0].links[4].weightless = true;
  const double start[5] = {0.3, -0.7, 0.5, 0.05, 0.9}, still[5] = {};
  const auto moved = [&](bool compensated) {
    test::Simulation sim(def, GetParam());
    sim->set_joints(0, start, still);
    for (int k = 0; k < 120; ++k) {
      if (compensated) gravity_torques(*sim, 0, sim->feedforward());
      sim->step();
      EXPECT_EQ(sim->status(), 0u);
    }
    double most = 0;
    for (int i = 0; i < 5; ++i) most = std::max(most, std::fabs(sim->q()[i] - start[i]));
    return most;
  };
  EXPECT_LT(moved(true), 1e-3);
  EXPECT_GT(moved(false), 0.3);
}

TEST_P(Feedforward, WeightlessLinksDoNotFallWithTheirArm) {
  SceneDef def = arm_scene();
  for (LinkDef& link : def.articulations[0].links) link.weightless = true;
  def.articulations[0].links[4].weightless = false;
  for (LinkDef& link : def.articulations[0].links) link.joint.kp = link.joint.kd = 0;
  def.articulations[0].links[4].joint.kp = def.articulations[0].links[4].joint.kd = 0;
  test::Simulation hangs(def, GetParam());
  for (int k = 0; k < 20; ++k) hangs->step();
  double motion = 0;
  for (int i = 0; i < 5; ++i) motion = std::max(motion, std::fabs(hangs->q()[i]));
  EXPECT_GT(motion, 0.01);  // one link pulls
  def.articulations[0].links[4].weightless = true;
  test::Simulation floats(def, GetParam());
  for (int k = 0; k < 20; ++k) floats->step();
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(floats->q()[i], 0, 1e-9) << i;
}

// Engine ode makes one body of two links whose axes meet; not where one of them alone has weight.
TEST(WeightlessLinks, ShareNoBodyWithAHeavyOne) {
  SceneDef def;
  ArticulationDef a;
  a.gravity = true;
  a.links.push_back(make_link(-1, {}, {1, 0, 0}, 0.5, {0, 0.1, 0}));
  a.links.push_back(make_link(0, {}, {0, 1, 0}, 0.5, {0.1, 0, 0}));
  a.links[0].weightless = true;
  for (LinkDef& link : a.links) {
    link.X_PL = {};
    link.joint.kp = link.joint.kd = 0;
  }
  def.articulations.push_back(a);
  def.solver.exact = true;
  test::Simulation world(def, EngineKind::kArticulated), ode(def, EngineKind::kOde);
  for (int k = 0; k < 5; ++k) {
    world->step();
    ode->step();
  }
  EXPECT_GT(world->qd()[1], 1);
  EXPECT_NEAR(world->qd()[0], 0, 1e-3);  // its own mass would turn it
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(ode->qd()[i], world->qd()[i], 0.03 * world->qd()[1]) << i;
}

// Light fingers whose motors lean on their stops push a free base nowhere.
TEST(FreeBase, KeepsItsMomentumWhileMotorsLeanOnTheirStops) {
  SceneDef def;
  def.feedforward = true;
  ArticulationDef robot;
  robot.name = "two fingers";
  robot.free_base = true;
  robot.base = box_inertia(0.5, {0.1, 0.08, 0.05});
  for (int32_t i = 0; i < 2; ++i) {
    robot.links.push_back(make_link(-1, {0.05, 0.1 * i, 0}, {0, 1, 0.2 * i}, 0.02, {0, 0, 0.05}));
    JointDef& joint = robot.links.back().joint;
    joint.lower = -0.6;
    joint.upper = 0.5;
    joint.kp = 0;
    joint.kd = 0.05;
    joint.effort = 5;
  }
  def.articulations.push_back(robot);
  test::Simulation sim(def, EngineKind::kArticulated);
  for (int k = 0; k < 120; ++k) {
    for (int32_t i = 0; i < 2; ++i) sim->feedforward()[i] = k / 30 % 2 == 0 ? 5 : -5;
    sim->step();
  }
  ASSERT_EQ(sim->status(), 0u);
  EXPECT_GT(sim->qd()[0] * sim->qd()[0] + sim->q()[0] * sim->q()[0], 0.1);
  EXPECT_LT(norm(sim->base(0).v), 1e-3);
  EXPECT_LT(norm(sim->base(0).w), 1);  // what fingers of 100 rad/s cost in steps of this length; 38 by decree
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include <cstring>

#include "articulated.hpp"
#include "base/error.hpp"
#include "base/rng.hpp"
#include "physics/world.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

TEST(World, SetJointsClampsAndRebuilds) {
  test::Simulation sim(test::two_hands_def());
  double q[24] = {}, qd[24] = {};
  q[3] = 9;
  q[2] = -9;
  q[4] = 0.7;
  sim->set_joints(1, q, qd);
  EXPECT_EQ(sim->q()[24 + 3], 1.571);
  EXPECT_EQ(sim->q()[24 + 2], -0.349);
  EXPECT_EQ(sim->q()[24 + 4], 0.7);
  EXPECT_EQ(sim->q()[3], 0);
  EXPECT_LT(sim->joint_drift(), 1e-12);
}

// What is set is saved: a value that no saved state may hold is not taken from a setter either.
TEST(World, ValuesBeyondTheBoundsOfAStateAreRefusedByEveryEngine) {
  for (const EngineKind engine : {EngineKind::kOde, EngineKind::kArticulated}) {
    SceneDef def = test::two_hands_def();
    def.articulations[0].free_base = true;
    test::Simulation sim(def, engine);
    const std::vector<unsigned char> before = test::saved(*sim);
    const auto refused = [](const auto& call) {
      try {
        call();
      } catch (const Error& e) {
        return e.code == Code::kArgument;
      }
      return false;
    };
    for (const double big : {1e6, 1e7, 1e300}) {
      double still[24] = {}, fast[24] = {};
      fast[3] = -big;
      EXPECT_TRUE(refused([&] { sim->set_joints(1, still, fast); })) << big;
      const Motion motions[] = {{{{big, 0, 0}, {}}, {}, {}},
                                {{}, {0, -big, 0}, {}},
                                {{}, {}, {0, 0, big}},
                                {{{}, {1e200, big * 1e200, 0, 0}}, {}, {}}};
      for (const Motion& m : motions) {
        EXPECT_TRUE(refused([&] { sim->set_body(0, m); })) << big;
        EXPECT_TRUE(refused([&] { sim->set_base(0, m); })) << big;
      }
    }
    EXPECT_EQ(test::saved(*sim), before);
    test::load(*sim, before);
    sim->step();
    EXPECT_EQ(sim->status(), 0u);
  }
}

TEST(World, LinkVelocitiesAreTheRatesOfTheirPoses) {
  test::Simulation sim(test::two_hands_def());
  Stream random(1, 0, Purpose::kTest);
  double q[24], qd[24];
  for (int i = 0; i < 24; ++i) {
    const JointDef& joint = sim.scene().link(i).joint;
    q[i] = joint.lower + (0.2 + 0.6 * random.uniform()) * (joint.upper - joint.lower);
    qd[i] = random.signed_unit();
  }
  const double dt = 1e-6;
  Motion at[24], before[24], after[24];
  for (const int side : {-1, 1, 0}) {
    double moved[24];
    for (int i = 0; i < 24; ++i) moved[i] = q[i] + side * dt * qd[i];
    sim->set_joints(0, moved, qd);
    for (int i = 0; i < 24; ++i) (side < 0 ? before : side > 0 ? after : at)[i] = sim->link(i);
  }
  for (int i = 0; i < 24; ++i) {
    EXPECT_LT(norm((0.5 / dt) * (after[i].X.p - before[i].X.p) - at[i].v), 1e-7) << i;
    const Quat turn = after[i].X.q * conjugate(before[i].X.q);
    EXPECT_LT(norm((1 / dt) * Vec3{turn.x, turn.y, turn.z} - at[i].w), 1e-7) << i;
  }
}

TEST(World, ShapesSitOnTheirCarriers) {
  test::Simulation sim(test::two_hands_def());
  const Scene& scene = sim.scene();
  const Pose forearm = sim->shape_pose(scene.find_shape("right_forearm"));
  EXPECT_LT(norm(forearm.p - Vec3{0, -0.125, 0.49}), 1e-12);
  const Pose tip = sim->shape_pose(scene.find_shape("right_ff_distal"));
  EXPECT_LT(norm(tip.p - sim->link(5).X * Vec3{0, 0, 0.012}), 1e-12);
  sim->set_body(0, {{{1, 2, 3}, {}}, {}, {}});
  EXPECT_LT(norm(sim->shape_pose(scene.find_shape("ball")).p - Vec3{1, 2, 3}), 1e-12);
  EXPECT_EQ(norm(sim->shape_pose(scene.find_shape("ground")).p), 0);
}

TEST(World, StartsAtZeroOrTheNearestAngleInRange) {
  SceneDef def;
  ArticulationDef arm;
  LinkDef link;
  link.inertia = box_inertia(1, {0.1, 0.1, 0.1});
  link.joint.lower = 0.5;
  link.joint.upper = 1;
  arm.links.push_back(link);
  def.articulations.push_back(arm);
  test::Simulation sim(def);
  EXPECT_EQ(sim->q()[0], 0.5);
  EXPECT_EQ(sim->target()[0], 0.5);
}

TEST(World, MeasuringTakesAMeasuringArena) {
  const Scene scene = make_scene(test::two_hands_def());
  Arena real(HostHooks{}, 1 << 20);
  EXPECT_THROW(World::measure(EngineKind::kOde, scene, real), Error);
  Arena measuring;
  EXPECT_THROW(World::measure(EngineKind{99}, scene, measuring), Error);
  EXPECT_THROW(World::engine_bytes(EngineKind{99}, scene), Error);
}

}  // namespace
}  // namespace rdm

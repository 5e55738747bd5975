// Dry friction in joints against what pencil and paper say: it holds, it slides, it stops.
#include <gtest/gtest.h>

#include <cmath>

#include "two_hands.hpp"

namespace rdm {
namespace {

constexpr double kInertia = 0.02, kRub = 0.3;  // kg m2, N m

// A wheel about the vertical with friction, nothing else; torques are fed forward.
SceneDef wheel(int32_t substeps, bool in_double = false) {
  SceneDef def;
  def.feedforward = true;
  def.solver.substeps = substeps;
  def.solver.h = 1.0 / 60 / substeps;
  def.solver.double_precision = in_double;
  ArticulationDef robot;
  LinkDef link;
  link.inertia.mass = 1;
  for (int r = 0; r < 3; ++r) link.inertia.moment[r] = kInertia;
  link.joint.lower = -1e3;
  link.joint.upper = 1e3;
  link.joint.effort = 10;
  link.joint.friction = kRub;
  robot.links.push_back(link);
  def.articulations.push_back(robot);
  return def;
}

TEST(DryFriction, HoldsBelowBreakaway) {
  for (const bool in_double : {false, true})
    for (const int32_t substeps : {1, 2, 16})
      for (const double share : {0.5, -0.9, 0.99}) {
        test::Simulation sim(wheel(substeps, in_double), EngineKind::kArticulated);
        for (int k = 0; k < 120; ++k) {
          sim->feedforward()[0] = share * kRub;
          sim->step();
          ASSERT_LT(std::fabs(sim->qd()[0]), 1e-4) << substeps << ' ' << share;
        }
        EXPECT_LT(std::fabs(sim->q()[0]), 1e-4) << substeps << ' ' << share;
      }
}

TEST(DryFriction, AboveBreakawayTheRestAccelerates) {
  for (const int32_t substeps : {1, 2, 16})
    for (const double share : {1.1, -1.5, 3.0}) {
      test::Simulation sim(wheel(substeps), EngineKind::kArticulated);
      for (int k = 0; k < 60; ++k) {
        sim->feedforward()[0] = share * kRub;
        sim->step();
      }
      const double exact = (share - std::copysign(1.0, share)) * kRub / kInertia;
      EXPECT_NEAR(sim->qd()[0] / exact, 1, 0.02) << substeps << ' ' << share;
      EXPECT_NEAR(sim->q()[0] / (exact / 2), 1, 0.02) << substeps << ' ' << share;
    }
}

// From 15 rad/s at 15 rad/s2: 7.5 rad and one second, then it stands.
TEST(DryFriction, StopsAfterItsWay) {
  for (const int32_t substeps : {1, 2, 16}) {
    test::Simulation sim(wheel(substeps), EngineKind::kArticulated);
    const double q0 = 0, qd0 = kRub / kInertia;
    sim->set_joints(0, &q0, &qd0);
    for (int k = 0; k < 30; ++k) sim->step();
    EXPECT_NEAR(sim->qd()[0], qd0 / 2, 0.01 * qd0) << substeps;
    for (int k = 0; k < 33; ++k) sim->step();
    EXPECT_NEAR(sim->q()[0], qd0 / 2, 0.02 * qd0 / 2) << substeps;
    const double stood = sim->q()[0];
    for (int k = 0; k < 60; ++k) {
      sim->step();
      EXPECT_LT(std::fabs(sim->qd()[0]), 1e-4);
    }
    EXPECT_NEAR(sim->q()[0], stood, 1e-4);
  }
}

// A drive at its bound, and friction beside it: neither takes of the other's.
TEST(DryFriction, HasABoundOfItsOwn) {
  SceneDef def = wheel(2);
  JointDef& joint = def.articulations[0].links[0].joint;
  joint.kp = 100;
  joint.effort = 0.5;
  test::Simulation sim(def, EngineKind::kArticulated);
  sim->target()[0] = 500;
  for (int k = 0; k < 60; ++k) sim->step();
  EXPECT_NEAR(sim->qd()[0], (joint.effort - kRub) / kInertia, 0.02 * joint.effort / kInertia);
  EXPECT_NEAR(sim->torque()[0], joint.effort, 1e-6);
}

// A platform that slides in a vertical guide, which rubs, with a box on it: the weight comes by contacts.
TEST(DryFriction, CarriesWhatRestsOnIt) {
  constexpr double kMass = 1, kPlatform = 0.2, kWeight = kMass * 9.81;
  for (const double rub : {12.0, 8.0}) {
    SceneDef def;
    ArticulationDef guide;
    LinkDef link;
    link.inertia = box_inertia(kPlatform, {0.1, 0.1, 0.01});
    link.joint.kind = JointKind::kPrismatic;
    link.joint.lower = -10;
    link.joint.upper = 10;
    link.joint.friction = rub;
    guide.links.push_back(link);
    ArticulationShape plate;
    plate.link = 0;
    plate.shape.kind = ShapeKind::kBox;
    plate.shape.size = {0.1, 0.1, 0.01};
    guide.shapes.push_back(plate);
    def.articulations.push_back(guide);
    BodyDef box;
    box.inertia = box_inertia(kMass, {0.05, 0.05, 0.05});
    box.X_WB.p.z = 0.0599;
    ShapeDef shape;
    shape.kind = ShapeKind::kBox;
    shape.size = {0.05, 0.05, 0.05};
    box.shapes.push_back(shape);
    def.bodies.push_back(box);
    test::Simulation sim(def, EngineKind::kArticulated);
    for (int k = 0; k < 60; ++k) sim->step();
    if (rub > kWeight) {
      EXPECT_LT(std::fabs(sim->qd()[0]), 1e-4);
      EXPECT_LT(std::fabs(sim->q()[0]), 1e-3);
    } else {
      const double exact = -(kWeight - rub) / (kMass + kPlatform);
      EXPECT_NEAR(sim->qd()[0] / exact, 1, 0.05);
      EXPECT_NEAR(sim->body(0).v.z / exact, 1, 0.05);
    }
  }
}

// Engine ode has no second row for it beside a drive, but one that nothing drives sticks and stops.
TEST(DryFriction, StopsWhatNothingDrivesOnOde) {
  SceneDef def = wheel(2);
  def.solver.link_armature = 0;
  test::Simulation sim(def, EngineKind::kOde);
  const double q0 = 0, qd0 = kRub / kInertia;
  sim->set_joints(0, &q0, &qd0);
  for (int k = 0; k < 30; ++k) sim->step();
  EXPECT_NEAR(sim->qd()[0], qd0 / 2, 0.01 * qd0);
  for (int k = 0; k < 60; ++k) sim->step();
  EXPECT_NEAR(sim->q()[0], qd0 / 2, 0.02 * qd0 / 2);
  EXPECT_LT(std::fabs(sim->qd()[0]), 1e-4);
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include "base/rng.hpp"
#include "physics/ode/ode_contacts.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

constexpr double kG = 9.81;

SceneDef on_the_ground(ShapeKind kind, const Vec3& size, const Inertia& inertia, double z, double mu) {
  SceneDef def;
  BodyDef body;
  body.name = "body";
  body.X_WB.p = {0, 0, z};
  body.inertia = inertia;
  ShapeDef shape;
  shape.kind = kind;
  shape.size = size;
  body.shapes.push_back(shape);
  def.bodies.push_back(body);
  ShapeDef ground;
  ground.kind = ShapeKind::kPlane;
  def.statics.push_back(ground);
  def.friction[0][0].mu = mu;
  return def;
}

SceneDef box_on_the_ground(double mu) {
  return on_the_ground(ShapeKind::kBox, {0.05, 0.05, 0.05}, box_inertia(0.4, {0.05, 0.05, 0.05}), 0.0495, mu);
}

TEST(OdeContacts, FreeFallIsAParabola) {
  SceneDef def = on_the_ground(ShapeKind::kSphere, {0.03, 0, 0}, sphere_inertia(0.1, 0.03), 5, 1);
  test::Simulation sim(def);
  for (int k = 0; k < 30; ++k) sim->step();
  const int n = 60;
  const double h = def.solver.h;
  EXPECT_NEAR(sim->body(0).v.z, -kG * n * h, 1e-9);
  EXPECT_NEAR(sim->body(0).X.p.z, 5 - kG * h * h * n * n / 2, 1e-9);
  EXPECT_EQ(sim->num_contacts(), 0);
}

TEST(OdeContacts, SlidingBoxStopsWhereFrictionSays) {
  const double mu = 0.4, speed = 1.5;
  test::Simulation sim(box_on_the_ground(mu));
  for (int k = 0; k < 30; ++k) sim->step();
  Motion m = sim->body(0);
  m.v = {speed, 0, 0};
  const double x = m.X.p.x;
  sim->set_body(0, m);
  for (int k = 0; k < 120; ++k) sim->step();
  EXPECT_NEAR(sim->body(0).X.p.x - x, speed * speed / (2 * mu * kG), 0.03 * speed * speed / (2 * mu * kG));
  EXPECT_LT(norm(sim->body(0).v), 1e-3);
}

TEST(OdeContacts, NoFrictionNoBraking) {
  test::Simulation sim(box_on_the_ground(0));
  for (int k = 0; k < 30; ++k) sim->step();
  Motion m = sim->body(0);
  m.v = {1, 0, 0};
  sim->set_body(0, m);
  for (int k = 0; k < 60; ++k) sim->step();
  EXPECT_NEAR(sim->body(0).v.x, 1, 1e-6);
}

TEST(OdeContacts, SlidingBallEndsUpRollingAtFiveSevenths) {
  const double r = 0.05;
  test::Simulation sim(on_the_ground(ShapeKind::kSphere, {r, 0, 0}, sphere_inertia(0.2, r), r - 0.0005, 0.3));
  for (int k = 0; k < 30; ++k) sim->step();
  Motion m = sim->body(0);
  m.v = {0, 2, 0};
  sim->set_body(0, m);
  for (int k = 0; k < 60; ++k) sim->step();
  EXPECT_NEAR(sim->body(0).v.y, 2 * 5.0 / 7, 0.01 * 2);
  EXPECT_NEAR(sim->body(0).w.x, -sim->body(0).v.y / r, 0.01 * 2 / r);
}

TEST(OdeContacts, FreeMotionIsDampedExactly) {
  SceneDef def = on_the_ground(ShapeKind::kSphere, {0.03, 0, 0}, sphere_inertia(0.1, 0.03), 5, 1);
  def.bodies[0].angular_damping = 3;
  def.bodies[0].linear_damping = 2;
  test::Simulation sim(def);
  sim->set_body(0, {def.bodies[0].X_WB, {1, 0, 0}, {0, 0, 10}});
  const int n = 60;
  const double h = def.solver.h;
  for (int k = 0; k < n / 2; ++k) sim->step();
  EXPECT_NEAR(sim->body(0).w.z, 10 * std::exp(-3 * h * n), 1e-9);
  EXPECT_NEAR(sim->body(0).v.x, std::exp(-2 * h * n), 1e-9);
  for (int k = 0; k < 600; ++k) {
    sim->set_body(0, {def.bodies[0].X_WB, sim->body(0).v, {}});
    sim->step();
  }
  EXPECT_NEAR(sim->body(0).v.z, -kG / 2, 1e-7);  // terminal speed, whatever the step
}

TEST(OdeContacts, SpinIsBounded) {
  test::Simulation sim(on_the_ground(ShapeKind::kSphere, {0.03, 0, 0}, sphere_inertia(0.1, 0.03), 5, 1));
  for (int k = 0; k < 60; ++k) {
    sim->push_body(0, {}, {0, 0, 1});
    sim->step();
  }
  EXPECT_NEAR(norm(sim->body(0).w) * sim.scene().def.solver.h, kMaxBodyTurn, 1e-9);
  EXPECT_EQ(sim->status(), kStatusSlowed);
}

TEST(OdeContacts, ForcesCarryTheWeight) {
  test::Simulation sim(box_on_the_ground(1));
  for (int k = 0; k < 120; ++k) sim->step();
  ASSERT_EQ(sim->num_contacts(), 4);
  Vec3 sum;
  for (int k = 0; k < 4; ++k) {
    const Contact& c = sim->contacts()[k];
    EXPECT_EQ(c.shape_a, 0);
    EXPECT_EQ(c.shape_b, 1);
    EXPECT_NEAR(c.n.z, 1, 1e-9);  // from the ground into the box
    EXPECT_GE(c.depth, 0);
    EXPECT_LT(c.depth, 1.5e-3);
    sum += c.force;
  }
  EXPECT_NEAR(sum.z, 0.4 * kG, 0.02 * 0.4 * kG);
  EXPECT_TRUE(sim->pair_touched(0));
}

TEST(OdeContacts, PushActsOnceAndAtTheCentre) {
  SceneDef def = on_the_ground(ShapeKind::kSphere, {0.03, 0, 0}, sphere_inertia(0.1, 0.03), 5, 1);
  def.gravity = {};
  test::Simulation sim(def);
  sim->push_body(0, {0.3, 0, 0}, {0, 0, 1e-4});
  for (int k = 0; k < 3; ++k) sim->step();
  EXPECT_NEAR(sim->body(0).v.x, 0.3 / 0.1 / 60, 1e-9);
  EXPECT_NEAR(sim->body(0).w.z, 1e-4 / (0.4 * 0.1 * 0.0009) / 60, 1e-9);
}

TEST(OdeContacts, SensorsFeelTheLoadInTheirLinksFrame) {
  // A block on a plate that a drive holds level. The plate's frame is turned: its y looks up.
  SceneDef def;
  ArticulationDef scale;
  LinkDef plate;
  plate.X_PL = {{0, 0, 1}, axis_angle({1, 0, 0}, std::acos(0.0))};
  plate.inertia = box_inertia(1, {0.1, 0.01, 0.1});
  plate.joint.axis = {0, 0, 1};
  plate.joint.lower = -1;
  plate.joint.upper = 1;
  plate.joint.kp = 500;
  plate.joint.kd = 20;
  plate.joint.effort = 100;
  plate.sensor = true;
  scale.links.push_back(plate);
  LinkDef other = plate;
  other.X_PL.p = {0, 1, 1};
  scale.links.push_back(other);
  ArticulationShape top;
  top.link = 0;
  top.shape.kind = ShapeKind::kBox;
  top.shape.size = {0.1, 0.01, 0.1};
  scale.shapes.push_back(top);
  def.articulations.push_back(scale);
  BodyDef block;
  block.inertia = box_inertia(0.2, {0.02, 0.02, 0.02});
  block.X_WB.p = {0.05, -0.03, 1 + 0.01 + 0.0195};
  ShapeDef shape;
  shape.kind = ShapeKind::kBox;
  shape.size = {0.02, 0.02, 0.02};
  block.shapes.push_back(shape);
  def.bodies.push_back(block);
  test::Simulation sim(def);
  for (int k = 0; k < 120; ++k) sim->step();
  Wrench mean;
  for (int k = 0; k < 60; ++k) {
    sim->step();
    mean.force += (1.0 / 60) * sim->sensor(0).force;
    mean.torque += (1.0 / 60) * sim->sensor(0).torque;
  }
  // In the plate's axes the block lies at (0.05, 0.03 above, 0.03) and pulls along -y.
  const double weight = 0.2 * kG;
  EXPECT_NEAR(mean.force.y, -weight, 0.02 * weight);
  EXPECT_NEAR(mean.force.x, 0, 0.02 * weight);
  EXPECT_NEAR(mean.force.z, 0, 0.02 * weight);
  EXPECT_NEAR(mean.torque.x, 0.03 * weight, 0.002 * weight);
  EXPECT_NEAR(mean.torque.z, -0.05 * weight, 0.002 * weight);
  EXPECT_EQ(norm(sim->sensor(1).force), 0);
}

TEST(OdeContacts, OverflowRaisesTheBitAndDropsTheRest) {
  SceneDef def = box_on_the_ground(1);
  test::Simulation enough(def);
  enough->step();
  EXPECT_EQ(enough->status(), 0u);
  def.solver.contacts_max = 1;
  test::Simulation sim(def);
  for (int k = 0; k < 5; ++k) {
    sim->step();
    EXPECT_EQ(sim->status(), kStatusContactOverflow);
    EXPECT_EQ(sim->num_contacts(), 1);
  }
}

TEST(OdeContacts, PairTouchedIsTheOrOverTheSubsteps) {
  // The ball meets the ground and is off it again, or out of reach, by the last substep.
  SceneDef def = on_the_ground(ShapeKind::kSphere, {0.03, 0, 0}, sphere_inertia(0.1, 0.03), 0.0299, 1);
  def.gravity = {};
  test::Simulation sim(def);
  sim->set_body(0, {{{0, 0, 0.0299}, {}}, {0, 0, 5}, {}});
  sim->step();
  EXPECT_EQ(sim->num_contacts(), 0);
  EXPECT_TRUE(sim->pair_touched(0));
  sim->step();
  EXPECT_FALSE(sim->pair_touched(0));
}

TEST(OdeContacts, OverlapIsTheDepthOfTheBody) {
  SceneDef def = on_the_ground(ShapeKind::kSphere, {0.03, 0, 0}, sphere_inertia(0.1, 0.03), 1, 1);
  test::Simulation sim(def);
  EXPECT_EQ(sim->body_overlap(0), 0);
  sim->set_body(0, {{{0, 0, 0.02}, {}}, {}, {}});
  EXPECT_NEAR(sim->body_overlap(0), 0.01, 1e-12);
}

TEST(OdeContacts, CylindersCapsulesAndBoxesRest) {
  struct Case {
    ShapeKind kind;
    Vec3 size;
    Inertia inertia;
    double z;
  };
  const Case cases[] = {
      {ShapeKind::kCylinder, {0.03, 0.05, 0}, cylinder_inertia(0.1, 0.03, 0.05), 0.05},
      {ShapeKind::kCapsule, {0.03, 0.02, 0}, capsule_inertia(0.1, 0.03, 0.02), 0.05},
      {ShapeKind::kBox, {0.02, 0.03, 0.04}, box_inertia(0.1, {0.02, 0.03, 0.04}), 0.04},
  };
  for (const Case& c : cases) {
    test::Simulation sim(on_the_ground(c.kind, c.size, c.inertia, c.z, 1));
    for (int k = 0; k < 120; ++k) sim->step();
    EXPECT_LT(norm(sim->body(0).v), 1e-3) << static_cast<int>(c.kind);
    EXPECT_NEAR(sim->body(0).X.p.z, c.z, 2e-3) << static_cast<int>(c.kind);
  }
}

TEST(OdeContacts, BottleStandsAndLiesStillOnATable) {
  for (const bool lies : {false, true}) {
    SceneDef def = on_the_ground(ShapeKind::kCylinder, {0.0395, 0.0875, 0},
                                 cylinder_inertia(0.06, 0.0395, 0.0875), lies ? 0.0393 : 0.0873, 0.5);
    if (lies) def.bodies[0].X_WB.q = axis_angle({0, 1, 0}, std::acos(0.0));
    ShapeDef& table = def.statics[0];
    table.kind = ShapeKind::kBox;
    table.size = {0.5, 0.5, 0.01};
    table.X_LS.p = {0, 0, -0.01};
    test::Simulation sim(def);
    for (int k = 0; k < 600; ++k) sim->step();
    EXPECT_LT(std::hypot(sim->body(0).X.p.x, sim->body(0).X.p.y), 2e-3) << lies;
    const Vec3 up = rotate(sim->body(0).X.q, {0, 0, 1});
    EXPECT_LT(std::fabs(lies ? std::asin(up.z) : std::acos(std::min(1.0, up.z))), 0.01) << lies;
    EXPECT_LT(norm(sim->body(0).v), 5e-3) << lies;
  }
}

TEST(OdeContacts, GraspsAreKept) {
  int kept = 0;
  for (uint32_t trial = 0; trial < 10; ++trial) {
    test::Simulation sim(test::two_hands_def());
    Stream random(11, trial, Purpose::kTest);
    test::target_share(*sim, 0, test::kCup);
    sim->set_body(0,
                  {{{0.01 * random.signed_unit(), -0.35 + 0.01 * random.signed_unit(), 0.56}, {}}, {}, {}});
    for (int k = 0; k < 420; ++k) sim->step();
    kept += sim->body(0).X.p.z > 0.45 && norm(sim->body(0).v) < 0.1;
  }
  EXPECT_EQ(kept, 10);
}

}  // namespace
}  // namespace rdm

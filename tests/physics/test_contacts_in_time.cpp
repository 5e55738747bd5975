// Contacts in time: fast things stop at what they would pass through, and what slides over seams goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "articulated.hpp"
#include "physics/articulated/stepper.hpp"
#include "physics/collision/manifold.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr EngineKind kEngine = EngineKind::kArticulated;
constexpr double kHalf = 0.03, kMass = 0.1;  // m, kg, of the things that are shot
constexpr double kStep = 1.0 / 120;          // s, a substep

ShapeDef shape(ShapeKind kind, const Vec3& size, const Pose& X = {}) {
  ShapeDef s;
  s.kind = kind;
  s.size = size;
  s.X_LS = X;
  return s;
}

ShapeDef hull_of(std::vector<Vec3> points) {
  ShapeDef s = shape(ShapeKind::kHull, {});
  s.points.assign(points.begin(), points.end());
  return s;
}

ShapeDef thing(ShapeKind kind) {
  constexpr double h = kHalf;
  switch (kind) {
    case ShapeKind::kCapsule:  // across its way
      return shape(kind, {0.66 * h, h, 0}, {{}, axis_angle({0, 1, 0}, kPi / 2)});
    case ShapeKind::kCylinder:
      return shape(kind, {h, h, 0});
    case ShapeKind::kEllipsoid:
      return shape(kind, {h, h, 1.3 * h});
    case ShapeKind::kHull: {
      constexpr double k = 0.6 * h;
      return hull_of({{h, 0, 0},
                      {-h, 0, 0},
                      {0, h, 0},
                      {0, -h, 0},
                      {0, 0, h},
                      {0, 0, -h},
                      {k, k, k},
                      {-k, -k, -k},
                      {k, -k, k},
                      {-k, k, -k}});
    }
    default:
      return shape(kind, {h, h, h});
  }
}

BodyDef body_of(const ShapeDef& s, double mass = kMass) {
  BodyDef b;
  b.shapes.push_back(s);
  b.inertia = box_inertia(mass, {kHalf, kHalf, kHalf});
  return b;
}

SceneDef empty_scene(const Vec3& gravity, bool in_time) {
  SceneDef def;
  def.gravity = gravity;
  def.solver.speculative_contacts = in_time;
  def.solver.contacts_max = 64;
  def.friction[0][0].mu = 0.5;
  return def;
}

// A link on a stiff hinge along z at the origin.
ArticulationDef stiff_link(const ShapeDef& s) {
  ArticulationDef robot;
  LinkDef link;
  link.inertia.mass = 1;
  for (int k = 0; k < 3; ++k) link.inertia.moment[k] = 1e-2;
  link.joint.axis = {0, 0, 1};
  link.joint.lower = -1e3;
  link.joint.upper = 1e3;
  link.joint.kp = 1000;
  link.joint.kd = 10;
  link.joint.effort = 1e4;
  robot.links.push_back(link);
  ArticulationShape on;
  on.link = 0;
  on.shape = s;
  robot.shapes.push_back(on);
  return robot;
}

enum class Target { kWall, kPlate, kFinger };

SceneDef range(Target target, double half, const ShapeDef& bullet, bool in_time = true) {
  SceneDef def = empty_scene({}, in_time);
  def.bodies.push_back(body_of(bullet));
  if (target == Target::kWall)
    def.statics.push_back(shape(ShapeKind::kBox, {half, 0.3, 0.3}));
  else if (target == Target::kPlate)
    def.articulations.push_back(stiff_link(shape(ShapeKind::kBox, {half, 0.1, 0.1})));
  else
    def.articulations.push_back(stiff_link(shape(ShapeKind::kCapsule, {half, 0.1, 0})));
  return def;
}

struct Shots {
  int through = 0;
  double deepest = 0, most_speed = 0, most_spin = 0;  // m, of the start's speed, rad/s
};

// From places spread over a substep's way; through: past the target's middle within its outline and the
// thing's.
Shots shoot(const SceneDef& def, double speed, double thick, double size = kHalf, int count = 24) {
  test::Simulation sim(def, kEngine);
  Shots all;
  for (int k = 0; k < count; ++k) {
    Motion m;
    m.X.p = {-0.25 - speed * kStep * k / count, 0.003 * (k % 5 - 2), 0.002 * (k % 3 - 1)};
    m.v = {speed, 0, 0};
    sim->set_body(0, m);
    double before = m.X.p.x;
    for (int i = 0; i < std::max(12, static_cast<int>(36 / speed)); ++i) {
      sim->step();
      const Motion& now = sim->body(0);
      const bool beside = std::fabs(now.X.p.y) > size + thick;
      all.through += before < 0 && now.X.p.x >= 0 && !beside;
      before = now.X.p.x;
      all.most_speed = std::max(all.most_speed, norm(now.v) / speed);
      all.most_spin = std::max(all.most_spin, norm(now.w));
      for (int32_t c = 0; c < sim->num_contacts(); ++c) {
        EXPECT_GE(sim->contacts()[c].depth, 0);
        all.deepest = std::max(all.deepest, sim->contacts()[c].depth);
      }
    }
  }
  return all;
}

const char* name_of(ShapeKind kind) {
  constexpr const char* kNames[] = {"sphere", "capsule", "box", "cylinder", "plane", "ellipsoid", "hull"};
  return kNames[static_cast<int>(kind)];
}
constexpr ShapeKind kThings[] = {ShapeKind::kSphere,   ShapeKind::kCapsule,   ShapeKind::kBox,
                                 ShapeKind::kCylinder, ShapeKind::kEllipsoid, ShapeKind::kHull};

TEST(ContactsInTime, NothingPassesAWallAPlateOrAFinger) {
  constexpr struct {
    Target target;
    double half;
    const char* name;
  } kTargets[] = {{Target::kWall, 0.05, "wall of 10 cm"},
                  {Target::kWall, 0.0025, "wall of 5 mm"},
                  {Target::kPlate, 0.0025, "plate of 5 mm"},
                  {Target::kFinger, 0.008, "finger"}};
  for (const auto& t : kTargets)
    for (const ShapeKind kind : kThings)
      for (const double speed : {1.0, 4.0, 6.0, 12.0}) {
        const std::string what =
            std::string(name_of(kind)) + " at " + t.name + ", " + std::to_string(speed) + " m/s";
        const Shots shots = shoot(range(t.target, t.half, thing(kind)), speed, t.half);
        EXPECT_EQ(shots.through, 0) << what;
        EXPECT_LE(shots.most_speed, 1 + 1e-6) << what;
      }
}

TEST(ContactsInTime, WithoutThemFastThingsPass) {
  EXPECT_GT(shoot(range(Target::kWall, 0.0025, thing(ShapeKind::kBox), false), 12, 0.0025).through, 12);
}

TEST(ContactsInTime, SmallBallsStopAtThinPlates) {
  for (const double radius : {0.002, 0.005})
    for (const double half : {0.0005, 0.0025, 0.005})
      for (const double speed : {0.5, 1.0, 4.0, 12.0}) {
        SceneDef def = range(Target::kWall, half, shape(ShapeKind::kSphere, {radius, 0, 0}));
        def.bodies[0].inertia = box_inertia(0.001, {radius, radius, radius});
        const Shots shots = shoot(def, speed, half, radius);
        EXPECT_EQ(shots.through, 0) << radius << " " << half << " " << speed;
        EXPECT_LT(shots.deepest, 2e-3);
      }
}

// An egg on a table of 5 mm, on a finger, and on the ground.
TEST(ContactsInTime, AnEggSinksNoDeeperThanTwoMillimetres) {
  for (int on = 0; on < 3; ++on) {
    SceneDef def = empty_scene({0, 0, -9.81}, true);
    def.bodies.push_back(body_of(shape(ShapeKind::kEllipsoid, {0.03, 0.03, 0.04}), 0.06));
    if (on == 0) def.statics.push_back(shape(ShapeKind::kBox, {0.2, 0.2, 0.0025}, {{0, 0, -0.0025}, {}}));
    if (on == 1)
      def.statics.push_back(
          shape(ShapeKind::kCapsule, {0.008, 0.1, 0}, {{0, 0, -0.008}, axis_angle({0, 1, 0}, kPi / 2)}));
    if (on == 2) def.statics.push_back(shape(ShapeKind::kPlane, {}));
    test::Simulation sim(def, kEngine);
    for (int k = 0; k < 12; ++k) {
      Motion m;
      m.X.p = {0, 0, 0.2 + 3 * kStep * k / 12};
      m.v = {0, 0, -3};
      sim->set_body(0, m);
      double deepest = 0;
      for (int i = 0; i < 12; ++i) {
        sim->step();
        for (int32_t c = 0; c < sim->num_contacts(); ++c)
          deepest = std::max(deepest, sim->contacts()[c].depth);
      }
      EXPECT_LT(deepest, 2e-3) << on << " " << k;
    }
  }
}

TEST(ContactsInTime, WhatPassesByFeelsNothing) {
  for (const ShapeKind kind : {ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kHull})
    for (const double speed : {3.0, 12.0})
      for (const double clear : {1e-4, 1e-3, 5e-3}) {
        SceneDef def = empty_scene({}, true);
        const ShapeDef bullet = kind == ShapeKind::kHull ? hull_of({{kHalf, kHalf, kHalf},
                                                                    {-kHalf, kHalf, kHalf},
                                                                    {kHalf, -kHalf, kHalf},
                                                                    {-kHalf, -kHalf, kHalf},
                                                                    {kHalf, kHalf, -kHalf},
                                                                    {-kHalf, kHalf, -kHalf},
                                                                    {kHalf, -kHalf, -kHalf},
                                                                    {-kHalf, -kHalf, -kHalf}})
                                                         : thing(kind);
        def.bodies.push_back(body_of(bullet));
        def.statics.push_back(shape(ShapeKind::kBox, {0.05, 0.05, 0.3}, {{0, -0.05, 0}, {}}));
        test::Simulation sim(def, kEngine);
        for (int k = 0; k < 12; ++k) {
          Motion m;
          m.X.p = {-0.3 - speed * kStep * k / 12, kHalf + clear, 0};
          m.v = {speed, 0, 0};
          sim->set_body(0, m);
          for (int i = 0; i < 15; ++i) sim->step();
          EXPECT_EQ(norm(sim->body(0).v - m.v), 0) << name_of(kind) << " " << speed << " " << clear;
        }
      }
}

// Two things that fly into each other: momentum stays, energy does not grow.
TEST(ContactsInTime, FlyingThingsMeet) {
  for (const ShapeKind kind : kThings) {
    SceneDef def = empty_scene({}, true);
    for (int i = 0; i < 2; ++i) def.bodies.push_back(body_of(thing(kind)));
    test::Simulation sim(def, kEngine);
    for (int k = 0; k < 12; ++k) {
      for (int i = 0; i < 2; ++i) {
        Motion m;
        m.X.p = {(i ? 0.2 : -0.2) - 12 * kStep * k / 12, 0.004 * i, 0};
        m.v = {i ? -6.0 : 12.0, 0, 0};
        sim->set_body(i, m);
      }
      const double before = 0.5 * kMass * (144 + 36);
      bool past = false;
      for (int i = 0; i < 6; ++i) {
        sim->step();
        const Motion &a = sim->body(0), &b = sim->body(1);
        EXPECT_LE(0.5 * kMass * (dot(a.v, a.v) + dot(b.v, b.v)), before * (1 + 1e-6)) << name_of(kind);
        EXPECT_LT(norm(a.v + b.v - Vec3{6, 0, 0}), 1e-5) << name_of(kind);
        const Vec3 apart = b.X.p - a.X.p;
        const bool passes = apart.x < 0 && !past;
        past = past || passes;
        // round the other, at most
        EXPECT_TRUE(!passes || std::hypot(apart.y, apart.z) > kHalf) << name_of(kind) << " " << k;
      }
    }
  }
}

TEST(ContactsInTime, ABlowWakesASleeper) {
  SceneDef def = empty_scene({0, 0, -9.81}, true);
  def.solver.sleep_time = 0.1;
  def.statics.push_back(shape(ShapeKind::kPlane, {}));
  for (int i = 0; i < 2; ++i) {
    def.bodies.push_back(body_of(thing(ShapeKind::kBox)));
    def.bodies.back().X_WB.p = {i * 2.0, 0, kHalf - 4e-4};
  }
  test::Simulation sim(def, kEngine);
  for (int i = 0; i < 60; ++i) sim->step();
  ASSERT_EQ(norm(sim->body(0).v), 0);
  Motion m;
  m.X.p = {-0.3, 0, kHalf};
  m.v = {12, 0, 0};
  sim->set_body(1, m);
  for (int i = 0; i < 3; ++i) sim->step();
  EXPECT_GT(sim->body(0).v.x, 1);
  EXPECT_LT(sim->body(1).X.p.x, sim->body(0).X.p.x);
}

TEST(ContactsInTime, PointsToComeRaiseTheOverflowFlagToo) {
  SceneDef def = range(Target::kWall, 0.0025, thing(ShapeKind::kBox));
  def.solver.contacts_max = 2;
  def.bodies[0].X_WB.p = {-0.1, 0, 0};
  test::Simulation sim(def, kEngine);
  Motion m;
  m.X.p = {-0.1, 0, 0};
  m.v = {6, 0, 0};
  sim->set_body(0, m);
  uint32_t status = 0;
  for (int i = 0; i < 2; ++i) {
    sim->step();
    status |= sim->status();
  }
  EXPECT_NE(status & kStatusContactOverflow, 0u);
}

// Fingers, bodies and walls at once.
SceneDef storm(int32_t lanes) {
  SceneDef def = empty_scene({0, 0, -9.81}, true);
  def.solver.lanes = lanes;
  def.solver.contacts_max = 200;
  def.articulations.push_back(stiff_link(shape(ShapeKind::kCapsule, {0.008, 0.1, 0})));
  def.articulations.push_back(stiff_link(shape(ShapeKind::kBox, {0.0025, 0.1, 0.1})));
  def.articulations[1].X_WB.p = {0.2, 0, 0};
  def.statics.push_back(shape(ShapeKind::kPlane, {}, {{0, 0, -0.15}, {}}));
  def.statics.push_back(shape(ShapeKind::kBox, {0.002, 0.3, 0.3}, {{-0.3, 0, 0}, {}}));
  for (int i = 0; i < 12; ++i) {
    def.bodies.push_back(body_of(thing(kThings[i % 6])));
    def.bodies.back().X_WB.p = {-0.15 + 0.1 * (i % 4), 0.12 * (i / 4 - 1), 0.25 + 0.02 * i};
  }
  return def;
}
void throw_all(World& world, int32_t salt) {
  for (int32_t i = 0; i < world.scene().num_bodies; ++i) {
    Motion m = world.body(i);
    m.X.p = world.scene().def.bodies[static_cast<size_t>(i)].X_WB.p;
    m.v = {3.0 * ((i * 7 + salt) % 5 - 2), 2.0 * ((i * 3 + salt) % 5 - 2), -5};
    m.w = {1.0 * (i % 3), -2, 4};
    world.set_body(i, m);
  }
}

TEST(ContactsInTime, TheBytesAreThoseOfOneLane) {
  std::vector<uint64_t> hashes;
  for (const int32_t lanes : {1, 4, 8, 16}) {
    if (lanes > widest_lanes()) continue;
    test::Partners worlds(storm(lanes), 5);
    for (int32_t i = 0; i < worlds.size(); ++i) throw_all(worlds[i], i);
    for (int k = 0; k < 40; ++k) World::step_together(worlds.data(), worlds.size());
    uint64_t hash = 0;
    for (int32_t i = 0; i < worlds.size(); ++i) hash = 31 * hash + test::state_hash(worlds[i]);
    hashes.push_back(hash);
  }
  for (const uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

TEST(ContactsInTime, AStateGoesOnAsItWouldHave) {
  test::Simulation sim(storm(0), kEngine), other(storm(0), kEngine);
  throw_all(*sim, 1);
  for (int k = 0; k < 4; ++k) sim->step();
  test::load(*other, test::saved(*sim));
  for (int k = 0; k < 20; ++k) {
    sim->step();
    other->step();
    ASSERT_EQ(test::state_hash(*sim), test::state_hash(*other)) << k;
  }
}

// --- Seams.

SceneDef floor_of(bool tiles, const ShapeDef& slider) {
  SceneDef def = empty_scene({0, 0, -9.81}, false);
  def.friction[0][0].mu = 0.1;
  if (tiles)
    for (int i = 0; i < 40; ++i)
      def.statics.push_back(shape(ShapeKind::kBox, {0.05, 0.3, 0.05}, {{0.1 * i, 0, -0.05}, {}}));
  else
    def.statics.push_back(shape(ShapeKind::kBox, {2, 0.3, 0.05}, {{1.95, 0, -0.05}, {}}));
  def.bodies.push_back(body_of(slider));
  return def;
}

// Speed left after 0.6 s, and how high it hopped.
struct Slide {
  double speed, hop;
};
Slide slide(bool tiles, const ShapeDef& slider, double half, double speed, double above, bool in_time) {
  SceneDef def = floor_of(tiles, slider);
  def.solver.speculative_contacts = in_time;
  test::Simulation sim(def, kEngine);
  Motion m;
  m.X.p = {0.01, 0, half + above};
  m.v = {speed, 0, 0};
  sim->set_body(0, m);
  double hop = 0;
  for (int k = 0; k < 36; ++k) {
    sim->step();
    hop = std::max(hop, sim->body(0).X.p.z - half);
  }
  return {sim->body(0).v.x, hop};
}

TEST(Seams, NothingTripsOnFlushTiles) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back({i & 1 ? 0.05 : -0.05, i & 2 ? 0.05 : -0.05, i & 4 ? 0.02 : -0.02});
  const struct {
    const char* name;
    ShapeDef shape;
    double half;
  } kSliders[] = {{"box", shape(ShapeKind::kBox, {0.05, 0.05, 0.02}), 0.02},
                  {"hull", hull_of(corners), 0.02},
                  {"cylinder", shape(ShapeKind::kCylinder, {0.05, 0.02, 0}), 0.02},
                  {"ball", shape(ShapeKind::kSphere, {0.03, 0, 0}), 0.03}};
  for (const auto& s : kSliders)
    for (const double speed : {1.0, 2.0, 5.0})
      for (const double above : {-5e-4, 0.0, 3e-4})
        for (const bool in_time : {false, true}) {
          const Slide slab = slide(false, s.shape, s.half, speed, above, in_time),
                      tiles = slide(true, s.shape, s.half, speed, above, in_time);
          EXPECT_NEAR(tiles.speed, slab.speed, 0.01 * speed)
              << s.name << " " << speed << " m/s, " << above << " above, in time " << in_time;
          EXPECT_LT(tiles.hop, 1e-3) << s.name << " " << speed << " m/s, " << above;
        }
}

// A step that is one: the next tile stands 2 cm higher.
TEST(Seams, AStepStopsASlider) {
  SceneDef def = floor_of(false, shape(ShapeKind::kBox, {0.05, 0.05, 0.02}));
  def.statics.push_back(shape(ShapeKind::kBox, {0.05, 0.3, 0.05}, {{0.3, 0, -0.03}, {}}));
  test::Simulation sim(def, kEngine);
  Motion m;
  m.X.p = {0, 0, 0.02 - 5e-4};
  m.v = {1, 0, 0};
  sim->set_body(0, m);
  for (int k = 0; k < 36; ++k) sim->step();
  EXPECT_LT(sim->body(0).X.p.x, 0.21);
}

// --- Capsules on boxes.

TEST(CapsuleOnBox, LiesOnTwoPoints) {
  const Convex box = {ShapeKind::kBox, {0.5, 0.1, 0.05}, {0, 0, -0.05}, to_matrix(Quat{})};
  const auto lying = [](double y, double angle, double z) {
    return Convex{ShapeKind::kCapsule,
                  {0.02, 0.06, 0},
                  {0, y, z},
                  to_matrix(axis_angle({0, 0, 1}, angle) * axis_angle({0, 1, 0}, kPi / 2))};
  };
  ManifoldPoint out[2];
  ASSERT_EQ(capsule_on_box(lying(0, 0.3, 0.019), box, 1e-3, out), 2);
  for (const ManifoldPoint& p : out) {
    EXPECT_NEAR(p.depth, 1e-3, 1e-12);
    EXPECT_NEAR(p.n.z, 1, 1e-12);
  }
  EXPECT_NEAR(norm(out[0].p - out[1].p), 0.12, 1e-12);
  // across the edge: up to there
  ASSERT_EQ(capsule_on_box(lying(0.1, kPi / 2, 0.019), box, 1e-3, out), 2);
  EXPECT_NEAR(std::max(out[0].p.y, out[1].p.y), 0.1, 1e-12);
  // along the edge and beside it
  ASSERT_EQ(capsule_on_box(lying(0.11, 0, 0.016), box, 1e-3, out), 2);
  EXPECT_GT(out[0].n.y, 0.1);
  // on one end
  EXPECT_EQ(capsule_on_box(Convex{ShapeKind::kCapsule, {0.02, 0.06, 0}, {0, 0, 0.079}, to_matrix(Quat{})},
                           box, 1e-3, out),
            0);
}

TEST(CapsuleOnBox, RollsAndDoesNotRock) {
  SceneDef def = empty_scene({0, 0, -9.81}, false);
  def.statics.push_back(shape(ShapeKind::kBox, {0.5, 0.5, 0.05}, {{0, 0, -0.05}, {}}));
  def.bodies.push_back(
      body_of(shape(ShapeKind::kCapsule, {0.02, 0.06, 0}, {{}, axis_angle({1, 0, 0}, kPi / 2)})));
  test::Simulation sim(def, kEngine);
  Motion m;
  m.X.p = {0, 0, 0.0195};
  sim->set_body(0, m);
  for (int k = 0; k < 60; ++k) {
    sim->step();
    EXPECT_EQ(sim->num_contacts(), 2);
  }
  EXPECT_LT(norm(sim->body(0).w), 1e-3);
}

}  // namespace
}  // namespace rdm

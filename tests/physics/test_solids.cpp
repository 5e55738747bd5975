// Ellipsoids and hulls in motion, on both engines: at rest, rolling, standing, falling on a hand.
#include <gtest/gtest.h>

#include <cmath>

#include "articulated.hpp"
#include "heap_count.hpp"
#include "hulls.hpp"
#include "quality_bodies.hpp"

namespace rdm {
namespace {

constexpr double kMass = 0.1;

class Solids : public testing::TestWithParam<EngineKind> {
 protected:
  // The object on a plane, after `seconds`.
  Motion after(double seconds, const BodyDef& body, const ShapeDef& ground = test::make_plane()) const {
    SceneDef def;
    def.bodies.push_back(body);
    def.statics.push_back(ground);
    test::Simulation sim(def, GetParam());
    const int steps = static_cast<int>(std::lround(seconds / sim.scene().control_dt()));
    for (int k = 0; k < steps; ++k) sim->step();
    return sim->body(0);
  }
};

BodyDef ellipsoid(const Vec3& half, const Pose& X) {
  return test::make_body(ShapeKind::kEllipsoid, half, ellipsoid_inertia(kMass, half), X);
}
BodyDef hull(const Hull& of, const Pose& X) {
  BodyDef body = test::make_body(ShapeKind::kHull, {}, hull_inertia(kMass, of), X);
  body.inertia.com = {};
  for (int32_t i = 0; i < of.num_points; ++i) body.shapes[0].points.push_back(of.points[i] - of.com);
  return body;
}

TEST_P(Solids, AnEllipsoidRestsAtItsHalfAxis) {
  const Vec3 half = {0.04, 0.03, 0.02};
  // its shortest axis up is its only stable place, from which it was turned a little
  BodyDef body = ellipsoid(half, {{0, 0, 0.021}, axis_angle({1, 0, 0}, 0.1)});
  body.angular_damping = 20;
  const Motion m = after(3, body);
  EXPECT_NEAR(m.X.p.z, half.z, 1e-3);
  EXPECT_LT(norm(m.v), 2e-3);
  EXPECT_GT(rotate(m.X.q, {0, 0, 1}).z, 0.999);
}

TEST_P(Solids, AnEllipsoidRollsAsABallOfItsWaist) {
  const double radius = 0.03, slope = 0.1, seconds = 0.5;
  const Quat down = axis_angle({0, 1, 0}, slope);
  const Vec3 up = rotate(down, {0, 0, 1}), along = rotate(down, {1, 0, 0});
  const Pose start = {(radius - 5e-4) * up, down * axis_angle({1, 0, 0}, kPi / 2)};
  const Motion m = after(seconds, ellipsoid({radius, radius, 0.04}, start), test::make_plane(down));
  const double way = 0.5 * test::kGravity * std::sin(slope) / 1.4 * seconds * seconds;
  EXPECT_NEAR(dot(m.X.p - start.p, along) / way, 1, 0.03);
  EXPECT_NEAR(norm(m.w) * radius / norm(m.v), 1, 0.02);
  EXPECT_NEAR(m.X.p.y, 0, 1e-3);
}

TEST_P(Solids, AHullOfABoxFallsAndStandsAsTheBox) {
  const Vec3 half = {0.02, 0.03, 0.05};
  const Pose start = {{0.01, 0.02, 0.06}, axis_angle(normalized(Vec3{1, 1, 0}), 0.15)};
  ShapeDef table = test::make_plane();
  table.kind = ShapeKind::kBox;
  table.size = {0.3, 0.3, 0.05};
  table.X_LS.p.z = -0.05;
  const Hull of = block_hull(half, half);
  for (const ShapeDef& ground : {test::make_plane(), table}) {
    const Motion box = after(2, test::make_box(kMass, half, start), ground),
                 same = after(2, hull(of, start), ground);
    EXPECT_NEAR(same.X.p.z, half.z, 1e-3);
    EXPECT_NEAR(same.X.p.z, box.X.p.z, 2e-4);
    EXPECT_LT(norm(same.v) + 0.05 * norm(same.w), 2e-3);
    EXPECT_GT(rotate(same.X.q, {0, 0, 1}).z, 0.9999);
  }
}

TEST_P(Solids, HullsStandOnEachOther) {
  const Hull of = block_hull({0.04, 0.04, 0.02}, {0.03, 0.03, 0.02});
  SceneDef def;
  const int high = GetParam() == EngineKind::kOde ? 2 : 4;  // eight sweeps of QuickStep hold no more
  double z = 0;                                             // of the foot
  for (int i = 0; i < high; ++i, z += 0.04)
    def.bodies.push_back(hull(of, {{0.001 * i, 0, z + 0.02 + of.com.z}, {}}));
  def.statics.push_back(test::make_plane());
  test::Simulation sim(def, GetParam());
  for (int k = 0; k < 180; ++k) sim->step();
  for (int i = 0; i < high; ++i) {
    EXPECT_NEAR(sim->body(i).X.p.z, 0.04 * i + 0.02 + of.com.z, 3e-3) << i;
    EXPECT_NEAR(sim->body(i).X.p.x, 0.001 * i, 5e-3) << i;
    EXPECT_GT(rotate(sim->body(i).X.q, {0, 0, 1}).z, 0.998) << i;
  }
}

// On the fingers of a hand: capsules and boxes. Same bytes again; no heap.
TEST_P(Solids, FallOnAHandWithoutTheHeapAndTheSameTwice) {
  uint64_t hashes[2][2];
  for (int kind = 0; kind < 2; ++kind)
    for (uint64_t& hash : hashes[kind]) {
      test::TwoHands hands;
      hands.ball = false;
      SceneDef def = test::two_hands_def(hands);
      const Pose X = {{0, -0.36, 0.58}, axis_angle({1, 0, 0}, 1)};
      def.bodies.push_back(kind ? hull(block_hull({0.03, 0.02, 0.03}, {0.02, 0.02, 0.03}), X)
                                : ellipsoid({0.03, 0.03, 0.04}, X));
      test::Simulation sim(def, GetParam());
      const int64_t before = heap_count();
      int touched = 0;
      for (int k = 0; k < 60; ++k) {
        sim->step();
        touched += sim->num_contacts() > 0;
      }
      if (kHeapIsCounted) {
        EXPECT_EQ(heap_count(), before);
      }
      EXPECT_GT(touched, 10);
      EXPECT_LT(norm(sim->body(0).v), 5);
      hash = test::state_hash(*sim);
    }
  for (const auto& pair : hashes) EXPECT_EQ(pair[0], pair[1]);
}

INSTANTIATE_TEST_SUITE_P(Engines, Solids, testing::Values(EngineKind::kOde, EngineKind::kArticulated),
                         [](const auto& info) {
                           return info.param == EngineKind::kOde ? "ode" : "articulated";
                         });

}  // namespace
}  // namespace rdm

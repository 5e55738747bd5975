// Heavy on light and light on heavy: what stands on what, for ten seconds, at the steps that scenes come with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "articulated.hpp"
#include "physics/articulated/stepper.hpp"
#include "quality_towers.hpp"

namespace rdm {
namespace {

constexpr double kHalf = 0.05;  // m, of a cube

// Cubes of these masses, kg, one upon the other; the last is `top` m to a side.
SceneDef column(const std::vector<double>& masses, double top = 2 * kHalf) {
  SceneDef def;
  double z = 0;
  for (size_t i = 0; i < masses.size(); ++i) {
    const double half = i + 1 < masses.size() ? kHalf : 0.5 * top;
    def.bodies.push_back(test::make_box(masses[i], {half, half, half}, {{0, 0, z + half}, {}}));
    z += 2 * half;
  }
  def.statics.push_back(test::make_plane());
  def.friction[0][0].mu = 0.5;
  def.solver.contacts_max = 256;
  return def;
}

struct Standing {
  double sinks = 0, aside = 0;  // m, of the highest; of any
  double speed = 0;             // m/s, largest of the last five seconds
  bool unsolved = false;
};
Standing stand(const SceneDef& def) {
  test::Simulation sim(def, EngineKind::kArticulated);
  const int32_t top = sim.scene().num_bodies - 1;
  const double before = sim->body(top).X.p.z;
  Standing out;
  for (int k = 0; k < 600; ++k) {
    sim->step();
    out.unsolved |= (sim->status() & kStatusUnconverged) != 0;
    for (int32_t i = 0; i <= top; ++i) {
      const Motion& m = sim->body(i);
      out.aside = std::max(out.aside, std::hypot(m.X.p.x, m.X.p.y));
      if (k >= 300) out.speed = std::max(out.speed, norm(m.v));
    }
  }
  out.sinks = before - sim->body(top).X.p.z;
  return out;
}

class MassRatio : public testing::TestWithParam<double> {};

// Each of the two contacts gives way by the layer and a tenth of it.
TEST_P(MassRatio, StandsHeavyOnLight) {
  const Standing s = stand(column({1, GetParam()}));
  EXPECT_FALSE(s.unsolved);
  EXPECT_LT(s.sinks, 1.5e-3);
  EXPECT_LT(s.aside, 1e-3);
  EXPECT_LT(s.speed, 1e-3);
}
TEST_P(MassRatio, StandsLightOnHeavy) {
  const Standing s = stand(column({GetParam(), 1}));
  EXPECT_FALSE(s.unsolved);
  EXPECT_LT(s.sinks, 2e-3);
  EXPECT_LT(s.aside, 1e-3);
  EXPECT_LT(s.speed, 1e-3);
}
INSTANTIATE_TEST_SUITE_P(To, MassRatio, testing::Values(10.0, 100.0, 1000.0));

TEST(MassRatios, AWiderTonStandsOnACube) {
  const Standing s = stand(column({1, 1000}, 0.5));
  EXPECT_LT(s.sinks, 1.5e-3);
  EXPECT_LT(s.aside, 1e-3);
}

TEST(MassRatios, ColumnsStandUnderATon) {
  for (const size_t cubes : {5u, 10u})
    for (const double top : {0.1, 0.5}) {
      std::vector<double> masses(cubes, 1.0);
      masses.push_back(1000);
      const Standing s = stand(column(masses, top));
      EXPECT_FALSE(s.unsolved) << cubes << " " << top;
      EXPECT_LT(s.sinks, 0.7e-3 * static_cast<double>(cubes + 1)) << cubes << " " << top;
      EXPECT_LT(s.aside, 1e-3) << cubes << " " << top;
      EXPECT_LT(s.speed, 5e-3) << cubes << " " << top;
    }
}

// Ten to one at every contact, a thousand to one in all.
TEST(MassRatios, AStackThatGetsHeavierUpwardsStands) {
  const Standing s = stand(column({1, 10, 100, 1000}));
  EXPECT_FALSE(s.unsolved);
  EXPECT_LT(s.sinks, 3e-3);
  EXPECT_LT(s.aside, 1e-3);
}

// Points that carry much are made stiffer: it is as deep as kMostYield says, the layer and 0.83 mm.
TEST(MassRatios, NothingIsTooHeavyForAPoint) {
  for (const double mass : {200.0, 1000.0, 10000.0, 1e5}) {
    const Standing s = stand(column({mass}, 1));
    EXPECT_FALSE(s.unsolved) << mass;
    EXPECT_LT(s.sinks, 1.4e-3) << mass;
    EXPECT_LT(s.speed, 1e-6) << mass;
  }
}

// The weight arrives at the ground.
TEST(MassRatios, ForcesAreTheWeights) {
  test::Simulation sim(column({1, 1, 1000}), EngineKind::kArticulated);
  for (int k = 0; k < 300; ++k) sim->step();
  double up = 0;
  for (int32_t i = 0; i < sim->num_contacts(); ++i) {
    const Contact& c = sim->contacts()[i];
    if (sim.scene().shapes[static_cast<size_t>(c.shape_b)].carrier == Carrier::kStatic) up += c.force.z;
  }
  EXPECT_NEAR(up / (1002 * 9.81), 1, 1e-5);
}

// Friction holds and slides as it does without a ton: a sheet of 1 kg under one of 1000 kg on slopes of 0.9 and
// 1.2 times mu.
TEST(MassRatios, AHeavyPairSlidesFromTheSameSlopeOn) {
  const double mu = 0.5, seconds = 0.5;
  const Vec3 half = {0.1, 0.1, 0.02};
  for (const double share : {0.9, 1.2}) {
    const double angle = std::atan(mu * share);
    const Quat q_WP = axis_angle({0, 1, 0}, angle);
    SceneDef def;
    for (int i = 0; i < 2; ++i)
      def.bodies.push_back(
          test::make_box(i ? 1000 : 1, half, {rotate(q_WP, {0, 0, half.z * (2 * i + 1)}), q_WP}));
    def.statics.push_back(test::make_plane(q_WP));
    def.friction[0][0].mu = mu;
    test::Simulation sim(def, EngineKind::kArticulated);
    const Vec3 along = rotate(q_WP, {1, 0, 0});
    for (int k = 0; k < 30; ++k) sim->step();
    const double before = dot(sim->body(1).v, along);
    for (int k = 0; k < 30; ++k) sim->step();
    const double gained = dot(sim->body(1).v, along) - before;
    const double exact = share < 1 ? 0 : 9.81 * (std::sin(angle) - mu * std::cos(angle)) * seconds;
    EXPECT_NEAR(gained, exact, 1e-3 + 0.02 * exact) << share;
    EXPECT_TRUE(share > 1 || std::fabs(before) < 1e-4) << before;
  }
}

// A stack's bytes are the same for all numbers of lanes.
TEST(MassRatios, GiveTheSameBytesInAllLanes) {
  Vec3 places[4];
  const int32_t lanes[4] = {1, 4, 8, 16};
  for (int k = 0; k < 4; ++k) {
    SceneDef def = column({1, 1, 1, 1000});
    def.solver.lanes = lanes[k];
    test::Simulation sim(def, EngineKind::kArticulated);
    for (int i = 0; i < 60; ++i) sim->step();
    places[k] = sim->body(3).X.p;
  }
  for (int k = 1; k < 4; ++k)
    for (int r = 0; r < 3; ++r) EXPECT_EQ(places[k][r], places[0][r]) << lanes[k];
}

}  // namespace
}  // namespace rdm

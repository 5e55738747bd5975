// Things of a millimetre rest at their place: what contacts leave alone is in proportion to what touches.
#include <gtest/gtest.h>

#include <cmath>

#include "articulated.hpp"
#include "quality_bodies.hpp"

namespace rdm {
namespace {

constexpr double kThin = 0.0005;  // m, half of a millimetre

SceneDef lay(const Vec3& half, double start, const ShapeDef& ground, double yaw) {
  SceneDef def;
  def.bodies.push_back(test::make_box(2700 * 8 * half.x * half.y * half.z, half,
                                      {{0, 0, half.z + start}, axis_angle({0, 0, 1}, yaw)}));
  def.statics.push_back(ground);
  def.friction[0][0].mu = 0.5;
  return def;
}

ShapeDef slab(double half) {
  ShapeDef out;
  out.kind = ShapeKind::kBox;
  out.size = {0.1, 0.1, half};
  out.X_LS.p = {0, 0, -half};
  return out;
}

// On a plane, a slab of 2 cm and a plate of 1 mm, laid to it, above or into it; 5 s.
void expect_rest(const Vec3& half) {
  const double layer = kLayerShare * kThin;
  for (const ShapeDef& ground : {test::make_plane(), slab(0.01), slab(kThin)})
    for (const double start : {0.0, 1e-4, -layer})
      for (const double yaw : {0.0, 0.3}) {
        test::Simulation sim(lay(half, start, ground, yaw), EngineKind::kArticulated);
        double speed = 0;
        for (int k = 0; k < 300; ++k) {
          sim->step();
          if (k >= 60) speed = std::max(speed, norm(sim->body(0).v));
        }
        const Vec3 p = sim->body(0).X.p;
        EXPECT_NEAR(p.z - half.z, -layer, 1e-6) << half.x << " " << start << " " << yaw;
        EXPECT_LT(std::hypot(p.x, p.y), 1e-5) << half.x << " " << start << " " << yaw;
        EXPECT_LT(speed, 1e-5) << half.x << " " << start << " " << yaw;
      }
}
TEST(ThinThings, ACubeOfAMillimetreRests) {
  expect_rest({kThin, kThin, kThin});
}
TEST(ThinThings, ASheetOfAMillimetreRests) {
  expect_rest({0.05, 0.05, kThin});
}

TEST(ThinThings, TheLayerIsOfTheThinnerShape) {
  SceneDef def = lay({0.05, 0.05, 0.05}, 0, slab(0.002), 0);
  ShapeDef& shape = def.bodies[0].shapes[0];
  const auto layer = [&] { return make_scene(def).pairs[0].layer; };
  EXPECT_DOUBLE_EQ(layer(), 1e-4);
  def.statics[0] = test::make_plane();
  EXPECT_DOUBLE_EQ(layer(), def.solver.contact_layer);
  shape.kind = ShapeKind::kCylinder;
  shape.size = {0.05, 0.001, 0};
  EXPECT_DOUBLE_EQ(layer(), 5e-5);
  shape.kind = ShapeKind::kCapsule;
  shape.size = {0.004, 0.1, 0};
  EXPECT_DOUBLE_EQ(layer(), 2e-4);
  shape.kind = ShapeKind::kHull;  // a wedge, 4 mm high
  shape.points = {{-0.05, -0.05, 0}, {0.05, -0.05, 0},  {-0.05, 0.05, 0},
                  {0.05, 0.05, 0},   {0, -0.05, 0.004}, {0, 0.05, 0.004}};
  EXPECT_DOUBLE_EQ(layer(), 1e-4);
}

// Wherever it began, what rests is as deep: no point of a face hangs in the air.
TEST(ThinThings, AllThatRestsLiesEquallyDeep) {
  for (const double start : {0.0, -1e-4, -3e-4, -5e-4, 2e-4}) {
    test::Simulation sim(lay({0.05, 0.05, 0.05}, start, test::make_plane(), 0), EngineKind::kArticulated);
    for (int k = 0; k < 120; ++k) sim->step();
    const double sag = sim->body(0).X.p.z - 0.05;
    EXPECT_NEAR(sag, -5.3e-4, 0.4e-4) << start;  // 2.7 kg
  }
}

}  // namespace
}  // namespace rdm

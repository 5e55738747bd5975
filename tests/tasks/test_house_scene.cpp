#include <gtest/gtest.h>

#include "tasks/props/house_scene.hpp"

namespace rdm {
namespace {

constexpr HouseMaterials kMaterials = {1, 2, 3, 4, 5};

SceneDef house(double sink = 0) {
  SceneDef s;
  s.num_materials = 6;
  HouseDef def;
  def.sink = sink;
  add_house(def, kMaterials, &s);
  return s;
}

// Lowest and highest point of a body's shapes, all of them upright or lying square, m.
double lowest(const BodyDef& b) {
  double z = 1e9;
  for (const ShapeDef& s : b.shapes) {
    const Vec3 up = rotate(conjugate(b.X_WB.q * s.X_LS.q), {0, 0, 1});
    const bool box = s.kind == ShapeKind::kBox;
    const double half = box ? std::abs(dot(up, s.size)) : std::abs(up.z) > 0.5 ? s.size.y : s.size.x;
    z = std::min(z, (b.X_WB * s.X_LS.p).z - half);
  }
  return z;
}

TEST(House, EverythingStandsOnTheFloor) {
  for (const double sink : {0.0, 0.0005})
    for (const BodyDef& b : house(sink).bodies) EXPECT_NEAR(lowest(b), -sink, 1e-12) << b.name.text;
}

TEST(House, BodiesTurnAboutTheirCentreOfMass) {
  const SceneDef s = house();
  ASSERT_EQ(s.bodies.size(), 3u);
  for (const BodyDef& b : s.bodies) EXPECT_EQ(norm(b.inertia.com), 0);
  const BodyDef& broom = s.bodies[kBroom];
  EXPECT_NEAR(broom.inertia.mass, 1.632, 1e-12);
  EXPECT_NEAR(norm(broom.X_WB * broom_middle() - Vec3{0, -0.5, 1.1}), 0, 1e-12);
  EXPECT_NEAR(norm(broom.X_WB * (broom_middle() + kRightHold) - Vec3{0, -0.5, 1.3}), 0, 1e-12);
  EXPECT_NEAR(norm(broom.X_WB * (broom_middle() + kLeftHold) - Vec3{0, -0.5, 1.6}), 0, 1e-12);
  // the head is at the foot of the handle, its edge the broom's bottom
  EXPECT_NEAR((broom.X_WB * broom.shapes[1].X_LS.p).z, 0.3, 1e-12);
  EXPECT_NEAR(s.bodies[kChair].inertia.mass, 4, 1e-12);
  EXPECT_NEAR(s.bodies[kTrash].inertia.mass, 0.06, 1e-12);
  EXPECT_NEAR(rotate(s.bodies[kTrash].X_WB.q, {0, 0, 1}).x, 1, 1e-12);
}

TEST(House, TheChairIsAsHighAndWideAsItsSource) {
  const BodyDef chair = house().bodies[kChair];
  double top = 0;
  for (const ShapeDef& s : chair.shapes)
    top = std::max(top, (chair.X_WB * s.X_LS.p).z + (s.kind == ShapeKind::kBox ? s.size.z : s.size.y));
  EXPECT_NEAR(top, 0.84, 1e-12);
  EXPECT_EQ(chair.shapes[0].size.x, 0.28);
}

TEST(House, TheBroomPassesTheDustpan) {
  const SceneDef s = house();
  EXPECT_TRUE(s.friction[kMaterials.head][kMaterials.pan].passes);
  EXPECT_TRUE(s.friction[kMaterials.pan][kMaterials.handle].passes);
  EXPECT_FALSE(s.friction[kMaterials.trash][kMaterials.pan].passes);
  EXPECT_EQ(s.statics.size(), 4u);
}

}  // namespace
}  // namespace rdm

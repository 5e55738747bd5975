#include <gtest/gtest.h>

#include "tasks/props/bottles.hpp"

namespace rdm {
namespace {

constexpr uint8_t kColor[3] = {1, 2, 3};

// 0.2752 m high in all, the body 79 mm thick up to the shoulder, the neck 32 mm.
TEST(Bottles, ABottleHasABodyAndANeck) {
  const BodyDef b = make_bottle("b", 0.06, 2, {0, 0, 1}, kColor);
  ASSERT_EQ(b.shapes.size(), 2u);
  const ShapeDef &body = b.shapes[0], &neck = b.shapes[1];
  EXPECT_NEAR(body.X_LS.p.z - body.size.y, -kBottleFoot, 1e-12);
  EXPECT_NEAR(body.X_LS.p.z + body.size.y, 0.08, 1e-12);
  EXPECT_NEAR(neck.X_LS.p.z - neck.size.y, 0.08, 1e-12);
  EXPECT_NEAR(neck.X_LS.p.z + neck.size.y, 0.1496, 1e-12);
  EXPECT_EQ(body.size.x, 0.0395);
  EXPECT_EQ(neck.size.x, 0.016);
  EXPECT_TRUE(neck.name == "b_neck");
  EXPECT_EQ(neck.material, 2);
  EXPECT_EQ(b.inertia.mass, 0.06);
  EXPECT_NEAR(b.inertia.moment[2], 0.5 * 0.06 * 0.0395 * 0.0395, 1e-12);
}

TEST(Bottles, TheyStandInARowOnTheTable) {
  EXPECT_NEAR(norm(bottle_place(1, 0) - Vec3{0, -0.8, 0.4626}), 0, 1e-12);
  EXPECT_NEAR(norm(bottle_place(5, 0.001) - Vec3{0, -0.4, 0.4616}), 0, 1e-12);
  SceneDef s;
  add_bottles(0.06, 0, false, 1, 2, 3, &s);
  ASSERT_EQ(s.bodies.size(), 5u);
  EXPECT_TRUE(s.bodies[0].name == "bottle_2");
  EXPECT_TRUE(s.bodies[1].name == "bottle_4");
  EXPECT_EQ(s.bodies[1].shapes[0].material, 1);
  EXPECT_EQ(s.bodies[2].shapes[0].material, 2);
  ASSERT_EQ(s.statics.size(), 1u);
  const ShapeDef& table = s.statics[0];
  EXPECT_NEAR(table.X_LS.p.z + table.size.z, 0.337, 1e-12);
  EXPECT_NEAR(table.X_LS.p.x - table.size.x, -0.234, 1e-12);
  EXPECT_NEAR(table.X_LS.p.y + table.size.y, -0.29, 1e-12);
}

TEST(Bottles, FixedOnesAreNoBodies) {
  SceneDef s;
  add_bottles(0.06, 0, true, 1, 2, 3, &s);
  EXPECT_EQ(s.bodies.size(), 2u);
  ASSERT_EQ(s.statics.size(), 7u);
  EXPECT_TRUE(s.statics[0].name == "bottle_1");
  EXPECT_NEAR(s.statics[1].X_LS.p.z, bottle_place(1, 0).z + 0.1148, 1e-12);
}

}  // namespace
}  // namespace rdm

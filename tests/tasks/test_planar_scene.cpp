#include <gtest/gtest.h>

#include "tasks/planar/planar_scene.hpp"

namespace rdm {
namespace {

TEST(PlanarScene, NumbersBodiesAndLeavesMarksAtRest) {
  const Scene s = PlanarScene(1)
                      .body("a", ShapeKind::kSphere, {0.1, 0, 0}, kMarkBlue)
                      .shape("nose", ShapeKind::kBox, {0.1, 0.1, 0.1}, kMarkRed)
                      .body("b", ShapeKind::kSphere, {0.2, 0, 0}, kMarkGreen)
                      .disc("goal", 0.3, kMarkGreen, 1, 2)
                      .wall("wall", kMarkGrey, -1, 3, 5, 3)
                      .build();
  EXPECT_EQ(s.num_bodies, 2);
  EXPECT_EQ(s.control_dt(), 1);
  EXPECT_TRUE(s.pairs.empty());
  EXPECT_EQ(s.shapes[static_cast<size_t>(s.find_shape("nose"))].index, 0);
  EXPECT_EQ(s.shapes[static_cast<size_t>(s.find_shape("b"))].index, 1);
  const SceneShape& wall = s.shapes[static_cast<size_t>(s.find_shape("wall"))];
  EXPECT_EQ(wall.carrier, Carrier::kStatic);
  EXPECT_EQ(wall.def.X_LS.p.x, 2);
  EXPECT_EQ(wall.def.X_LS.p.y, 3);
  EXPECT_EQ(wall.def.size.x, 3);
  EXPECT_LT(wall.def.size.y, 0.1);
}

TEST(PlanarScene, ControlStepsOfAnyLength) {
  for (const double dt : {0.002, 1.0 / 60, 0.04, 0.1, 1.0})
    EXPECT_DOUBLE_EQ(PlanarScene(dt).body("a", ShapeKind::kSphere, {1, 0, 0}, kMarkBlue).build().control_dt(),
                     dt);
}

TEST(PlanarScene, PlanarMotionTurnsAboutZ) {
  const Motion m = planar_motion({1, 2, 3}, 1.5707963267948966, 4, 5, 6);
  const Vec3 ahead = rotate(m.X.q, {1, 0, 0});
  EXPECT_NEAR(ahead.y, 1, 1e-15);
  EXPECT_EQ(m.v.y, 5);
  EXPECT_EQ(m.w.z, 6);
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include <cmath>

#include "physics/collision/shapes.hpp"
#include "physics/ode_library/ode_convert.hpp"
#include "physics/ode_library/ode_guard.hpp"

namespace rdm {
namespace {

ShapeDef shape_of(ShapeKind kind, const Vec3& size) {
  ShapeDef shape;
  shape.kind = kind;
  shape.size = size;
  return shape;
}

class GeomTest : public testing::Test {
 protected:
  ~GeomTest() override {
    for (const Geom& geom : made_) dGeomDestroy(geom.id);
  }
  const Geom& make(ShapeKind kind, const Vec3& size, const Pose& X) {
    made_.push_back(make_geom(shape_of(kind, size), nullptr, X));
    return made_.back();
  }

 private:
  OdeGuard guard_;
  OdeScope scope_;
  std::vector<Geom> made_ = [] {
    std::vector<Geom> room;
    room.reserve(16);  // references stay good
    return room;
  }();
};

// Half of the box around it, in world axes.
Vec3 extent(const Geom& geom) {
  dReal box[6];
  dGeomGetAABB(geom.id, box);
  return {0.5 * (box[1] - box[0]), 0.5 * (box[3] - box[2]), 0.5 * (box[5] - box[4])};
}

TEST_F(GeomTest, EveryKindIsOfItsSizeAtItsPlace) {
  // a quarter turn about x: z comes to lie along -y
  const Pose X = {{1, 2, 3}, axis_angle({1, 0, 0}, std::acos(0.0))};
  struct Row {
    ShapeKind kind;
    Vec3 size;
    int ode;
    Vec3 extent;
  };
  const Row rows[] = {{ShapeKind::kSphere, {0.2, 0, 0}, dSphereClass, {0.2, 0.2, 0.2}},
                      {ShapeKind::kCapsule, {0.1, 0.3, 0}, dCapsuleClass, {0.1, 0.4, 0.1}},
                      {ShapeKind::kBox, {0.1, 0.2, 0.3}, dBoxClass, {0.1, 0.3, 0.2}},
                      {ShapeKind::kCylinder, {0.1, 0.3, 0}, dCylinderClass, {0.1, 0.3, 0.1}}};
  for (const Row& row : rows) {
    const Geom& geom = make(row.kind, row.size, X);
    EXPECT_EQ(dGeomGetClass(geom.id), row.ode);
    EXPECT_EQ(geom.kind, row.kind);
    EXPECT_EQ(norm(geom.size - row.size), 0);
    EXPECT_EQ(dGeomGetSpace(geom.id), nullptr);
    EXPECT_LT(norm(from_ode(dGeomGetPosition(geom.id)) - X.p), 1e-15);
    EXPECT_LT(norm(mat_from_ode(dGeomGetRotation(geom.id)) * Vec3{0, 0, 1} - Vec3{0, -1, 0}), 1e-15);
    EXPECT_LT(norm(extent(geom) - row.extent), 1e-12) << row.ode;
  }
}

TEST_F(GeomTest, APlaneIsTheHalfSpaceBelowItsFrame) {
  const Pose X = {{1, 2, 3}, axis_angle({0, 1, 0}, std::acos(0.0))};  // z comes to lie along x
  const Geom& plane = make(ShapeKind::kPlane, {}, X);
  EXPECT_EQ(dGeomGetClass(plane.id), dPlaneClass);
  EXPECT_LT(norm(plane.plane_n - Vec3{1, 0, 0}), 1e-15);
  EXPECT_NEAR(plane.plane_d, 1, 1e-15);
  const Geom& ball = make(ShapeKind::kSphere, {0.1, 0, 0}, {{1.08, 5, 5}, {}});
  dContactGeom out[kMaxPairPoints];
  ASSERT_EQ(collide_geoms(ball, plane, kMaxPairPoints, out), 1);
  EXPECT_NEAR(out[0].depth, 0.02, 1e-12);
  EXPECT_LT(norm(from_ode(out[0].normal) - Vec3{1, 0, 0}), 1e-12);  // from the plane into the ball
}

constexpr double kRadius = 0.04, kHalf = 0.09, kDepth = 1e-3;

void expect_rim(const dContactGeom* points, int count, const Vec3& into_first) {
  ASSERT_EQ(count, 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(points[i].depth, kDepth, 1e-12);
    EXPECT_NEAR(std::hypot(points[i].pos[0], points[i].pos[1]), kRadius, 1e-12);
    EXPECT_LT(norm(from_ode(points[i].normal) - into_first), 1e-12);
    for (int j = 0; j < i; ++j)
      EXPECT_GT(norm(from_ode(points[i].pos) - from_ode(points[j].pos)), kRadius) << i << j;
  }
}

TEST_F(GeomTest, ACylinderStandsOnFourPointsOfItsRim) {
  dContactGeom out[kMaxPairPoints];
  const Geom& cylinder = make(ShapeKind::kCylinder, {kRadius, kHalf, 0}, {{0, 0, kHalf - kDepth}, {}});
  const Geom& plane = make(ShapeKind::kPlane, {}, {});
  const Geom& table = make(ShapeKind::kBox, {0.2, 0.3, 0.1}, {{0, 0, -0.1}, {}});
  for (const Geom* ground : {&plane, &table}) {
    expect_rim(out, collide_geoms(cylinder, *ground, kMaxPairPoints, out), {0, 0, 1});
    expect_rim(out, collide_geoms(*ground, cylinder, kMaxPairPoints, out), {0, 0, -1});
    EXPECT_EQ(collide_geoms(cylinder, *ground, 2, out), 2);
  }
}

TEST_F(GeomTest, ACylinderThatIsOffTouchesNothing) {
  dContactGeom out[kMaxPairPoints];
  const Geom& cylinder = make(ShapeKind::kCylinder, {kRadius, kHalf, 0}, {{0, 0, kHalf + 1e-6}, {}});
  const Geom& plane = make(ShapeKind::kPlane, {}, {});
  EXPECT_EQ(collide_geoms(cylinder, plane, kMaxPairPoints, out), 0);
}

TEST_F(GeomTest, ACylinderTouchesEveryKind) {
  dContactGeom out[kMaxPairPoints];
  const Geom& cylinder = make(ShapeKind::kCylinder, {kRadius, kHalf, 0}, {{0, 0, kHalf - kDepth}, {}});
  const Geom* below[] = {&make(ShapeKind::kSphere, {0.1, 0, 0}, {{0, 0, -0.1}, {}}),
                         &make(ShapeKind::kCapsule, {0.1, 0.2, 0}, {{0, 0, -0.3}, {}}),
                         &make(ShapeKind::kCylinder, {0.1, 0.2, 0}, {{0, 0, -0.2}, {}}),
                         &make(ShapeKind::kBox, {0.1, 0.1, 0.1}, {{0, 0, -0.1}, {}})};
  for (const Geom* geom : below)
    for (const bool first : {true, false}) {
      const int count = first ? collide_geoms(cylinder, *geom, kMaxPairPoints, out)
                              : collide_geoms(*geom, cylinder, kMaxPairPoints, out);
      ASSERT_GE(count, 1);
      EXPECT_NEAR(out[0].depth, kDepth, 1e-6);
      EXPECT_LT(norm(from_ode(out[0].normal) - Vec3{0, 0, first ? 1.0 : -1.0}), 1e-3);
      EXPECT_EQ(out[0].g1, first ? cylinder.id : geom->id);
    }
}

// Asked for fewer points of two boxes, the deepest and far ones stay.
TEST_F(GeomTest, FewerPointsAreSpread) {
  dContactGeom out[kMaxPairPoints];
  const Geom& table = make(ShapeKind::kBox, {1, 1, 0.1}, {{0, 0, -0.1}, {}});
  const Geom& slab =
      make(ShapeKind::kBox, {1, 1, 0.05},
           {{0, 0, 0.0495}, axis_angle({0, 0, 1}, std::atan(1.0)) * axis_angle({0, 1, 0}, 1e-4)});
  const int all = collide_geoms(slab, table, kMaxPairPoints, out);
  ASSERT_EQ(all, 8);
  double deepest = 0;
  for (int i = 0; i < all; ++i) deepest = std::max(deepest, static_cast<double>(out[i].depth));
  ASSERT_EQ(collide_geoms(slab, table, 4, out), 4);
  EXPECT_EQ(out[0].depth, deepest);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) EXPECT_GT(norm(from_ode(out[i].pos) - from_ode(out[j].pos)), 0.8) << i << j;
}

}  // namespace
}  // namespace rdm

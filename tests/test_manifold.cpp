#include <gtest/gtest.h>

#include <cmath>

#include "physics/manifold.hpp"

namespace rdm {
namespace {

constexpr double kRadius = 0.04, kHalf = 0.09;

Face ground() {
  Face face;
  face.n = {0, 0, 1};
  return face;
}

Cylinder cylinder(const Vec3& p, const Quat& q) {
  return {p, to_matrix(q), kRadius, kHalf};
}

TEST(Manifold, StandsOnFourRimPoints) {
  for (const bool head_down : {false, true}) {
    ManifoldPoint points[kManifoldPoints];
    const Quat q = head_down ? axis_angle({1, 0, 0}, std::acos(-1.0)) : Quat{};
    ASSERT_EQ(cylinder_on_face(cylinder({1, 2, kHalf - 1e-3}, q), ground(), points), 4);
    Vec3 mean;
    for (const ManifoldPoint& point : points) {
      EXPECT_NEAR(point.depth, 1e-3, 1e-12);
      EXPECT_NEAR(std::hypot(point.p.x - 1, point.p.y - 2), kRadius, 1e-12);
      mean += 0.25 * point.p;
    }
    EXPECT_NEAR(norm(mean - Vec3{1, 2, -1e-3}), 0, 1e-12);
  }
}

TEST(Manifold, TiltedItsLowestPointIsFound) {
  for (const double angle : {0.005, 0.1, 0.4}) {
    const double low = kHalf * std::cos(angle) + kRadius * std::sin(angle);  // of the rim below the centre
    ManifoldPoint points[kManifoldPoints];
    const Quat q = axis_angle(normalized(Vec3{1, 2, 0}), angle);
    ASSERT_GE(cylinder_on_face(cylinder({0, 0, low - 1e-4}, q), ground(), points), 1);
    EXPECT_NEAR(points[0].depth, 1e-4, 1e-12) << angle;
  }
}

TEST(Manifold, LiesOnTheEndsOfItsLowestLine) {
  const Quat q = axis_angle({0, 1, 0}, std::acos(0.0));  // axis along x
  ManifoldPoint points[kManifoldPoints];
  ASSERT_EQ(cylinder_on_face(cylinder({0, 0, kRadius - 1e-3}, q), ground(), points), 2);
  EXPECT_NEAR(std::fabs(points[0].p.x - points[1].p.x), 2 * kHalf, 1e-12);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(points[i].depth, 1e-3, 1e-12);
}

TEST(Manifold, KeepsToTheFace) {
  const double half[2] = {0.5, 0.1};
  Face table = ground();
  table.side[0] = {1, 0, 0};
  table.side[1] = {0, 1, 0};
  table.half = half;
  ManifoldPoint points[kManifoldPoints];
  EXPECT_EQ(cylinder_on_face(cylinder({0, 0, kHalf - 1e-3}, {}), table, points), 4);
  EXPECT_EQ(cylinder_on_face(cylinder({0, 0.08, kHalf - 1e-3}, {}), table, points), -1);  // over the edge
  // Lying across the table it rests on the line's part above it.
  const Quat across = axis_angle({1, 0, 0}, std::acos(0.0));
  ASSERT_EQ(cylinder_on_face(cylinder({0, 0.05, kRadius - 1e-3}, across), table, points), 2);
  EXPECT_NEAR(std::max(points[0].p.y, points[1].p.y), 0.1, 1e-12);
  EXPECT_NEAR(std::min(points[0].p.y, points[1].p.y), 0.05 - kHalf, 1e-12);
  EXPECT_EQ(cylinder_on_face(cylinder({0.6, 0, kRadius - 1e-3}, across), table, points), -1);
}

TEST(Manifold, LeavesSlantedOnesToTheCollider) {
  ManifoldPoint points[kManifoldPoints];
  EXPECT_EQ(cylinder_on_face(cylinder({0, 0, 0.05}, axis_angle({1, 0, 0}, 0.8)), ground(), points), -1);
}

TEST(Manifold, NothingAboveTheFace) {
  ManifoldPoint points[kManifoldPoints];
  EXPECT_EQ(cylinder_on_face(cylinder({0, 0, kHalf + 1e-3}, {}), ground(), points), 0);
}

}  // namespace
}  // namespace rdm

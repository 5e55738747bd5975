#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.hpp"
#include "hulls.hpp"
#include "physics/collision/manifold.hpp"

namespace rdm {
namespace {

constexpr double kRadius = 0.04, kHalf = 0.09;
constexpr Vec3 kUp = {0, 0, 1};

Convex solid(ShapeKind kind, const Vec3& size, const Vec3& p, const Quat& q = {}) {
  return {kind, size, p, to_matrix(q)};
}
Convex cylinder(const Vec3& p, const Quat& q = {}) {
  return solid(ShapeKind::kCylinder, {kRadius, kHalf, 0}, p, q);
}
Quat lying(const Vec3& about) {
  return axis_angle(about, kPi / 2);
}

struct Points {
  ManifoldPoint at[kManifoldPoints];
  int count;
  Points(const Convex& a, const Convex& b) : count(manifold_between(a, b, at)) {}
  explicit Points(const Convex& a) : count(manifold_on_plane(a, kUp, 0, at)) {}
  Vec3 mean() const {
    Vec3 m;
    for (int i = 0; i < count; ++i) m += (1.0 / count) * at[i].p;
    return m;
  }
};

TEST(Manifold, ACylinderStandsOnFourRimPoints) {
  const Convex table = solid(ShapeKind::kBox, {0.5, 0.4, 0.1}, {0.8, 1.9, -0.1});
  for (const bool head_down : {false, true})
    for (const bool on_table : {false, true}) {
      const Convex c = cylinder({1, 2, kHalf - 1e-3}, head_down ? axis_angle({1, 0, 0}, kPi) : Quat{});
      const Points m = on_table ? Points(c, table) : Points(c);
      ASSERT_EQ(m.count, 4);
      for (const ManifoldPoint& point : m.at) {
        EXPECT_NEAR(point.depth, 1e-3, 1e-12);
        EXPECT_LT(norm(point.n - kUp), 1e-12);
        EXPECT_NEAR(std::hypot(point.p.x - 1, point.p.y - 2), kRadius, 1e-12);
      }
      EXPECT_NEAR(norm(m.mean() - Vec3{1, 2, -1e-3}), 0, 1e-12);
      if (!on_table) continue;
      const Points turned(table, c);
      ASSERT_EQ(turned.count, 4);
      EXPECT_LT(norm(turned.at[0].n + kUp), 1e-12);
    }
}

TEST(Manifold, TiltedItsLowestPointIsFound) {
  for (const double angle : {0.005, 0.1, 0.4, 0.8, 1.2, 1.5}) {
    const double low = kHalf * std::cos(angle) + kRadius * std::sin(angle);  // of the rim below the centre
    const Points m(cylinder({0, 0, low - 1e-4}, axis_angle(normalized(Vec3{1, 2, 0}), angle)));
    ASSERT_GE(m.count, 1);
    EXPECT_NEAR(m.at[0].depth, 1e-4, 1e-12) << angle;
  }
}

TEST(Manifold, LiesOnTheEndsOfItsLowestLine) {
  const Points m(cylinder({0, 0, kRadius - 1e-3}, lying({0, 1, 0})));
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR(std::fabs(m.at[0].p.x - m.at[1].p.x), 2 * kHalf, 1e-12);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.at[i].depth, 1e-3, 1e-12);
}

TEST(Manifold, KeepsToTheFace) {
  const Convex table = solid(ShapeKind::kBox, {0.5, 0.1, 0.05}, {0, 0, -0.05});
  // half over the edge: what is above the table carries
  const Points foot(cylinder({0, 0.09, kHalf - 1e-3}), table);
  ASSERT_GE(foot.count, 3);
  for (int i = 0; i < foot.count; ++i) EXPECT_LE(foot.at[i].p.y, 0.1 + 1e-12);
  const Points across(cylinder({0, 0.05, kRadius - 1e-3}, lying({1, 0, 0})), table);
  ASSERT_EQ(across.count, 2);
  EXPECT_NEAR(std::max(across.at[0].p.y, across.at[1].p.y), 0.1, 1e-12);
  EXPECT_NEAR(std::min(across.at[0].p.y, across.at[1].p.y), 0.05 - kHalf, 1e-12);
  EXPECT_EQ(Points(cylinder({0.6, 0, kRadius - 1e-3}, lying({1, 0, 0})), table).count, 0);
}

TEST(Manifold, NothingWhereTheyAreApart) {
  EXPECT_EQ(Points(cylinder({0, 0, kHalf + 1e-6})).count, 0);
  const Convex box = solid(ShapeKind::kBox, {0.1, 0.1, 0.1}, {0, 0, -0.1 - 1e-5});
  EXPECT_EQ(Points(cylinder({0, 0, kHalf}), box).count, 0);
  EXPECT_EQ(Points(cylinder({}), cylinder({2 * kRadius + 1e-6, 0, 0.01})).count, 0);
  EXPECT_EQ(Points(cylinder({}), cylinder({0, 0, 2 * kHalf + 1e-5})).count, 0);
}

TEST(Manifold, TwoCylindersSideBySideTouchAlongALine) {
  const Points m(cylinder({2 * kRadius - 1e-3, 0, 0.05}), cylinder({}));
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR(std::min(m.at[0].p.z, m.at[1].p.z), 0.05 - kHalf, 1e-12);
  EXPECT_NEAR(std::max(m.at[0].p.z, m.at[1].p.z), kHalf, 1e-12);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(m.at[i].depth, 1e-3, 1e-12);
    EXPECT_LT(norm(m.at[i].n - Vec3{1, 0, 0}), 1e-12);
    EXPECT_NEAR(m.at[i].p.x, kRadius - 0.5e-3, 1e-12);
  }
}

TEST(Manifold, CrossedSidesTouchAtOnePoint) {
  const Convex finger =
      solid(ShapeKind::kCapsule, {0.01, 0.03, 0}, {kRadius + 0.01 - 1e-3, 0.01, 0.02}, lying({1, 0, 0}));
  const Points m(finger, cylinder({}));
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.at[0].depth, 1e-3, 1e-12);
  EXPECT_LT(norm(m.at[0].n - Vec3{1, 0, 0}), 1e-12);
  EXPECT_LT(norm(m.at[0].p - Vec3{kRadius - 0.5e-3, 0, 0.02}), 1e-12);
}

TEST(Manifold, OneCylinderStandsOnAnother) {
  const Points m(cylinder({0.01, 0, 2 * kHalf - 1e-3}), cylinder({}));
  ASSERT_EQ(m.count, 4);
  for (const ManifoldPoint& point : m.at) {
    EXPECT_NEAR(point.depth, 1e-3, 1e-9);
    EXPECT_LT(norm(point.n - kUp), 1e-9);
  }
  EXPECT_LT(norm(m.mean() - Vec3{0.005, 0, kHalf}), 0.01);
}

TEST(Manifold, AFingersTipOnACap) {
  // the capsule stands on the cap and touches with its round end
  const Points m(solid(ShapeKind::kCapsule, {0.01, 0.03, 0}, {0.02, 0, kHalf + 0.04 - 1e-3}), cylinder({}));
  ASSERT_GE(m.count, 1);
  EXPECT_NEAR(m.at[0].depth, 1e-3, 1e-6);
  EXPECT_LT(norm(m.at[0].n - kUp), 1e-6);
}

// Whatever the pose: moved apart by the deepest point's depth, along its normal, little is left of the
// overlap.
TEST(Manifold, TheDeepestPointTellsTheWayOut) {
  Stream stream(5, 0, Purpose::kTest);
  const auto direction = [&] {
    Vec3 d;
    for (int i = 0; i < 3; ++i) d[i] = stream.signed_unit();
    return normalized(d);
  };
  constexpr ShapeKind kKinds[] = {ShapeKind::kSphere, ShapeKind::kCapsule, ShapeKind::kBox,
                                  ShapeKind::kCylinder};
  int found = 0;
  for (int i = 0; i < 6000; ++i) {
    const ShapeKind kind = kKinds[stream.next() % 4];
    const Convex b = cylinder({}, axis_angle(direction(), 2));
    Convex a = solid(kind, {0.03, 0.04, 0.05}, 0.11 * direction(), axis_angle(direction(), 2));
    const Points m(a, b);
    if (m.count == 0 || m.at[0].depth > 0.003) continue;
    ++found;
    for (int k = 0; k < m.count; ++k) {
      EXPECT_NEAR(norm(m.at[k].n), 1, 1e-9);
      EXPECT_GT(m.at[k].depth, 0);
      EXPECT_LE(m.at[k].depth, m.at[0].depth);
    }
    a.p += (m.at[0].depth + 1e-9) * m.at[0].n;
    Overlap left;
    if (find_overlap(a, b, &left)) {
      EXPECT_LT(left.depth, 4e-4) << i << " of " << m.at[0].depth;
    }
  }
  EXPECT_GT(found, 200);
}

void expect_same_points(const Points& a, const Points& b) {
  ASSERT_EQ(a.count, b.count);
  for (int i = 0; i < a.count; ++i) {
    double nearest = HUGE_VAL;
    for (int k = 0; k < b.count; ++k)
      nearest = std::min(nearest, norm(a.at[i].p - b.at[k].p) + norm(a.at[i].n - b.at[k].n) +
                                      std::fabs(a.at[i].depth - b.at[k].depth));
    EXPECT_LT(nearest, 1e-9);
  }
}

TEST(Manifold, AHullOfABoxsCornersTouchesAsTheBox) {
  const Vec3 half = {0.05, 0.04, 0.03};
  const Hull& hull = kept_hull(half);
  const Convex table = solid(ShapeKind::kBox, {0.5, 0.5, 0.1}, {0.03, 0, -0.1});
  for (const double yaw : {0.0, 0.4, 1.2})
    for (const double tilt : {0.0, 0.005, 0.05}) {
      const Quat q = axis_angle({0, 0, 1}, yaw) * axis_angle({1, 0, 0}, tilt);
      const Convex box = solid(ShapeKind::kBox, half, {0.02, 0, half.z - 1e-3}, q);
      Convex same = box;
      same.kind = ShapeKind::kHull;
      same.hull = &hull;
      expect_same_points(Points(same, table), Points(box, table));
      if (tilt < 0.01) expect_same_points(Points(same), Points(box));
    }
}

TEST(Manifold, AHullStandsOnAllItsCornersBelowAPlane) {
  // on its edge along x: the two ends of it
  const Hull& hull = kept_hull({0.05, 0.03, 0.03});
  Convex c = solid(ShapeKind::kHull, half_box(hull), {0, 0, 0.03 * std::sqrt(2.0) - 1e-3},
                   axis_angle({1, 0, 0}, kPi / 4));
  c.hull = &hull;
  const Points edge(c);
  ASSERT_EQ(edge.count, 2);
  EXPECT_NEAR(std::fabs(edge.at[0].p.x - edge.at[1].p.x), 0.1, 1e-12);
  EXPECT_NEAR(edge.at[0].depth, 1e-3, 1e-12);
}

TEST(Manifold, AnEllipsoidTouchesAPlaneBelowItsLowestPoint) {
  const Vec3 half = {0.02, 0.03, 0.04};
  for (const double angle : {0.0, 0.3, 0.9, 1.5}) {
    const Quat q = axis_angle({1, 0, 0}, angle);
    // by the support function of the ellipse in the plane of the turn
    const double low = std::hypot(half.z * std::cos(angle), half.y * std::sin(angle));
    const double aside = std::sin(angle) * std::cos(angle) * (half.z * half.z - half.y * half.y) /
                         low;  // of the foot, along y
    const Points m(solid(ShapeKind::kEllipsoid, half, {0, 0, low - 1e-3}, q));
    ASSERT_EQ(m.count, 1);
    EXPECT_NEAR(m.at[0].depth, 1e-3, 1e-12);
    EXPECT_NEAR(m.at[0].p.x, 0, 1e-12);
    EXPECT_NEAR(std::fabs(m.at[0].p.y), std::fabs(aside), 1e-12);
  }
}

}  // namespace
}  // namespace rdm

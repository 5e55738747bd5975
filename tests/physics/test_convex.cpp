#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/rng.hpp"
#include "hulls.hpp"
#include "physics/collision/convex.hpp"

namespace rdm {
namespace {

Convex solid(ShapeKind kind, const Vec3& size, const Pose& X = {}) {
  return {kind, size, X.p, to_matrix(X.q), kind == ShapeKind::kHull ? &kept_hull(size) : nullptr};
}

Vec3 direction(Stream& stream) {
  Vec3 d;
  do {
    for (int i = 0; i < 3; ++i) d[i] = stream.signed_unit();
  } while (norm(d) > 1 || norm(d) < 0.1);
  return normalized(d);
}

// How far a solid reaches along a unit vector in its own frame, by its formula.
double reach(ShapeKind kind, const Vec3& s, const Vec3& d) {
  switch (kind) {
    case ShapeKind::kSphere:
      return s.x;
    case ShapeKind::kCapsule:
      return s.x + s.y * std::fabs(d.z);
    case ShapeKind::kCylinder:
      return s.x * std::hypot(d.x, d.y) + s.y * std::fabs(d.z);
    case ShapeKind::kEllipsoid:
      return norm({s.x * d.x, s.y * d.y, s.z * d.z});
    default:
      return s.x * std::fabs(d.x) + s.y * std::fabs(d.y) + s.z * std::fabs(d.z);
  }
}

constexpr ShapeKind kKinds[] = {ShapeKind::kSphere,   ShapeKind::kCapsule,   ShapeKind::kBox,
                                ShapeKind::kCylinder, ShapeKind::kEllipsoid, ShapeKind::kHull};
constexpr Vec3 kSize = {0.3, 0.2, 0.1};

TEST(Convex, ReachesAsItsFormulaSays) {
  Stream stream(1, 0, Purpose::kTest);
  for (const ShapeKind kind : kKinds)
    for (int i = 0; i < 50; ++i) {
      const Pose X = {direction(stream), axis_angle(direction(stream), 2)};
      const Vec3 d = direction(stream);
      const Vec3 p = farthest(solid(kind, kSize, X), 7 * d);
      EXPECT_NEAR(dot(d, p - X.p), reach(kind, kSize, rotate(conjugate(X.q), d)), 1e-12);
    }
}

TEST(Convex, ShowsPartsOfItsSurface) {
  Stream stream(2, 0, Purpose::kTest);
  for (const ShapeKind kind : kKinds)
    for (int i = 0; i < 50; ++i) {
      const Convex s = solid(kind, kSize, {direction(stream), axis_angle(direction(stream), 2)});
      const Vec3 n = direction(stream);
      const Feature f = shown(s, n);
      ASSERT_GE(f.count, 1);
      double best = -1e9;
      for (int k = 0; k < f.count; ++k) {
        // in no direction beyond the solid
        for (int t = 0; t < 20; ++t) {
          const Vec3 d = direction(stream);
          EXPECT_LE(dot(d, f.points[k] - farthest(s, d)), 1e-12);
        }
        best = std::max(best, dot(n, f.points[k]));
        if (f.count > 2) {
          EXPECT_NEAR(dot(f.n, f.points[k] - f.points[0]), 0, 1e-12);
        }
      }
      if (kind != ShapeKind::kBox && f.count != 8) {
        EXPECT_NEAR(best, dot(n, farthest(s, n)), 1e-12);
      }
      if (f.count > 2) {
        EXPECT_GT(dot(f.n, n), 0.57);
      }
    }
}

TEST(Convex, ATiltedCapBeginsAtItsLowestPoint) {
  const Convex c = solid(ShapeKind::kCylinder, kSize, {{}, axis_angle({1, 0, 0}, 0.3)});
  const Feature f = shown(c, {0, 0, -1});
  ASSERT_EQ(f.count, 8);
  EXPECT_NEAR(norm(f.points[0] - farthest(c, {0, 0, -1})), 0, 1e-12);
}

TEST(Convex, OverlapOfKnownPairs) {
  const Convex box = solid(ShapeKind::kBox, {1, 1, 0.5}, {{0.3, 0.2, -0.5}, {}});
  Overlap o;
  struct Row {
    ShapeKind kind;
    Vec3 size;
    double height;  // of the centre above the surface that it touches
  };
  for (const Row& row :
       {Row{ShapeKind::kSphere, {0.1, 0, 0}, 0.1}, Row{ShapeKind::kCapsule, {0.1, 0.2, 0}, 0.3},
        Row{ShapeKind::kCylinder, {0.1, 0.2, 0}, 0.2}, Row{ShapeKind::kBox, {0.1, 0.1, 0.2}, 0.2},
        Row{ShapeKind::kEllipsoid, {0.1, 0.05, 0.2}, 0.2}, Row{ShapeKind::kHull, {0.1, 0.1, 0.2}, 0.2}}) {
    ASSERT_TRUE(find_overlap(solid(row.kind, row.size, {{0, 0, row.height - 1e-3}, {}}), box, &o));
    EXPECT_NEAR(o.depth, 1e-3, 1e-6);
    EXPECT_LT(norm(o.n - Vec3{0, 0, 1}), 2e-3);
    ASSERT_TRUE(find_overlap(box, solid(row.kind, row.size, {{0, 0, row.height - 1e-3}, {}}), &o));
    EXPECT_LT(norm(o.n - Vec3{0, 0, -1}), 2e-3);
    EXPECT_FALSE(find_overlap(solid(row.kind, row.size, {{0, 0, row.height + 1e-5}, {}}), box, &o));
  }
}

// Moved apart by the depth that was found, along the normal, they only touch.
TEST(Convex, TheDepthTakesThemApart) {
  Stream stream(3, 0, Purpose::kTest);
  int found = 0;
  for (int i = 0; i < 4000; ++i) {
    const ShapeKind ka = kKinds[stream.next() % 6], kb = kKinds[stream.next() % 6];
    const Convex b = solid(kb, {0.05, 0.06, 0.04}, {{}, axis_angle(direction(stream), 2)});
    Convex a = solid(ka, {0.04, 0.05, 0.06}, {0.09 * direction(stream), axis_angle(direction(stream), 1)});
    Overlap o, rest;
    if (!find_overlap(a, b, &o) || o.depth > 0.003) continue;
    ++found;
    EXPECT_NEAR(norm(o.n), 1, 1e-9);
    Convex moved = a;
    moved.p += (o.depth + 2e-5) * o.n;
    EXPECT_FALSE(find_overlap(moved, b, &rest)) << i << " still " << rest.depth << " of " << o.depth;
    moved.p = a.p + 0.9 * o.depth * o.n;
    EXPECT_TRUE(find_overlap(moved, b, &rest) || o.depth < 1e-5);
  }
  EXPECT_GT(found, 100);
}

bool holds(const Convex& c, const Vec3& p) {
  const Vec3 x = transpose(c.R) * (p - c.p), &s = c.size;
  if (c.kind == ShapeKind::kBox)
    return std::fabs(x.x) <= s.x && std::fabs(x.y) <= s.y && std::fabs(x.z) <= s.z;
  if (c.kind == ShapeKind::kCylinder) return std::hypot(x.x, x.y) <= s.x && std::fabs(x.z) <= s.y;
  return norm(x - Vec3{0, 0, std::clamp(x.z, -s.y, s.y)}) <= s.x;
}

// Against brute force: no point of one that is shown apart lies in the other, and what any of many directions
// parts by a centimetre is nearly always shown apart. Where the two overlap, it is never shown.
TEST(Convex, ShownApartIsApart) {
  constexpr ShapeKind kWith[] = {ShapeKind::kBox, ShapeKind::kCylinder, ShapeKind::kCapsule};
  Stream stream(5, 0, Purpose::kTest);
  const auto size = [&] { return 0.02 + 0.1 * (1 + stream.signed_unit()); };
  int parted = 0, shown = 0, met = 0;
  for (int i = 0; i < 1500; ++i) {
    Convex s[2];
    for (int k = 0; k < 2; ++k)
      s[k] = solid(kWith[stream.below(3)], {size(), size(), size()},
                   {0.3 * direction(stream), axis_angle(direction(stream), 3 * stream.signed_unit())});
    const bool apart = shown_apart(s[0], s[1]);
    double gap = -1;
    for (int k = 0; k < 300; ++k) {
      const Vec3 n = direction(stream);
      gap = std::max(gap, dot(n, farthest(s[0], -n) - farthest(s[1], n)));
      const Vec3 p = s[0].p + 0.4 * direction(stream);
      const Vec3 q = s[0].p + (k / 300.0) * (farthest(s[0], n) - s[0].p);
      for (const Vec3& x : {p, q}) {
        const bool common = holds(s[0], x) && holds(s[1], x);
        met += common;
        EXPECT_FALSE(apart && common) << i;
      }
    }
    Overlap overlap;
    EXPECT_FALSE(gap > 0 && find_overlap(s[0], s[1], &overlap)) << i;
    parted += gap > 0.01;
    shown += gap > 0.01 && apart;
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(parted, 300);
  EXPECT_GT(shown, 0.9 * parted);
}

// On a sphere the normal is along the line of centres, whatever shape the ellipsoid has there.
TEST(Convex, AnEllipsoidsNormalIsItsSurfaces) {
  Stream stream(4, 0, Purpose::kTest);
  for (int i = 0; i < 500; ++i) {
    const Vec3 half = {0.03, 0.02, 0.04}, d = direction(stream);
    const Convex egg = solid(ShapeKind::kEllipsoid, half, {{}, axis_angle(direction(stream), 2)});
    const Vec3 on = farthest(egg, d);
    Overlap o;
    ASSERT_TRUE(find_overlap(solid(ShapeKind::kSphere, {0.01, 0, 0}, {on + (0.01 - 2e-4) * d, {}}), egg, &o));
    EXPECT_LT(norm(o.n - d), 5e-3);
    EXPECT_NEAR(o.depth, 2e-4, 2e-6);
  }
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include "sense/render/intersect.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

const View kView = make_view(look({0, 0, 0}, {1, 0, 0}), 64, 64);

Primitive primitive(ShapeKind kind, const Vec3& size) {
  Primitive s{};
  EXPECT_TRUE(make_primitive(make_shape(kind, size, {}), 0, kView, &s));
  return s;
}

// What the float ray really is.
Vec3 rounded(const Vec3& v) {
  return {static_cast<double>(static_cast<float>(v.x)), static_cast<double>(static_cast<float>(v.y)),
          static_cast<double>(static_cast<float>(v.z))};
}

double enter(const Primitive& s, const Vec3& o, const Vec3& d) {
  return entry(s, wide(o), wide(d))[0];
}

Vec3 normal(const Primitive& s, const Vec3& p) {
  const Lanes3 n = surface_normal(s, wide(p));
  return {n.x[0], n.y[0], n.z[0]};
}

TEST(Entry, StraightOn) {
  const Vec3 o{0, 0, 2}, down{0, 0, -1};
  EXPECT_NEAR(enter(primitive(ShapeKind::kSphere, {0.3, 0, 0}), o, down), 1.7, 1e-6);
  EXPECT_NEAR(enter(primitive(ShapeKind::kCapsule, {0.3, 0.2, 0}), o, down), 1.5, 1e-6);
  EXPECT_NEAR(enter(primitive(ShapeKind::kBox, {0.1, 0.2, 0.4}), o, down), 1.6, 1e-6);
  EXPECT_NEAR(enter(primitive(ShapeKind::kCylinder, {0.3, 0.2, 0}), o, down), 1.8, 1e-6);
  EXPECT_NEAR(enter(primitive(ShapeKind::kPlane, {}), o, down), 2, 1e-6);
  // The direction's length scales t, not the point.
  EXPECT_NEAR(enter(primitive(ShapeKind::kSphere, {0.3, 0, 0}), o, 10 * down), 0.17, 1e-7);
}

TEST(Entry, FromTheSide) {
  const Vec3 o{3, 0, 0}, in{-1, 0, 0};
  EXPECT_NEAR(enter(primitive(ShapeKind::kCapsule, {0.3, 0.2, 0}), o, in), 2.7, 1e-6);
  EXPECT_NEAR(enter(primitive(ShapeKind::kCylinder, {0.3, 0.2, 0}), o, in), 2.7, 1e-6);
  EXPECT_NEAR(enter(primitive(ShapeKind::kBox, {0.1, 0.2, 0.4}), o, in), 2.9, 1e-6);
  EXPECT_EQ(enter(primitive(ShapeKind::kPlane, {}), {3, 0, 1}, in), HUGE_VAL);
}

TEST(Entry, AlongTheAxisOutsideMisses) {
  const Primitive capsule = primitive(ShapeKind::kCapsule, {0.3, 0.2, 0});
  const Primitive cylinder = primitive(ShapeKind::kCylinder, {0.3, 0.2, 0});
  EXPECT_NEAR(enter(capsule, {0.24, 0, 2}, {0, 0, -1}), 2 - 0.2 - 0.18, 1e-6);
  EXPECT_NEAR(enter(cylinder, {0.29, 0, 2}, {0, 0, -1}), 1.8, 1e-6);
  EXPECT_EQ(enter(capsule, {0.31, 0, 2}, {0, 0, -1}), HUGE_VAL);
  EXPECT_EQ(enter(cylinder, {0.31, 0, 2}, {0, 0, -1}), HUGE_VAL);
}

TEST(Entry, BehindOrInsideIsNotAhead) {
  for (ShapeKind kind : kAllKinds) {
    const Primitive s = primitive(kind, {0.3, 0.2, 0.2});
    if (kind != ShapeKind::kPlane) {
      const double t = enter(s, {0.01, 0.02, -0.03}, {0.3, -0.5, 0.8});
      EXPECT_LE(t, 0) << static_cast<int>(kind);  // the eye is inside
      const double behind = enter(s, {0, 0, 2}, {0, 0, 1});
      EXPECT_LE(behind, 0) << static_cast<int>(kind);
    } else {
      EXPECT_EQ(enter(s, {0, 0, -1}, {0, 0, -1}), HUGE_VAL);
      EXPECT_EQ(enter(s, {0, 0, 1}, {0, 0, 1}), HUGE_VAL);
    }
  }
}

// Random rays, many of them grazing and some along an axis, against sphere tracing in double.
TEST(Entry, AgreesWithSphereTracing) {
  Draw draw(5);
  for (ShapeKind kind : kAllKinds) {
    int hits = 0, misses = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 size{draw.uniform(0.005, 0.05), draw.uniform(0.005, 0.08), draw.uniform(0.005, 0.05)};
      const Vec3 aim = draw.box(0.1), from = aim + draw.uniform(0.5, 2) * rotate(draw.turn(), {1, 0, 0});
      Vec3 d = (aim - from) * draw.uniform(0.5, 2);
      if (i % 5 == 0) d[i % 3] = 0;
      if (i % 10 == 0) d[(i + 1) % 3] = 0;
      const Vec3 o = rounded(from);
      d = rounded(d);
      if (kind != ShapeKind::kPlane && signed_distance(kind, size, o) <= 0) continue;
      if (kind == ShapeKind::kPlane && (o.z <= 0 || std::abs(d.z) < 0.05 * norm(d))) continue;
      double gap = 0;
      const double want = march(kind, size, o, d, 200, &gap);
      const double got = enter(primitive(kind, size), o, d);
      if (std::isinf(want)) {
        if (gap < 2e-6) continue;  // floats may not tell a touch from a miss
        EXPECT_FALSE(got > 0 && std::isfinite(got)) << static_cast<int>(kind) << " ray " << i;
        ++misses;
        continue;
      }
      // Where the ray passes a surface at a low angle, t is as uncertain as the angle says.
      const Vec3 deep = o + (want + 1e-3 / norm(d)) * d;
      if (signed_distance(kind, size, deep) > -1e-4) continue;
      ASSERT_TRUE(std::isfinite(got)) << static_cast<int>(kind) << " ray " << i;
      EXPECT_NEAR(got * norm(d), want * norm(d), 1e-5) << static_cast<int>(kind) << " ray " << i;
      ++hits;
    }
    EXPECT_GT(hits, 200) << static_cast<int>(kind);
    EXPECT_GT(misses, kind == ShapeKind::kPlane ? -1 : 200) << static_cast<int>(kind);
  }
}

TEST(Entry, LanesAreIndependent) {
  const Primitive s = primitive(ShapeKind::kCapsule, {0.03, 0.05, 0});
  Draw draw(9);
  Lanes3 o, d;
  Vec3 from[kFloat4Lanes], to[kFloat4Lanes];
  for (int round = 0; round < 50; ++round) {
    for (int i = 0; i < kFloat4Lanes; ++i) {
      from[i] = draw.box(1);
      to[i] = draw.box(0.06) - from[i];
      o.x[i] = static_cast<float>(from[i].x);
      o.y[i] = static_cast<float>(from[i].y);
      o.z[i] = static_cast<float>(from[i].z);
      d.x[i] = static_cast<float>(to[i].x);
      d.y[i] = static_cast<float>(to[i].y);
      d.z[i] = static_cast<float>(to[i].z);
    }
    const Float4 t = entry(s, o, d);
    for (int i = 0; i < kFloat4Lanes; ++i) EXPECT_EQ(t[i], static_cast<float>(enter(s, from[i], to[i])));
  }
}

TEST(Entry, Normals) {
  const auto expect = [](const Vec3& n, const Vec3& want) {
    EXPECT_NEAR(n.x, want.x, 1e-5);
    EXPECT_NEAR(n.y, want.y, 1e-5);
    EXPECT_NEAR(n.z, want.z, 1e-5);
  };
  expect(normal(primitive(ShapeKind::kSphere, {0.3, 0, 0}), {0, 0.18, -0.24}), {0, 0.6, -0.8});
  const Primitive capsule = primitive(ShapeKind::kCapsule, {0.1, 0.2, 0});
  expect(normal(capsule, {0.1, 0, 0.15}), {1, 0, 0});
  expect(normal(capsule, {0, 0.06, -0.28}), {0, 0.6, -0.8});
  const Primitive box = primitive(ShapeKind::kBox, {0.1, 0.2, 0.3});
  expect(normal(box, {-0.1, 0.05, 0.2}), {-1, 0, 0});
  expect(normal(box, {0, 0.2, 0}), {0, 1, 0});
  expect(normal(box, {0.02, 0, -0.3}), {0, 0, -1});
  expect(normal(box, {0.1, 0.2, 0}), {std::sqrt(0.5), std::sqrt(0.5), 0});  // the rounded edge
  const Primitive cylinder = primitive(ShapeKind::kCylinder, {0.1, 0.2, 0});
  expect(normal(cylinder, {0.06, 0.08, 0}), {0.6, 0.8, 0});
  expect(normal(cylinder, {0.03, 0, 0.2}), {0, 0, 1});
  expect(normal(cylinder, {0, 0, -0.2}), {0, 0, -1});
  expect(normal(primitive(ShapeKind::kPlane, {}), {5, 6, 0}), {0, 0, 1});
}

}  // namespace
}  // namespace rdm

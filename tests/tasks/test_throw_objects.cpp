#include <gtest/gtest.h>

#include <string>

#include "base/error.hpp"
#include "base/rng.hpp"
#include "tasks/throw/throw_objects.hpp"

namespace rdm {
namespace {

TEST(ThrowObjects, EggBallAndThePublishedSizes) {
  EXPECT_STREQ(throw_object_at(0).name, "egg");
  EXPECT_EQ(throw_object_named("egg").mass, 0.0754);
  EXPECT_EQ(throw_object_named("ball").size.x, 0.0333);
  EXPECT_EQ(throw_object_named("Heavy-Ball").mass, 0.25);
  EXPECT_EQ(throw_object_named("cracker_box").size.y, 0.105);
  EXPECT_EQ(throw_object_named("soup_can").size.y, 0.0505);
  EXPECT_EQ(throw_object_named("cube").mass, 0.071);
  EXPECT_EQ(throw_object_named("ellipsoid_egg").size.z, 0.04);
  EXPECT_EQ(throw_object_count(), 15);
  EXPECT_EQ(guard([] { throw_object_named("bal"); }), Code::kNotFound);
  EXPECT_NE(std::string(last_error()).find("nearest is ball"), std::string::npos);
  EXPECT_EQ(guard([] { throw_object_at(15); }), Code::kRange);
}

TEST(ThrowObjects, ChoicesNameThemAll) {
  std::string text;
  for (int32_t i = 0; i < throw_object_count(); ++i)
    text += std::string(i ? "|" : "") + throw_object_at(i).name;
  EXPECT_EQ(throw_object_choices(), text);
}

bool inside(ShapeKind kind, const Vec3& s, const Vec3& p) {
  switch (kind) {
    case ShapeKind::kSphere:
      return norm(p) <= s.x;
    case ShapeKind::kBox:
      return std::abs(p.x) <= s.x && std::abs(p.y) <= s.y && std::abs(p.z) <= s.z;
    case ShapeKind::kCylinder:
      return std::hypot(p.x, p.y) <= s.x && std::abs(p.z) <= s.y;
    case ShapeKind::kCapsule: {
      const double z = std::max(0.0, std::abs(p.z) - s.y);
      return p.x * p.x + p.y * p.y + z * z <= s.x * s.x;
    }
    case ShapeKind::kEllipsoid:
      return norm({p.x / s.x, p.y / s.y, p.z / s.z}) <= 1;
    case ShapeKind::kHull:
    case ShapeKind::kPlane:
      break;
  }
  return false;
}

// Against sums over points drawn inside each solid.
TEST(ThrowObjects, MomentsAreThoseOfTheSolids) {
  const struct {
    ShapeKind kind;
    Vec3 size, half;
  } rows[] = {{ShapeKind::kSphere, {0.03, 0, 0}, {0.03, 0.03, 0.03}},
              {ShapeKind::kBox, {0.02, 0.05, 0.03}, {0.02, 0.05, 0.03}},
              {ShapeKind::kCylinder, {0.03, 0.05, 0}, {0.03, 0.03, 0.05}},
              {ShapeKind::kCapsule, {0.03, 0.02, 0}, {0.03, 0.03, 0.05}},
              {ShapeKind::kEllipsoid, {0.03, 0.04, 0.05}, {0.03, 0.04, 0.05}}};
  for (const auto& row : rows) {
    Stream stream(1, 0, Purpose::kTest);
    Vec3 sum;
    int count = 0;
    while (count < 200000) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) p[i] = row.half[i] * stream.signed_unit();
      if (!inside(row.kind, row.size, p)) continue;
      ++count;
      sum += {p.y * p.y + p.z * p.z, p.x * p.x + p.z * p.z, p.x * p.x + p.y * p.y};
    }
    const Vec3 expected = 0.5 / count * sum, moment = solid_moment(row.kind, row.size, 0.5);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(moment[i] / expected[i], 1, 0.01) << static_cast<int>(row.kind);
  }
}

TEST(ThrowObjects, BodyTakesMassAndKeepsShape) {
  const BodyDef egg = make_throw_body(throw_object_named("egg"), 0, 0.1, 2, {{1, 2, 3}, {}});
  EXPECT_EQ(egg.inertia.mass, 0.0754);
  EXPECT_DOUBLE_EQ(egg.inertia.moment[0], 3.77e-5);
  EXPECT_DOUBLE_EQ(egg.inertia.moment[2], 2.71e-5);
  EXPECT_EQ(egg.angular_damping, 0.1);
  EXPECT_EQ(egg.shapes[0].kind, ShapeKind::kCapsule);
  EXPECT_EQ(egg.shapes[0].size.x, 0.03);
  EXPECT_EQ(2 * egg.shapes[0].size.y, 0.02);  // straight part
  EXPECT_EQ(egg.shapes[0].material, 2);
  EXPECT_EQ(egg.X_WB.p.z, 3);
  const BodyDef heavy = make_throw_body(throw_object_named("egg"), 0.1508, 0.1, 2, {});
  EXPECT_DOUBLE_EQ(heavy.inertia.mass, 0.1508);
  EXPECT_DOUBLE_EQ(heavy.inertia.moment[0], 2 * 3.77e-5);
  const BodyDef ball = make_throw_body(throw_object_named("ball"), 0, 0, 0, {});
  EXPECT_DOUBLE_EQ(ball.inertia.moment[1], 0.4 * 0.0754 * 0.0333 * 0.0333);
}

// A box by its corners, somewhere, is the box at the origin.
TEST(ThrowObjects, AHullsBodyIsInItsCentreOfMass) {
  const char* text = "0,0,0; 0.04,0,0; 0,0.06,0; 0.04,0.06,0;0,0,0.1;+0.04,0,1e-1;0,0.06,.1;0.04,0.06,0.1;";
  const BodyDef box = make_throw_body(throw_object_named("hull"), 0, 0.1, 2, {{1, 2, 3}, {}}, text);
  EXPECT_NEAR(box.inertia.mass, kHullDensity * 0.04 * 0.06 * 0.1, 1e-12);
  const Vec3 moment = solid_moment(ShapeKind::kBox, {0.02, 0.03, 0.05}, box.inertia.mass);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(box.inertia.moment[i], moment[i], 1e-12);
    EXPECT_NEAR(box.inertia.moment[3 + i], 0, 1e-12);
  }
  ASSERT_EQ(box.shapes[0].points.size(), 8u);
  EXPECT_LT(norm(box.shapes[0].points[7] - Vec3{0.02, 0.03, 0.05}), 1e-12);
  EXPECT_EQ(box.inertia.com.x, 0);
  EXPECT_DOUBLE_EQ(make_throw_body(throw_object_named("hull"), 0.2, 0, 2, {}, text).inertia.mass, 0.2);
}

TEST(ThrowObjects, RefusesWhatIsNoListOfPoints) {
  for (const char* text : {"1", "1,2", "1,2,3,4", "1 2 3", "a,b,c", "0,0,0;;1,0,0"}) {
    EXPECT_EQ(guard([&] { hull_points_from(text); }), Code::kArgument) << text;
  }
  EXPECT_EQ(guard([] { make_throw_body(throw_object_named("hull"), 0, 0, 0, {}, ""); }), Code::kRange);
}

}  // namespace
}  // namespace rdm

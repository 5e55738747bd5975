#include <gtest/gtest.h>

#include "base/error.hpp"
#include "sense/render/primitive.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

const Vec3 kSize{0.05, 0.08, 0.03};

// A random point of the shape's surface, in S.
Vec3 on_surface(ShapeKind kind, const Vec3& size, Draw& draw) {
  const Vec3 u = rotate(draw.turn(), {1, 0, 0});
  double lo = 0, hi = 1;
  while (signed_distance(kind, size, hi * u) < 0) hi *= 2;
  for (int i = 0; i < 60; ++i)
    (signed_distance(kind, size, 0.5 * (lo + hi) * u) < 0 ? lo : hi) = 0.5 * (lo + hi);
  return lo * u;
}

TEST(Primitive, BoundsHoldTheWholeShape) {
  Draw draw(3);
  for (int i = 0; i < 400; ++i) {
    const ShapeKind kind = kFinite[i % 6];
    const View view = make_view(look(draw.box(2), draw.box(0.2)), 97, 61);
    const RenderShape shape = make_shape(kind, kSize, {draw.box(0.5), draw.turn()});
    Primitive s{};
    ASSERT_TRUE(make_primitive(shape, 0, view, &s));
    for (int k = 0; k < 50; ++k) {
      const Vec3 p_W = shape.X_WS * on_surface(kind, kSize, draw);
      const Vec3 p = transpose(view.R_WC) * (p_W - view.eye);
      EXPECT_LE(norm(p_W - shape.X_WS.p), s.radius);
      if (p.z <= 0) continue;
      EXPECT_GE(p.z, s.nearest);
      const double x = 0.5 * view.width + p.x / p.z / view.pixel,
                   y = 0.5 * view.height + p.y / p.z / view.pixel;
      EXPECT_TRUE(s.x0 < x && x < s.x1 && s.y0 < y && y < s.y1) << "shape " << i;
    }
  }
}

TEST(Primitive, BoundOfASphereIsTight) {
  const View view = make_view(look({0, 0, 0}, {1, 0, 0}, 1.0), 100, 100);
  Primitive s{};
  ASSERT_TRUE(make_primitive(make_shape(ShapeKind::kSphere, {0.3, 0, 0}, {{2, 0.5, 0}, {}}), 0, view, &s));
  // Tangents from the eye in the plane of x and y; world +y is to the left.
  const double middle = std::atan2(-0.5, 2), half = std::asin(0.3 / std::hypot(2, 0.5));
  EXPECT_NEAR(s.x0, 50 + std::tan(middle - half) / view.pixel, 0.6);
  EXPECT_NEAR(s.x1, 50 + std::tan(middle + half) / view.pixel, 0.6);
  EXPECT_NEAR(s.nearest, 1.7, 0.002);
}

TEST(Primitive, BehindTheEyeIsNowhereAboutItIsEverywhere) {
  const View view = make_view(look({0, 0, 0}, {1, 0, 0}), 64, 64);
  for (ShapeKind kind : kFinite) {
    Primitive s{};
    ASSERT_TRUE(make_primitive(make_shape(kind, kSize, {{-1, 0, 0}, {}}), 0, view, &s));
    EXPECT_GT(s.x0, s.x1);
    ASSERT_TRUE(make_primitive(make_shape(kind, kSize, {{0.01, 0, 0}, {}}), 0, view, &s));
    EXPECT_TRUE(s.x0 < 0 && s.x1 > 64 && s.y0 < 0 && s.y1 > 64);
    EXPECT_EQ(s.nearest, 0);
  }
  Primitive plane{};
  ASSERT_TRUE(make_primitive(make_shape(ShapeKind::kPlane, {}, {{0, 0, -1}, {}}), 0, view, &plane));
  EXPECT_TRUE(plane.x0 < 0 && plane.x1 > 64 && plane.nearest == 0);
}

TEST(Primitive, RefusesImpossibleSizesAndKinds) {
  const View view = make_view(look({0, 0, 0}, {1, 0, 0}), 64, 64);
  Primitive s{};
  const auto code = [&](ShapeKind kind, Vec3 size) {
    return guard([&] { make_primitive(make_shape(kind, size, {}), 12, view, &s); });
  };
  for (double bad : {0.0, -1.0, std::nan(""), HUGE_VAL, 1e6}) {
    EXPECT_EQ(code(ShapeKind::kSphere, {bad, 1, 1}), Code::kRange);
    EXPECT_EQ(code(ShapeKind::kCapsule, {1, bad, 1}), Code::kRange);
    EXPECT_EQ(code(ShapeKind::kCylinder, {1, bad, 1}), Code::kRange);
    EXPECT_EQ(code(ShapeKind::kBox, {1, 1, bad}), Code::kRange);
    // Numbers that a kind does not use do not matter.
    EXPECT_EQ(code(ShapeKind::kSphere, {1, bad, bad}), Code::kOk);
    EXPECT_EQ(code(ShapeKind::kCapsule, {1, 1, bad}), Code::kOk);
    EXPECT_EQ(code(ShapeKind::kPlane, {bad, bad, bad}), Code::kOk);
  }
  EXPECT_EQ(code(static_cast<ShapeKind>(7), {1, 1, 1}), Code::kArgument);
  EXPECT_STREQ(last_error(), "shapes[12]: kind 7 is unknown");
}

TEST(Primitive, ShapeOfADivergedWorldIsLeftOut) {
  const View view = make_view(look({0, 0, 0}, {1, 0, 0}), 64, 64);
  Primitive s{};
  for (double bad : {std::nan(""), HUGE_VAL, 2e6}) {
    EXPECT_FALSE(make_primitive(make_shape(ShapeKind::kSphere, kSize, {{bad, 0, 0}, {}}), 0, view, &s));
    if (bad == 2e6) continue;
    EXPECT_FALSE(make_primitive(make_shape(ShapeKind::kSphere, kSize, {{}, {1, bad, 0, 0}}), 0, view, &s));
  }
}

TEST(Primitive, FramesTurnThereAndBack) {
  Draw draw(8);
  const View view = make_view(look({0.3, -2, 1}, {0, 0, 0}), 64, 64);
  const RenderShape shape = make_shape(ShapeKind::kBox, kSize, {draw.box(1), draw.turn()});
  Primitive s{};
  ASSERT_TRUE(make_primitive(shape, 0, view, &s));
  const Vec3 p_W{0.2, 0.1, -0.4}, want = inverse(shape.X_WS) * p_W, p_E = p_W - view.eye;
  const Lanes3 p = splat(static_cast<float>(p_E.x), static_cast<float>(p_E.y), static_cast<float>(p_E.z));
  const Lanes3 got = to_shape(s, p), back = rotate_from_shape(s, rotate_to_shape(s, p));
  EXPECT_NEAR(got.x[0], want.x, 1e-6);
  EXPECT_NEAR(got.y[1], want.y, 1e-6);
  EXPECT_NEAR(got.z[2], want.z, 1e-6);
  EXPECT_NEAR(back.y[3], p_E.y, 1e-6);
  const Vec3 eye = inverse(shape.X_WS) * view.eye;
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(s.o_S[k], eye[k], 1e-6);
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "sense/render/camera.hpp"

namespace rdm {
namespace {

Code code_of(const Camera& camera, int32_t width, int32_t height) {
  return guard([&] { make_view(camera, width, height); });
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// Of two hands that reach from (0, 0, 0.5) and (0, -1, 0.5) towards each other.
const Camera kFront{"front", {1.1, -0.5, 0.9}, {0, -0.5, 0.5}, kPi / 4},
    kTop{"top", {0, -0.5, 1.8}, {0, -0.5, 0.5}, kPi / 4},
    kRight{"right", {0.6, 0.3, 0.9}, {0, -0.4, 0.5}, kPi / 4};

// Image point at which a world point is seen, pixels.
Vec3 seen_at(const View& view, const Vec3& p_W) {
  const Vec3 p = transpose(view.R_WC) * (p_W - view.eye);
  return {view.cx + p.x / p.z / view.pixel, view.cy + p.y / p.z / view.pixel, p.z};
}

TEST(Camera, FrontHasTheRightHandOnTheRight) {
  const View view = make_view(kFront, 640, 480);
  EXPECT_GT(seen_at(view, {0, 0, 0.5}).x, 320);
  EXPECT_LT(seen_at(view, {0, -1, 0.5}).x, 320);
  EXPECT_LT(seen_at(view, {0, -0.5, 0.6}).y, seen_at(view, {0, -0.5, 0.5}).y);
  // Both wrists and everything between them fit in.
  for (double y : {-1.1, 0.1}) {
    EXPECT_GT(seen_at(view, {0, y, 0.5}).x, 0);
    EXPECT_LT(seen_at(view, {0, y, 0.5}).x, 640);
  }
}

TEST(Camera, TopIsFrontTippedOver) {
  const View view = make_view(kTop, 64, 64);
  expect_near(view.R_WC.col(2), {0, 0, -1}, 1e-12);
  expect_near(view.R_WC.col(1), {1, 0, 0}, 1e-12);
  EXPECT_GT(seen_at(view, {0, 0, 0.5}).x, 32);
}

TEST(Camera, FrameIsRightHandedAndLooksAtTheTarget) {
  const Camera cameras[] = {kRight, {"odd", {1, 2, 3}, {-4, 0, 7}, 1.2}, {"up", {0, 0, 0}, {0, 0, 2}, 1}};
  for (const Camera& c : cameras) {
    const View view = make_view(c, 33, 17);
    const Vec3 x = view.R_WC.col(0), y = view.R_WC.col(1), z = view.R_WC.col(2);
    expect_near(cross(x, y), z, 1e-12);
    EXPECT_NEAR(norm(x), 1, 1e-12);
    EXPECT_NEAR(norm(y), 1, 1e-12);
    expect_near(z, normalized(c.target - c.eye), 1e-12);
    expect_near(view.point(16.5, 8.5, norm(c.target - c.eye)), c.target, 1e-12);
  }
}

TEST(Camera, AngleSpansTheHeight) {
  for (double fov : {0.2, kPi / 4, 2.5}) {
    const View view = make_view({"c", {0, 0, 0}, {1, 0, 0}, fov}, 200, 100);
    EXPECT_NEAR(std::atan(-view.ray_C(100, 0).y) + std::atan(view.ray_C(100, 100).y), fov, 1e-12);
    // Square pixels.
    EXPECT_NEAR(view.ray_C(101, 50).x, view.ray_C(100, 51).y, 1e-15);
  }
}

TEST(Camera, RefusesWhatCannotBeSeen) {
  const Camera good = kFront;
  EXPECT_EQ(code_of(good, 1, 1), Code::kOk);
  EXPECT_EQ(code_of(good, kMaxImageSide, kMaxImageSide), Code::kOk);
  for (int32_t side : {0, -1, kMaxImageSide + 1, INT32_MIN, INT32_MAX}) {
    EXPECT_EQ(code_of(good, side, 10), Code::kRange) << side;
    EXPECT_EQ(code_of(good, 10, side), Code::kRange) << side;
  }
  for (double fov : {0.0, -1.0, kPi, std::nan(""), HUGE_VAL})
    EXPECT_EQ(code_of({"c", {0, 0, 0}, {1, 0, 0}, fov}, 8, 8), Code::kRange) << fov;
  EXPECT_EQ(code_of({"c", {1, 2, 3}, {1, 2, 3}, 1}, 8, 8), Code::kArgument);
  EXPECT_EQ(code_of({"c", {std::nan(""), 2, 3}, {1, 2, 3}, 1}, 8, 8), Code::kArgument);
  EXPECT_EQ(code_of({"c", {0, 0, 0}, {HUGE_VAL, 2, 3}, 1}, 8, 8), Code::kArgument);
  EXPECT_EQ(code_of({"c", {-1e308, 0, 0}, {1e308, 0, 0}, 1}, 8, 8), Code::kArgument);
  EXPECT_EQ(code_of({"c", {0, 0, 0}, {1, 0, 0}, 1, {0, std::nan(""), 1}}, 8, 8), Code::kArgument);
  for (const double shift : {-10.1, 10.1, HUGE_VAL, std::nan("")}) {
    EXPECT_EQ(code_of({"c", {0, 0, 0}, {1, 0, 0}, 1, {0, 0, 1}, 0, shift, 0}, 8, 8), Code::kRange) << shift;
    EXPECT_EQ(code_of({"c", {0, 0, 0}, {1, 0, 0}, 1, {0, 0, 1}, 0, 0, shift}, 8, 8), Code::kRange) << shift;
  }
}

}  // namespace
}  // namespace rdm

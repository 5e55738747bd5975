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

// Image point at which a world point is seen, pixels.
Vec3 seen_at(const View& view, const Vec3& p_W) {
  const Vec3 p = transpose(view.R_WC) * (p_W - view.eye);
  return {0.5 * view.width + p.x / p.z / view.pixel, 0.5 * view.height + p.y / p.z / view.pixel, p.z};
}

TEST(Camera, StandardOnesByName) {
  Camera all[kNumStandardCameras];
  for (int32_t i = 0; i < kNumStandardCameras; ++i) all[i] = standard_camera(i);
  const char* names[] = {"front", "top", "right", "left"};
  for (const char* name : names) {
    const Camera& c = find_camera(all, kNumStandardCameras, name);
    EXPECT_TRUE(c.name == name);
    EXPECT_DOUBLE_EQ(c.fov_y, kPi / 4);
  }
  expect_near(find_camera(all, kNumStandardCameras, "front").eye, {1.1, -0.5, 0.9}, 0);
  expect_near(find_camera(all, kNumStandardCameras, "top").eye, {0, -0.5, 1.8}, 0);
  // left is right, mirrored in the plane y = -0.5 between the hands.
  const Camera &right = find_camera(all, 4, "right"), &left = find_camera(all, 4, "left");
  expect_near(left.eye, {right.eye.x, -1 - right.eye.y, right.eye.z}, 1e-12);
  expect_near(left.target, {right.target.x, -1 - right.target.y, right.target.z}, 1e-12);
}

TEST(Camera, UnknownNameListsThoseThereAre) {
  const Camera all[] = {standard_camera(0), standard_camera(1)};
  EXPECT_EQ(guard([&] { find_camera(all, 2, "frnt"); }), Code::kNotFound);
  EXPECT_STREQ(last_error(), "camera: no 'frnt'; there are front, top");
  EXPECT_EQ(guard([&] { find_camera(nullptr, 0, "x"); }), Code::kNotFound);
  EXPECT_EQ(guard([] { standard_camera(-1); }), Code::kRange);
  EXPECT_EQ(guard([] { standard_camera(kNumStandardCameras); }), Code::kRange);
}

TEST(Camera, FrontHasTheRightHandOnTheRight) {
  const View view = make_view(standard_camera(0), 640, 480);
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
  const View view = make_view(standard_camera(1), 64, 64);
  expect_near(view.R_WC.col(2), {0, 0, -1}, 1e-12);
  expect_near(view.R_WC.col(1), {1, 0, 0}, 1e-12);
  EXPECT_GT(seen_at(view, {0, 0, 0.5}).x, 32);
}

TEST(Camera, FrameIsRightHandedAndLooksAtTheTarget) {
  const Camera cameras[] = {
      standard_camera(2), {"odd", {1, 2, 3}, {-4, 0, 7}, 1.2}, {"up", {0, 0, 0}, {0, 0, 2}, 1}};
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
  const Camera good = standard_camera(0);
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
}

}  // namespace
}  // namespace rdm

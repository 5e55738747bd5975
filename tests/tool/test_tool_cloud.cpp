// Clouds are drawn where the library's own pictures have the shapes that their points lie on.
#include <gtest/gtest.h>

#include <cmath>
#include <redman/sense.hpp>

#include "common/setup.hpp"
#include "draw/cloud.hpp"
#include "play/scene.hpp"

namespace tool {
namespace {

constexpr int32_t kWidth = 160, kHeight = 120;

PoolSettings settings_with(const std::string& camera, const char* task) {
  PoolSettings s;
  s.task = task;
  s.options = {{"modality", "points"},
               {"points", "256"},
               {"cloud_cameras", camera},
               {"cloud_width", std::to_string(kWidth)},
               {"cloud_height", std::to_string(kHeight)}};
  return s;
}

rdm_camera_info camera_of(const redman::Pool& pool, const std::string& name) {
  rdm_camera_info c = RDM_INIT(rdm_camera_info);
  for (int32_t i = 0; rdm_pool_camera_at(pool.get(), i, &c) == RDM_OK && name != c.name;) ++i;
  return c;
}

// The shape that the library draws in each pixel.
std::vector<int32_t> shapes_seen(redman::Pool& pool, const char* camera) {
  std::vector<int32_t> out(size_t{kWidth} * kHeight);
  redman::check(rdm_pool_render(pool.get(), 0, camera, kWidth, kHeight, nullptr, nullptr, out.data()));
  return out;
}

class Clouds : public testing::TestWithParam<const char*> {};

TEST_P(Clouds, PointsAreWhereTheirShapesAreSeen) {
  const char* name = GetParam();
  redman::Pool pool = make_pool(settings_with(name, "hand_over_safe_finger"), RDM_AUTORESET_OFF);
  pool.reset();
  const rdm_sensors s = redman::sensors(pool);
  const rdm_camera_info camera = camera_of(pool, name);
  const Projection projection(camera, kWidth, kHeight);
  const auto seen = shapes_seen(pool, name);
  const Image image =
      draw_cloud(camera, s.points, s.point_shape, s.point_class, s.num_points, kWidth, kHeight);
  ASSERT_EQ(image.rgb.size(), size_t{kWidth} * kHeight * 3);
  int all = 0, right = 0, coloured = 0, drawn = 0;
  for (int32_t p = 0; p < s.num_points; ++p) {
    double at[3];
    if (s.point_shape[p] < 0) continue;
    ASSERT_TRUE(projection.see(s.points + 3 * p, at));
    if (at[0] < 0 || at[1] < 0 || at[0] >= kWidth || at[1] >= kHeight) continue;
    const auto pixel = static_cast<size_t>(at[1]) * kWidth + static_cast<size_t>(at[0]);
    unsigned char rgb[3];
    cloud_color(s.point_class[p], rgb);
    ++all;
    right += seen[pixel] == s.point_shape[p];
    coloured += std::equal(rgb, rgb + 3, image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
    EXPECT_NE(image.rgb[3 * pixel] + image.rgb[3 * pixel + 1] + image.rgb[3 * pixel + 2], 3 * 255) << p;
  }
  for (size_t i = 0; i < image.rgb.size(); i += 3)
    drawn += image.rgb[i] + image.rgb[i + 1] + image.rgb[i + 2] < 3 * 255;
  EXPECT_GT(all, 100);
  EXPECT_EQ(right, all) << "each point is the middle of a pixel of this very camera";
  EXPECT_GT(coloured, all * 9 / 10) << "but for dots that a nearer one hides";
  EXPECT_GT(drawn, 100);
  EXPECT_LT(drawn, kWidth * kHeight / 2) << "most of the picture is white";
}
INSTANTIATE_TEST_SUITE_P(Cameras, Clouds, testing::Values("front", "top", "side_left"));

TEST(Cloud, NearerDotsHideOthersAndUnseenOnesAreNone) {
  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  camera.name = "x";
  camera.target[1] = 1;
  camera.up[2] = 1;
  camera.fov_y = 1;
  const float points[] = {0, 1, 0, 0, 2, 0, 0, -1, 0, 0.2f, 1, 0};
  const int32_t shape[] = {3, 4, 5, -1};
  const uint8_t kind[] = {1, 2, 0, 0};
  const Image image = draw_cloud(camera, points, shape, kind, 4, 65, 65);
  unsigned char rgb[3];
  cloud_color(1, rgb);
  const size_t middle = (size_t{32} * 65 + 32) * 3;
  EXPECT_TRUE(std::equal(rgb, rgb + 3, image.rgb.begin() + static_cast<std::ptrdiff_t>(middle)));
  int drawn = 0;
  for (size_t i = 0; i < image.rgb.size(); i += 3)
    drawn += image.rgb[i] != 255 || image.rgb[i + 1] != 255 || image.rgb[i + 2] != 255;
  EXPECT_EQ(drawn, 5) << "a dot of one pixel's radius";
}

TEST(Cloud, StandsBelowThePicture) {
  ActorChoice hold;
  hold.baseline = RDM_BASELINE_HOLD;
  const auto settings = settings_with("front", "grasp");
  Scene with(settings, hold, {"front", 80, 60, true}), without(settings, hold, {"front", 80, 60});
  const Image a = with.picture(), b = without.picture();
  ASSERT_EQ(a.height, 120);
  ASSERT_EQ(a.rgb.size(), 2 * b.rgb.size());
  const size_t row = 80 * 3;
  EXPECT_TRUE(std::equal(b.rgb.begin(), b.rgb.end() - 2 * row, a.rgb.begin())) << "but for the line between";
  EXPECT_EQ(Scene(settings, hold, {"front", 80, 60, true}).picture().rgb, a.rgb) << "the same again";
  with.advance_to(30);
  EXPECT_NE(with.picture().rgb, a.rgb);

  PoolSettings blind = settings;
  blind.options = {};
  EXPECT_THROW(Scene(blind, hold, {"front", 80, 60, true}), Usage);
  EXPECT_THROW(Scene(settings, hold, {"right_palm", 80, 60, true}), Usage);
}

}  // namespace
}  // namespace tool

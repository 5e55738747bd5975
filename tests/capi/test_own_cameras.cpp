// Roll and principal point of a host's own camera: turned and shifted pictures are those of the plain one, and
// clouds, voxels and maps stand where the pictures show them.
#include <gtest/gtest.h>

#include <cmath>
#include <redman/map.hpp>
#include <redman/redman.hpp>
#include <redman/sense.hpp>

#include "own_task.hpp"

namespace rdm::test {
namespace {

constexpr int32_t kSide = 64;

struct Picture {
  std::vector<uint8_t> rgb = std::vector<uint8_t>(3 * kSide * kSide);
  std::vector<float> depth = std::vector<float>(kSide * kSide);
  std::vector<int32_t> shape = std::vector<int32_t>(kSide * kSide);
};

class OwnCameras : public testing::Test {
 protected:
  OwnCameras() : task_("own_cameras"), front_(task_.cameras[0]) {
    add("rolled").up[0] = 7;
    rdm_camera_def& shifted = add("shifted");
    shifted.cx = 0.25f, shifted.cy = -0.125f;
    rdm_camera_def& odd = add("odd");
    odd.up[0] = 1, odd.up[2] = 2, odd.cx = -0.1f, odd.cy = 0.2f;
    task_.bind();
    registered_.emplace(task_.def);
  }
  rdm_camera_def& add(const char* name) {
    rdm_camera_def c = front_;
    c.name = name;
    return task_.cameras.emplace_back(c);
  }
  static redman::Pool pool(const char* settings) {
    rdm_pool_config c = redman::pool_config("own_cameras");
    c.settings = settings;
    redman::Pool made(c);
    made.reset();
    return made;
  }
  static Picture picture(redman::Pool& pool, const char* camera) {
    Picture p;
    redman::check(
        rdm_pool_render(pool.get(), 0, camera, kSide, kSide, p.rgb.data(), p.depth.data(), p.shape.data()));
    return p;
  }
  // Both show the same at pixels that `to` turns into each other; x, y of the one, its answer of the other.
  template <class F>
  static void expect_same(const Picture& a, const Picture& b, F to) {
    int all = 0, same_shape = 0, same_depth = 0, same_color = 0;
    for (int32_t y = 0; y < kSide; ++y)
      for (int32_t x = 0; x < kSide; ++x) {
        const auto [u, v] = to(x, y);
        if (u < 0 || v < 0 || u >= kSide || v >= kSide) continue;
        const auto i = static_cast<size_t>(kSide * y + x), k = static_cast<size_t>(kSide * v + u);
        ++all;
        same_shape += a.shape[i] == b.shape[k];
        same_depth += std::fabs(a.depth[i] - b.depth[k]) <= 1e-4f * b.depth[k];
        same_color += std::abs(a.rgb[3 * i] - b.rgb[3 * k]) <= 12;  // samples of soft shadows are elsewhere
      }
    EXPECT_GT(all, kSide * kSide / 2);
    EXPECT_GE(same_shape, all - 2) << "but for a ray that grazes an edge";
    EXPECT_GE(same_depth, all - 4);
    EXPECT_GE(same_color, all * 97 / 100);
  }

  BallTask task_;
  rdm_camera_def front_;
  std::optional<Registered> registered_;
};

TEST_F(OwnCameras, RollTurnsThePicture) {
  redman::Pool worlds = pool("");
  const Picture plain = picture(worlds, "front"), rolled = picture(worlds, "rolled");
  int bodies = 0;
  for (const int32_t s : plain.shape) bodies += s == 0 || s == 1;
  EXPECT_GT(bodies, 50) << "there is something to tell the sides by";
  // what was at the right is up now
  expect_same(rolled, plain, [](int32_t x, int32_t y) { return std::pair(kSide - 1 - y, x); });
  EXPECT_NE(rolled.shape, plain.shape);
}

TEST_F(OwnCameras, ThePrincipalPointShiftsThePicture) {
  redman::Pool worlds = pool("");
  const Picture plain = picture(worlds, "front"), shifted = picture(worlds, "shifted");
  expect_same(shifted, plain, [](int32_t x, int32_t y) { return std::pair(x - kSide / 4, y + kSide / 8); });
  EXPECT_NE(shifted.shape, plain.shape);
}

// The picture's point of a point in space, as the header says it; y is down, z the depth.
std::array<double, 3> seen_at(const rdm_camera_info& c, const float* p) {
  using Vec = std::array<double, 3>;
  const auto cross = [](const Vec& a, const Vec& b) {
    return Vec{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto dot = [](const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  Vec z, up, d;
  for (size_t k = 0; k < 3; ++k) {
    z[k] = static_cast<double>(c.target[k]) - static_cast<double>(c.eye[k]);
    up[k] = static_cast<double>(c.up[k]);
    d[k] = static_cast<double>(p[k]) - static_cast<double>(c.eye[k]);
  }
  for (double length = std::sqrt(dot(z, z)); double& v : z) v /= length;
  Vec x = cross(z, up);
  for (double length = std::sqrt(dot(x, x)); double& v : x) v /= length;
  const Vec y = cross(z, x);
  const double focal = 0.5 * kSide / std::tan(0.5 * static_cast<double>(c.fov_y)), depth = dot(z, d);
  return {(0.5 + static_cast<double>(c.cx)) * kSide + focal * dot(x, d) / depth,
          (0.5 + static_cast<double>(c.cy)) * kSide + focal * dot(y, d) / depth, depth};
}

TEST_F(OwnCameras, CloudsVoxelsAndMapsStandWhereThePictureShowsThem) {
  redman::Pool worlds = pool(
      "modality=depth+points+voxels\ncameras=odd\nimage_width=64\nimage_height=64\ncloud_cameras=odd\n"
      "cloud_width=64\ncloud_height=64\npoints=128\nvoxels=8");
  const rdm_sensors s = redman::sensors(worlds);
  const Picture odd = picture(worlds, "odd");
  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  ASSERT_EQ(rdm_pool_sensor_camera_at(worlds.get(), 1, 0, &camera), RDM_OK);
  EXPECT_STREQ(camera.name, "odd");
  EXPECT_NEAR(camera.up[0], std::sqrt(0.2), 1e-6) << "a given up of any length is reported as a unit";
  EXPECT_EQ(camera.cx, -0.1f);
  EXPECT_EQ(camera.cy, 0.2f);
  EXPECT_TRUE(std::equal(odd.depth.begin(), odd.depth.end(), s.depth)) << "depth rows are that picture";

  ASSERT_GT(s.point_count[0], 40);
  for (int32_t i = 0; i < s.num_points; ++i) {
    const auto [x, y, z] = seen_at(camera, s.points + 3 * i);
    ASSERT_TRUE(x >= 0 && y >= 0 && x < kSide && y < kSide) << x << ' ' << y;
    const auto pixel = static_cast<size_t>(kSide * static_cast<int32_t>(y) + static_cast<int32_t>(x));
    EXPECT_EQ(odd.shape[pixel], s.point_shape[i]) << i;
    EXPECT_NEAR(static_cast<double>(odd.depth[pixel]), z, 1e-4) << i;
  }

  redman::Map map(redman::map_config(0.01));
  EXPECT_EQ(map.scan(worlds, 0, "odd", 4 * kSide, 4 * kSide), 0u);
  std::vector<float> distance(static_cast<size_t>(s.num_points));
  redman::check(rdm_map_get_distances(map.get(), s.points, distance.size(), 1, distance.data()));
  for (const float d : distance) EXPECT_LT(d, 0.011f) << "the map has a voxel at each point of the cloud";

  const rdm_pose ball = worlds.poses()[1];  // about which the voxels are
  int occupied = 0;
  const auto middle = [&](int32_t i) { return (static_cast<float>(i) - 3.5f) * s.voxel_size; };
  for (int32_t x = 0, at = 0; x < 8; ++x)
    for (int32_t y = 0; y < 8; ++y)
      for (int32_t z = 0; z < 8; ++z, ++at) {
        if (s.voxels[at] != 1) continue;
        ++occupied;
        const float p[3] = {static_cast<float>(ball.p[0]) + middle(x),
                            static_cast<float>(ball.p[1]) + middle(y),
                            static_cast<float>(ball.p[2]) + middle(z)};
        float near = 0;
        redman::check(rdm_map_get_distances(map.get(), p, 1, 1, &near));
        EXPECT_LT(near, s.voxel_size) << x << ' ' << y << ' ' << z;
      }
  EXPECT_GT(occupied, 3);
}

}  // namespace
}  // namespace rdm::test

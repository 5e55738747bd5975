// Rays into a world meet what its pictures show, at the depth that they show.
#include <cmath>
#include <limits>
#include <thread>

#include "contract.hpp"
#include "sense/render/camera.hpp"

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int32_t kWidth = 40, kHeight = 30;

rdm_ray_hit empty_hit() {
  rdm_ray_hit h{};
  h.struct_size = sizeof h;
  return h;
}

struct Case {
  const char *task, *settings, *camera;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.task << ' ' << c.settings << ' ' << c.camera;
}

class PoolRaycast : public testing::TestWithParam<Case> {};

TEST_P(PoolRaycast, MeetsWhatPicturesShow) {
  rdm_pool_config c = pool_config(2);
  c.task = GetParam().task;
  c.settings = GetParam().settings;
  rdm_pool* p = make_pool(c);
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  }
  rdm_camera_info seen = RDM_INIT(rdm_camera_info);
  int32_t task = -1;
  ASSERT_EQ(rdm_task_find(c.task, &task), RDM_OK);
  for (int32_t i = 0; rdm_task_camera_at(task, i, &seen) == RDM_OK; ++i)
    if (std::strcmp(seen.name, GetParam().camera) == 0) break;
  ASSERT_STREQ(seen.name, GetParam().camera);
  rdm::Camera camera;
  for (int k = 0; k < 3; ++k) {
    camera.eye[k] = static_cast<double>(seen.eye[k]);
    camera.target[k] = static_cast<double>(seen.target[k]);
  }
  camera.fov_y = static_cast<double>(seen.fov_y);
  const rdm::View view = rdm::make_view(camera, kWidth, kHeight);
  std::vector<float> depth(kWidth * kHeight);
  std::vector<int32_t> shape(kWidth * kHeight);
  ASSERT_EQ(rdm_pool_render(p, 1, GetParam().camera, kWidth, kHeight, nullptr, depth.data(), shape.data()),
            RDM_OK);
  int32_t met = 0, differ = 0;
  for (int32_t y = 0; y < kHeight; ++y)
    for (int32_t x = 0; x < kWidth; ++x) {
      const auto at = static_cast<size_t>(y * kWidth + x);
      const rdm::Vec3 d = view.R_WC * view.ray_C(x + 0.5, y + 0.5);
      const double origin[] = {view.eye.x, view.eye.y, view.eye.z}, direction[] = {d.x, d.y, d.z};
      rdm_ray_hit hit = empty_hit();
      ASSERT_EQ(rdm_pool_raycast(p, 1, origin, direction, 100, &hit), RDM_OK) << rdm_pool_error(p);
      if (hit.shape != shape[at]) {  // at an outline a rounding decides
        ++differ;
        continue;
      }
      if (hit.shape < 0) continue;
      ++met;
      EXPECT_NEAR(hit.distance / norm(d), static_cast<double>(depth[at]), 1e-5 * (1 + hit.distance))
          << x << ' ' << y;
    }
  EXPECT_GT(met, kWidth * kHeight / 3);
  EXPECT_LE(differ, 4);
  rdm_pool_destroy(p);
}

INSTANTIATE_TEST_SUITE_P(Scenes, PoolRaycast,
                         testing::Values(Case{"hand_over_safe_finger", "", "front"},
                                         Case{"hand_over_safe_finger", "engine=ode", "front"},
                                         Case{"jenga", "", "front"}, Case{"clean_house", "", "front"},
                                         Case{"grasp", "object=banana", "front"},
                                         Case{"grasp", "object_scale=1.2..1.5", "front"},
                                         Case{"ant_gather", "", "front"}, Case{"point_button2", "", "front"},
                                         Case{"drone_gather", "", "front"}));

TEST(PoolRay, NothingIsNoError) {
  rdm_pool* p = make_pool(pool_config(1));
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  const double origin[] = {0, 0, 50}, up[] = {0, 0, 3}, down[] = {0, 0, -3};
  rdm_ray_hit hit = empty_hit();
  EXPECT_EQ(rdm_pool_raycast(p, 0, origin, up, kInf, &hit), RDM_OK);
  EXPECT_EQ(hit.shape, -1);
  EXPECT_TRUE(std::isnan(hit.distance));
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isnan(hit.point[k]) && std::isnan(hit.normal[k]));
  EXPECT_EQ(rdm_pool_raycast(p, 0, origin, down, 10, &hit), RDM_OK);
  EXPECT_EQ(hit.shape, -1);
  EXPECT_EQ(rdm_pool_raycast(p, 0, origin, down, kInf, &hit), RDM_OK);
  rdm_shape_info shape = RDM_INIT(rdm_shape_info);
  ASSERT_EQ(rdm_pool_shape_at(p, hit.shape, &shape), RDM_OK);
  EXPECT_GT(hit.distance, 40);
  EXPECT_GT(hit.normal[2], 0);
  EXPECT_NEAR(hit.point[2], 50 - hit.distance, 1e-9);
  rdm_pool_destroy(p);
}

TEST(PoolRay, WhatCannotBeIsRefused) {
  rdm_pool* p = make_pool(pool_config(1));
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  const double o[] = {0, 0, 1}, d[] = {0, 0, -1}, none[] = {0, 0, 0}, bad[] = {0, kNan, 1},
               wide[] = {kInf, 0, 0};
  rdm_ray_hit hit = empty_hit();
  const auto refused = [&](rdm_result r, rdm_result wanted, const char* text) {
    EXPECT_EQ(r, wanted);
    EXPECT_EQ(std::string(rdm_last_error()).rfind(text, 0), 0u) << rdm_last_error();
  };
  refused(rdm_pool_raycast(p, 1, o, d, 1, &hit), RDM_ERROR_RANGE, "env");
  refused(rdm_pool_raycast(p, 0, nullptr, d, 1, &hit), RDM_ERROR_ARGUMENT, "origin");
  refused(rdm_pool_raycast(p, 0, o, nullptr, 1, &hit), RDM_ERROR_ARGUMENT, "direction");
  refused(rdm_pool_raycast(p, 0, bad, d, 1, &hit), RDM_ERROR_ARGUMENT, "origin");
  refused(rdm_pool_raycast(p, 0, o, none, 1, &hit), RDM_ERROR_ARGUMENT, "direction");
  refused(rdm_pool_raycast(p, 0, o, bad, 1, &hit), RDM_ERROR_ARGUMENT, "direction");
  refused(rdm_pool_raycast(p, 0, o, wide, 1, &hit), RDM_ERROR_ARGUMENT, "direction");
  for (const double range : {0.0, -1.0, kNan})
    refused(rdm_pool_raycast(p, 0, o, d, range, &hit), RDM_ERROR_RANGE, "range");
  refused(rdm_pool_raycast(p, 0, o, d, 1, nullptr), RDM_ERROR_ARGUMENT, "io");
  EXPECT_EQ(hit.shape, 0);  // nothing was written
  rdm_pool_destroy(p);
}

// Whoever only looks writes nothing: any number of threads at a time.
TEST(PoolRay, ThreadsLookTogether) {
  rdm_pool* p = make_pool(pool_config(1));
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  const rdm_spec s = spec_of(p);
  std::vector<std::thread> threads;
  std::vector<std::vector<double>> seen(4);
  for (auto& mine : seen)
    threads.emplace_back([&mine, p, s] {
      std::vector<rdm_pose> poses(static_cast<size_t>(s.num_shapes));
      for (int i = 0; i < 200; ++i) {
        const double o[] = {0, -1, 0.5}, d[] = {0.01 * (i - 100), 1, 0.1};
        rdm_ray_hit hit = empty_hit();
        if (rdm_pool_raycast(p, 0, o, d, 10, &hit) != RDM_OK ||
            rdm_pool_get_poses(p, 0, poses.data()) != RDM_OK)
          return;
        mine.push_back(hit.shape + 0.001 * poses[0].p[0]);
      }
    });
  for (auto& t : threads) t.join();
  EXPECT_EQ(seen[0].size(), 200u);
  for (const auto& mine : seen) EXPECT_EQ(mine, seen[0]);
  rdm_pool_destroy(p);
}

}  // namespace

// rdm_map_* through the C ABI: a map of a task's scene from its cameras, and what bad input gets.
#include <cmath>

#include "contract.hpp"

namespace {

struct MapHandle {
  explicit MapHandle(double resolution = 0.02, uint64_t memory = 1u << 26, const rdm_host* host = nullptr,
                     double max_range = 0) {
    rdm_map_config c;
    EXPECT_EQ(rdm_map_config_init(&c, sizeof c), RDM_OK);
    c.resolution = resolution;
    c.memory = memory;
    c.host = host;
    c.max_range = max_range;
    EXPECT_EQ(rdm_map_create(&m, &c), RDM_OK) << rdm_last_error();
  }
  ~MapHandle() { rdm_map_destroy(m); }
  rdm_map* m = nullptr;
};

rdm_pool* make_world() {
  rdm_pool_config c;
  EXPECT_EQ(rdm_pool_config_init(&c, sizeof c), RDM_OK);
  c.task = "hand_over_safe_finger";
  c.num_envs = 2;
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  return p;
}

TEST(Map, WhatIsNoPlaceOrNoShapeIsRefused) {
  const MapHandle map;
  const float at[] = {0, 0, 0, NAN, 0, 0};
  float out[2] = {7, 7};
  EXPECT_EQ(rdm_map_get_probabilities(map.m, at, 2, out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_get_distances(map.m, at, 2, 1, out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(out[0], 7);
  rdm_pool* p = make_world();
  for (const int32_t shape : {-1, 99999}) {
    const int32_t skip[] = {0, shape};
    EXPECT_EQ(rdm_map_scan(map.m, p, 0, "front", 8, 8, skip, 2, nullptr), RDM_ERROR_RANGE) << shape;
  }
  rdm_pool_destroy(p);
}

TEST(Map, ScansOfATasksCamerasShowItsShapes) {
  rdm_pool* p = make_world();
  const MapHandle map(0.02, 1u << 26, nullptr, 2.5);  // the floor goes on for a hundred metres
  uint64_t dropped = 99;
  for (const char* camera : {"front", "top", "right", "left"})
    ASSERT_EQ(rdm_map_scan(map.m, p, 1, camera, 160, 120, nullptr, 0, &dropped), RDM_OK)
        << rdm_map_error(map.m);
  EXPECT_EQ(dropped, 0u);
  // what a depth picture of another size sees is occupied, or a voxel beside it is
  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  std::vector<float> depth(40 * 30), points, distance;
  std::vector<int32_t> shape(40 * 30);
  ASSERT_EQ(rdm_pool_render(p, 1, "top", 40, 30, nullptr, depth.data(), shape.data()), RDM_OK);
  int32_t task = -1;
  ASSERT_EQ(rdm_task_find("hand_over_safe_finger", &task), RDM_OK);
  ASSERT_EQ(rdm_task_camera_at(task, 1, &camera), RDM_OK);
  ASSERT_STREQ(camera.name, "top");  // looks straight down, world -x up
  const float pixel = 2 * std::tan(camera.fov_y / 2) / 30;
  for (int v = 0; v < 30; ++v)
    for (int u = 0; u < 40; ++u) {
      const float d = depth[static_cast<size_t>(40 * v + u)];
      if (d == 0) continue;
      points.push_back(camera.eye[0] + (static_cast<float>(v) + 0.5f - 15) * pixel * d);
      points.push_back(camera.eye[1] + (static_cast<float>(u) + 0.5f - 20) * pixel * d);
      points.push_back(camera.eye[2] - d);
    }
  ASSERT_GT(points.size(), 300u);
  distance.resize(points.size() / 3);
  ASSERT_EQ(rdm_map_get_distances(map.m, points.data(), distance.size(), 1, distance.data()), RDM_OK);
  size_t near = 0;
  for (const float d : distance) near += d < 0.03f;
  EXPECT_GT(near, distance.size() * 97 / 100);

  // a ray towards what the camera saw ends there
  size_t met = 0, cast = 0;
  for (size_t i = 0; i < points.size(); i += 21, ++cast) {
    const float* to = &points[i];
    const float way[3] = {to[0] - camera.eye[0], to[1] - camera.eye[1], to[2] - camera.eye[2]};
    float hit[3];
    int32_t found = 0;
    ASSERT_EQ(rdm_map_raycast(map.m, camera.eye, way, 3, 0, hit, &found), RDM_OK);
    met += found && std::hypot(hit[0] - to[0], hit[1] - to[1], hit[2] - to[2]) < 0.06f;
  }
  EXPECT_GT(met, cast * 9 / 10);

  // without the shapes that are left out, nothing of them is there
  rdm_map_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(rdm_map_clear(map.m), RDM_OK);
  std::vector<int32_t> all;
  rdm_shape_info s = RDM_INIT(rdm_shape_info);
  for (int32_t i = 0; rdm_pool_shape_at(p, i, &s) == RDM_OK; ++i) all.push_back(i);
  ASSERT_EQ(rdm_map_scan(map.m, p, 0, "top", 80, 60, all.data(), all.size(), nullptr), RDM_OK);
  ASSERT_EQ(rdm_map_get_info(map.m, &info), RDM_OK);
  EXPECT_EQ(info.nodes, 0u);
  rdm_pool_destroy(p);
}

TEST(Map, GridBoxAndTurnedBoxAgree) {
  const MapHandle map(0.1);
  const float origin[3] = {0.05f, 0.05f, 0.05f}, points[] = {0.55f, 0.05f, 0.05f, 0.05f, 0.95f, 0.05f};
  ASSERT_EQ(rdm_map_insert(map.m, origin, points, 2, nullptr), RDM_OK);
  float probability[2];
  ASSERT_EQ(rdm_map_get_probabilities(map.m, points, 2, probability), RDM_OK);
  EXPECT_GT(probability[0], 0.5f);
  EXPECT_GT(probability[1], 0.5f);
  const float low[3] = {0.5f, 0, 0}, high[3] = {0.6f, 0.1f, 0.1f};
  rdm_voxel voxel[4];
  size_t count = 0;
  ASSERT_EQ(rdm_map_get_voxels(map.m, low, high, voxel, 4, &count), RDM_OK);
  ASSERT_EQ(count, 1u);
  EXPECT_NEAR(voxel[0].centre[0], 0.55f, 1e-6f);
  EXPECT_NEAR(voxel[0].side, 0.1f, 1e-6f);
  // a quarter turn about z: the frame's x is the world's y
  const rdm_pose pose = {{0.05, 0.55, 0.05}, {0, 0, std::sqrt(0.5), std::sqrt(0.5)}};
  const float thin[3] = {0.45f, 0.01f, 0.01f};
  int32_t meets = -1;
  ASSERT_EQ(rdm_map_meets(map.m, &pose, thin, &meets), RDM_OK);
  EXPECT_EQ(meets, 1);
  const float short_one[3] = {0.3f, 0.01f, 0.01f};
  ASSERT_EQ(rdm_map_meets(map.m, &pose, short_one, &meets), RDM_OK);
  EXPECT_EQ(meets, 0);
  const int32_t n[3] = {9, 1, 1};
  int8_t grid[9];
  ASSERT_EQ(rdm_map_get_grid(map.m, &pose, n, 0.1f, grid), RDM_OK);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(grid[i], 0) << i;
  EXPECT_EQ(grid[8], 1);
}

// A depth camera says 0 where it saw nothing, rdm_pool_render too: unprojected that is the camera's own place.
TEST(Map, WhatIsNearerThanAVoxelIsNoObstacle) {
  const MapHandle map(0.02);
  const float origin[3] = {0, 0, 0.5f}, ahead[3] = {1, 0, 0}, half[3] = {0.05f, 0.05f, 0.05f};
  const rdm_pose pose = {{0, 0, 0.5}, {}};  // a q of all 0 is no turn
  const float points[4][3] = {{1, 0, 0.5f}, {0, 0, 0.5f}, {0.015f, 0, 0.5f}, {0, -0.019f, 0.5f}};
  ASSERT_EQ(rdm_map_insert(map.m, origin, points[0], 4, nullptr), RDM_OK);
  float hit[3] = {}, p = 0;
  int32_t found = 0;
  ASSERT_EQ(rdm_map_raycast(map.m, origin, ahead, 5, 1, hit, &found), RDM_OK);
  EXPECT_EQ(found, 1);
  EXPECT_NEAR(hit[0], 1, 0.02);
  ASSERT_EQ(rdm_map_get_probabilities(map.m, origin, 1, &p), RDM_OK);
  EXPECT_LT(p, 0.5f) << "the ray to the wall clears it";
  ASSERT_EQ(rdm_map_meets(map.m, &pose, half, &found), RDM_OK);
  EXPECT_EQ(found, 0);
  const float near[3] = {0, 0.03f, 0.5f};  // further than a voxel: it is one
  ASSERT_EQ(rdm_map_insert(map.m, origin, near, 1, nullptr), RDM_OK);
  ASSERT_EQ(rdm_map_get_probabilities(map.m, near, 1, &p), RDM_OK);
  EXPECT_GT(p, 0.5f);
}

TEST(Map, FilesAndBytesComeBack) {
  const std::string stem = ::testing::TempDir() + "redman_test_map_" + std::to_string(getpid());
  const MapHandle map(0.1), other(0.5);
  const float origin[3] = {0, 0, 0}, points[] = {1, 2, 3, -1, 0.5f, 0};
  ASSERT_EQ(rdm_map_insert(map.m, origin, points, 2, nullptr), RDM_OK);
  for (const char* ending : {".bt", ".ot"}) {
    const std::string path = stem + ending;
    ASSERT_EQ(rdm_map_write_file(map.m, path.c_str()), RDM_OK) << rdm_last_error();
    ASSERT_EQ(rdm_map_read_file(other.m, path.c_str()), RDM_OK) << rdm_map_error(other.m);
    float p[2];
    ASSERT_EQ(rdm_map_get_probabilities(other.m, points, 2, p), RDM_OK);
    EXPECT_GT(p[0], 0.5f);
    EXPECT_GT(p[1], 0.5f);
    std::remove(path.c_str());
    EXPECT_EQ(rdm_map_read_file(other.m, path.c_str()), RDM_ERROR_NOT_FOUND);
  }
  EXPECT_EQ(rdm_map_write_file(map.m, (stem + ".txt").c_str()), RDM_ERROR_ARGUMENT);
  size_t size = 0, again = 0;
  ASSERT_EQ(rdm_map_write(map.m, RDM_MAP_FULL, nullptr, 0, &size), RDM_OK);
  std::vector<char> bytes(size);
  EXPECT_EQ(rdm_map_write(map.m, RDM_MAP_FULL, bytes.data(), size - 1, &again), RDM_ERROR_RANGE);
  ASSERT_EQ(rdm_map_write(map.m, RDM_MAP_FULL, bytes.data(), size, &again), RDM_OK);
  EXPECT_EQ(rdm_map_read(other.m, bytes.data(), size / 2), RDM_ERROR_FORMAT);
  EXPECT_NE(std::string(rdm_map_error(other.m)), "");
  EXPECT_EQ(rdm_map_read(other.m, bytes.data(), size), RDM_OK);
}

TEST(Map, AFullOneSaysSo) {
  const MapHandle map(0.001, 1u << 20);
  std::vector<float> points;
  for (int i = 0; i < 3000; ++i) {
    const float a = static_cast<float>(i) * 0.01f;
    points.insert(points.end(), {3 * std::cos(a), 3 * std::sin(a), static_cast<float>(i) * 0.001f});
  }
  const float origin[3] = {0, 0, 0};
  uint64_t dropped = 0;
  EXPECT_EQ(rdm_map_insert(map.m, origin, points.data(), 3000, &dropped), RDM_OK);
  EXPECT_GT(dropped, 0u);
  rdm_map_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(rdm_map_get_info(map.m, &info), RDM_OK);
  EXPECT_EQ(info.full, 1u);
  EXPECT_EQ(info.dropped, dropped);
  EXPECT_LE(info.bytes, info.bytes_max);
}

TEST(Map, TheHostsMemoryIsGivenBack) {
  CountingHost host;
  {
    const MapHandle map(0.02, 1u << 22, &host.hooks);
    EXPECT_GT(host.live, 1000u);
    EXPECT_LE(host.live, 1u << 21);
    const float origin[3] = {0, 0, 0}, points[] = {1, 2, 3};
    const size_t calls = host.calls;
    EXPECT_EQ(rdm_map_insert(map.m, origin, points, 1, nullptr), RDM_OK);
    EXPECT_EQ(host.calls, calls);
  }
  EXPECT_EQ(host.live, 0u);
}

TEST(Map, BadArgumentsGetAnswersAndNothingIsPrinted) {
  Silence silence;
  const MapHandle map;
  rdm_map* m = nullptr;
  rdm_map_config c;
  ASSERT_EQ(rdm_map_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_map_config_init(nullptr, sizeof c), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_config_init(&c, 4), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_create(nullptr, &c), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_create(&m, nullptr), RDM_ERROR_ARGUMENT);
  c.resolution = NAN;
  EXPECT_EQ(rdm_map_create(&m, &c), RDM_ERROR_RANGE);
  EXPECT_NE(std::string(rdm_last_error()).find("resolution"), std::string::npos);
  rdm_map_config_init(&c, sizeof c);
  c.memory = 1;
  EXPECT_EQ(rdm_map_create(&m, &c), RDM_ERROR_RANGE);
  EXPECT_STREQ(rdm_last_error(), "memory: 1 is outside [1048576, 68719476736]");
  EXPECT_EQ(m, nullptr);
  const float p[3] = {0, 0, 0}, nan[3] = {NAN, 0, 0}, ahead[3] = {0, 0, 1};
  const rdm_pose pose{}, no_pose = {{0, 0, 0}, {0, 0, 0, 0.5}}, nowhere = {{NAN, 0, 0}, {}};
  float out[3];
  int8_t cell;
  int32_t flag, n[3] = {1, 1, 1}, none[3] = {0, 1, 1};
  size_t count;
  rdm_map_info info{};
  EXPECT_EQ(rdm_map_get_info(map.m, &info), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_get_info(nullptr, &info), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_clear(nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_insert(nullptr, p, p, 1, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_insert(map.m, nullptr, p, 1, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_insert(map.m, p, nullptr, 1, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_insert(map.m, nan, p, 1, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_insert(map.m, p, nullptr, 0, nullptr), RDM_OK);
  EXPECT_EQ(rdm_map_insert(map.m, p, p, SIZE_MAX, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_scan(map.m, nullptr, 0, "top", 8, 8, nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_get_probabilities(map.m, nullptr, 1, out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_get_probabilities(map.m, nan, 1, out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_get_voxels(map.m, p, nan, nullptr, 0, &count), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_get_voxels(map.m, p, p, nullptr, 1, &count), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_meets(map.m, &no_pose, p, &flag), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_meets(map.m, &nowhere, p, &flag), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_meets(map.m, &pose, nan, &flag), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_raycast(map.m, p, p, 1, 1, out, &flag), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_raycast(map.m, p, ahead, NAN, 1, out, &flag), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_get_distances(map.m, nan, 1, 1, out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_get_distances(map.m, p, 1, 0, out), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_get_grid(map.m, &pose, none, 0.1f, &cell), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_get_grid(map.m, &pose, n, 0, &cell), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_get_grid(map.m, &pose, n, 0.1f, &cell), RDM_OK);
  EXPECT_EQ(rdm_map_write(map.m, 2, nullptr, 0, &count), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_read(map.m, nullptr, 0), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_read(map.m, "x", 1), RDM_ERROR_FORMAT);
  rdm_map_destroy(nullptr);
  EXPECT_EQ(silence.restore(), "");
}

TEST(Map, BadScansAreRefused) {
  rdm_pool* p = make_world();
  const MapHandle map;
  EXPECT_EQ(rdm_map_scan(map.m, p, 2, "top", 8, 8, nullptr, 0, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_scan(map.m, p, 0, "topp", 8, 8, nullptr, 0, nullptr), RDM_ERROR_NOT_FOUND);
  EXPECT_EQ(rdm_map_scan(map.m, p, 0, nullptr, 8, 8, nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_scan(map.m, p, 0, "top", 0, 8, nullptr, 0, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_map_scan(map.m, p, 0, "top", 8, 8, nullptr, 1, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_map_scan(map.m, p, 0, "top", 8, 8, nullptr, static_cast<size_t>(-1), nullptr),
            RDM_ERROR_RANGE);
  rdm_pool_destroy(p);
}

}  // namespace

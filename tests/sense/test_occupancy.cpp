// Scans into maps: the same cells as OctoMap's own insertion, a bound on memory, bad input.
#include <octomap/OcTree.h>

#include <limits>

#include "occupancy_scenes.hpp"

namespace rdm {
namespace {

octomap::Pointcloud cloud_of(const Points& points) {
  octomap::Pointcloud cloud;
  for (size_t i = 0; i < points.size(); i += 3) cloud.push_back(points[i], points[i + 1], points[i + 2]);
  return cloud;
}

octomap::point3d to_octomap(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Share of the voxels of the room whose probability is the same in both.
double agreement(const Occupancy& map, const octomap::OcTree& tree, double resolution) {
  int same = 0, all = 0;
  const double first = -2.2 + 0.5 * resolution;
  for (double x = first; x < 2.2; x += resolution)
    for (double y = first; y < 2.2; y += resolution)
      for (double z = first; z < 2.2; z += resolution) {
        const octomap::OcTreeNode* node = tree.search(x, y, z);
        const double want = node ? node->getOccupancy() : -1, have = static_cast<double>(map.at({x, y, z}));
        same += std::abs(want - have) < 1e-5;
        ++all;
      }
  return static_cast<double>(same) / all;
}

TEST(Occupancy, IsWhatOctoMapMakesOfTheSameScans) {
  constexpr double kResolution = 0.05;
  const Map map = make_map(kResolution);
  octomap::OcTree tree(kResolution);
  for (int round = 0; round < 3; ++round)
    for (const Vec3& eye : kEyes) {
      const Points points = scan_room(eye);
      EXPECT_EQ(map->insert(eye, points.data(), points.size() / 3), 0u);
      tree.insertPointCloud(cloud_of(points), to_octomap(eye));
    }
  // rays are walked in double here and in float there: a cell that is only grazed may differ
  EXPECT_GT(agreement(*map, tree, kResolution), 0.999);
  EXPECT_NEAR(static_cast<double>(map->info().nodes), static_cast<double>(tree.size()),
              0.02 * static_cast<double>(tree.size()));
}

TEST(Occupancy, LongRaysClearAsFarAsTheyGo) {
  const Map map = make_map(0.1, 64u << 20, 1.0);
  const float points[] = {3.05f, 0.05f, 0.05f, 0.05f, 0.65f, 0.05f};
  map->insert({0.05, 0.05, 0.05}, points, 2);
  EXPECT_LT(map->at({0.85, 0.05, 0.05}), 0.5f);
  EXPECT_GE(map->at({0.85, 0.05, 0.05}), 0);
  EXPECT_EQ(map->at({1.55, 0.05, 0.05}), -1);
  EXPECT_EQ(map->at({3.05, 0.05, 0.05}), -1);
  EXPECT_GT(map->at({0.05, 0.65, 0.05}), 0.5f);
}

TEST(Occupancy, AVoxelThatARayEndsInIsNotClearedByItsScan) {
  const Map map = make_map(0.1);
  // the second ray passes through the voxel that the first ends in
  const float points[] = {0.55f, 0.05f, 0.05f, 0.95f, 0.05f, 0.05f};
  map->insert({0.05, 0.05, 0.05}, points, 2);
  EXPECT_NEAR(map->at({0.55, 0.05, 0.05}), 0.7, 1e-6);
  EXPECT_NEAR(map->at({0.45, 0.05, 0.05}), 0.4, 1e-6);
  for (int i = 0; i < 20; ++i) map->insert({0.05, 0.05, 0.05}, points, 2);
  EXPECT_NEAR(map->at({0.55, 0.05, 0.05}), 0.971, 1e-6);
  EXPECT_NEAR(map->at({0.45, 0.05, 0.05}), 0.1192, 1e-6);
  const float further[] = {0.95f, 0.05f, 0.05f};
  for (int i = 0; i < 20; ++i) map->insert({0.05, 0.05, 0.05}, further, 1);
  EXPECT_LT(map->at({0.55, 0.05, 0.05}), 0.5f) << "an obstacle that went away stays";
}

TEST(Occupancy, AFullMapSaysSoAndGrowsNoMore) {
  const Map map = make_map(0.01, 4u << 20);
  const Points first = scan_room(kEyes[0], 10, 20);
  ASSERT_EQ(map->insert(kEyes[0], first.data(), 40), 0u);
  const Points all = scan_room(kEyes[0]);
  const uint64_t dropped = map->insert(kEyes[0], all.data(), all.size() / 3);
  EXPECT_GT(dropped, 1000u);
  OccupancyInfo info = map->info();
  EXPECT_EQ(info.dropped, dropped);
  EXPECT_LE(info.bytes, info.bytes_max);
  EXPECT_GT(info.bytes, info.bytes_max - 20000);
  EXPECT_LT(info.bytes_max, 4u << 20);
  // what is known stays known and is still updated
  const float known = map->at({first[0], first[1], first[2]});
  ASSERT_GT(known, 0.5f);
  map->insert(kEyes[0], first.data(), 1);
  EXPECT_GT(map->at({first[0], first[1], first[2]}), known);
  map->clear();
  EXPECT_EQ(map->info().dropped, 0u);
  EXPECT_EQ(map->info().bytes, 0u);
  EXPECT_EQ(map->insert(kEyes[0], first.data(), 40), 0u);
}

TEST(Occupancy, TheCountOfBytesIsThatOfTheTree) {
  constexpr int kRounds = 12;  // voxels reach the bounds and are joined
  const Map map = make_map(0.1);
  octomap::OcTree tree(0.1);
  for (int i = 0; i < kRounds; ++i)
    for (const Vec3& eye : kEyes) {
      const Points points = scan_room(eye);
      map->insert(eye, points.data(), points.size() / 3);
      tree.insertPointCloud(cloud_of(points), to_octomap(eye));
    }
  const OccupancyInfo info = map->info();
  const auto nodes = static_cast<double>(tree.size()), leaves = static_cast<double>(tree.getNumLeafNodes());
  ASSERT_LT(leaves, 0.9 * 40 * 40 * 40) << "nothing was joined";
  EXPECT_NEAR(static_cast<double>(info.nodes), nodes, 0.02 * nodes);
  const size_t lists = (info.bytes - 32 * info.nodes) / 80;
  EXPECT_EQ(info.bytes, 32 * info.nodes + 80 * lists);
  EXPECT_NEAR(static_cast<double>(lists), nodes - leaves, 0.02 * (nodes - leaves));
}

TEST(Occupancy, AScanLargerThanTheWorkspaceIsTakenInParts) {
  // the small one lists 52,428 voxels at a time: this scan touches more, of which few are ends of rays
  const Map small = make_map(0.1, 8u << 20), large = make_map(0.1, 256u << 20);
  const Points points = scan_room(kEyes[1], 200, 400);
  EXPECT_EQ(small->insert(kEyes[1], points.data(), points.size() / 3), 0u);
  EXPECT_EQ(large->insert(kEyes[1], points.data(), points.size() / 3), 0u);
  EXPECT_GT(small->info().nodes, large->info().nodes) << "nothing was cleared twice: it was taken whole";
  for (size_t i = 0; i < points.size(); i += 300) {
    const Vec3 p{points[i], points[i + 1], points[i + 2]};
    EXPECT_EQ(small->at(p), large->at(p));
    EXPECT_EQ(occupied(small->at(0.5 * p)), occupied(large->at(0.5 * p)));
  }
}

TEST(Occupancy, BadInputIsRefusedOrLeftOut) {
  const auto with = [](auto change) {
    OccupancyConfig c;
    change(c);
    return code_of([&] { Map(Occupancy::create(c, {})); });
  };
  EXPECT_EQ(with([](auto&) {}), Code::kOk);
  EXPECT_EQ(with([](auto& c) { c.resolution = 0; }), Code::kRange);
  EXPECT_EQ(with([](auto& c) { c.resolution = NAN; }), Code::kRange);
  EXPECT_EQ(with([](auto& c) { c.memory = 1000; }), Code::kRange);
  EXPECT_EQ(with([](auto& c) { c.max_range = -1; }), Code::kRange);
  EXPECT_EQ(with([](auto& c) { c.hit = 0.4; }), Code::kRange);
  EXPECT_EQ(with([](auto& c) { c.miss = 0.6; }), Code::kRange);
  EXPECT_EQ(with([](auto& c) { c.threshold = 0.99; }), Code::kRange);

  const Map map = make_map(0.1);
  const float inf = std::numeric_limits<float>::infinity();
  const float points[] = {NAN, 0, 0, inf, 1, 1, 1e30f, 0, 0, 0.55f, 0.05f, 0.05f};
  EXPECT_EQ(code_of([&] { map->insert({NAN, 0, 0}, points, 4); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { map->insert({1e9, 0, 0}, points, 4); }), Code::kRange);
  EXPECT_EQ(map->info().nodes, 0u);
  EXPECT_EQ(map->insert({0.05, 0.05, 0.05}, points, 4), 0u);
  EXPECT_GT(map->at({0.55, 0.05, 0.05}), 0.5f);
  EXPECT_EQ(map->at({NAN, 0, 0}), -1);
  EXPECT_EQ(map->at({1e20, 0, 0}), -1);
  map->insert({0, 0, 0}, nullptr, 0);
}

}  // namespace
}  // namespace rdm

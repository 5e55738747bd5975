// Depth pictures to points on the shapes that were seen, and their thinning.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "sense/cloud/cloud.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

struct Room {
  Room() {
    RenderShape ball;
    ball.kind = ShapeKind::kSphere;
    ball.size = {0.3, 0, 0};
    ball.X_WS.p = {0.1, 0.2, 0.3};
    ball.id = 4;
    RenderShape box;
    box.kind = ShapeKind::kBox;
    box.size = {0.2, 0.1, 0.15};
    box.X_WS = {{-0.6, 0.1, 0.2}, from_rpy({0.3, 0.2, 0.5})};
    box.id = 7;
    shapes = {ball, box};
    camera = {"test", {0.2, -2, 1.3}, {0, 0, 0.2}, 0.9};
    view = make_view(camera, 80, 60);
    depth.resize(4800);
    segmentation.resize(4800);
    Arena measure;
    carve_raycast_scratch(measure, 2);
    Arena arena({}, measure.used());
    render(shapes.data(), 2, camera, {80, 60, nullptr, depth.data(), segmentation.data()}, {},
           carve_raycast_scratch(arena, 2));
  }
  std::vector<RenderShape> shapes;
  Camera camera;
  View view;
  std::vector<float> depth;
  std::vector<int32_t> segmentation;
};

struct Scratch {
  Scratch(int32_t most, Thinning thinning) {
    Arena measure;
    carve_cloud_scratch(measure, most, thinning);
    arena = Arena({}, measure.used());
    s = carve_cloud_scratch(arena, most, thinning);
  }
  Arena arena;
  CloudScratch s;
};

struct Thinned {
  std::vector<float> points;
  std::vector<int32_t> shape;
  int32_t count = 0;
};
Thinned thin(Thinning how, int32_t wanted, Scratch& scratch, uint64_t seed = 1, double voxel = 0.05) {
  Thinned t;
  t.points.resize(3 * static_cast<size_t>(wanted));
  t.shape.resize(static_cast<size_t>(wanted));
  Stream stream(seed, 0, Purpose::kSense);
  Cloud out{t.points.data(), t.shape.data(), 0};
  thin_cloud(how, wanted, voxel, stream, scratch.s, &out);
  t.count = out.count;
  return t;
}

TEST(Cloud, PointsLieOnTheShapesThatWereSeen) {
  const Room room;
  Scratch scratch(4800, Thinning::kRandom);
  append_points(room.view, room.depth.data(), room.segmentation.data(), {0, 0, 0}, 10, &scratch.s.all);
  const Cloud& all = scratch.s.all;
  ASSERT_GT(all.count, 250);
  int seen[8] = {};
  for (int32_t i = 0; i < all.count; ++i) {
    const float* p = all.points + 3 * i;
    const RenderShape& s = room.shapes[all.shape[i] == 4 ? 0 : 1];
    const Vec3 local = inverse(s.X_WS) * Vec3{p[0], p[1], p[2]};
    EXPECT_NEAR(signed_distance(s.kind, s.size, local), 0, 2e-6);
    ++seen[all.shape[i]];
  }
  EXPECT_GT(seen[4], 100);
  EXPECT_GT(seen[7], 50);
}

TEST(Cloud, FarPointsAreLeftOutAndPicturesAddUp) {
  const Room room;
  Scratch scratch(9600, Thinning::kRandom);
  const Vec3 ball = room.shapes[0].X_WS.p;
  append_points(room.view, room.depth.data(), room.segmentation.data(), ball, 0.301, &scratch.s.all);
  const int32_t once = scratch.s.all.count;
  EXPECT_GT(once, 100);
  for (int32_t i = 0; i < once; ++i) EXPECT_EQ(scratch.s.all.shape[i], 4);
  append_points(room.view, room.depth.data(), room.segmentation.data(), ball, 0.301, &scratch.s.all);
  EXPECT_EQ(scratch.s.all.count, 2 * once);
}

class EveryThinning : public testing::TestWithParam<Thinning> {};

TEST_P(EveryThinning, ChoosesDifferentPointsOfTheCloudAndRepeatsTheRest) {
  const Room room;
  Scratch scratch(4800, GetParam());
  append_points(room.view, room.depth.data(), room.segmentation.data(), {0, 0, 0}, 10, &scratch.s.all);
  const Cloud& all = scratch.s.all;
  std::set<std::array<float, 3>> known;
  for (int32_t i = 0; i < all.count; ++i)
    known.insert({all.points[3 * i], all.points[3 * i + 1], all.points[3 * i + 2]});
  for (const int32_t wanted : {1, 7, 64, 2048}) {
    const Thinned t = thin(GetParam(), wanted, scratch);
    std::set<std::array<float, 3>> got;
    for (size_t i = 0; i < t.shape.size(); ++i) {
      const std::array<float, 3> p{t.points[3 * i], t.points[3 * i + 1], t.points[3 * i + 2]};
      EXPECT_TRUE(known.count(p));
      got.insert(p);
      const size_t first = i % static_cast<size_t>(t.count);
      EXPECT_EQ(t.points[3 * i], t.points[3 * first]);
      EXPECT_EQ(t.shape[i], t.shape[first]);
    }
    EXPECT_EQ(static_cast<int32_t>(got.size()), t.count);
    EXPECT_TRUE(GetParam() == Thinning::kVoxel || t.count == std::min(wanted, all.count));
    // the same stream gives the same points, another gives others
    EXPECT_EQ(thin(GetParam(), wanted, scratch).points, t.points);
    EXPECT_TRUE(wanted != 64 || thin(GetParam(), wanted, scratch, 2).points != t.points);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryThinning,
                         testing::Values(Thinning::kFurthest, Thinning::kRandom, Thinning::kVoxel));

TEST(Cloud, OnePointOfEachVoxel) {
  const Room room;
  Scratch scratch(4800, Thinning::kVoxel);
  append_points(room.view, room.depth.data(), room.segmentation.data(), {0, 0, 0}, 10, &scratch.s.all);
  const auto cell = [](const float* p) {
    return std::array<int, 3>{static_cast<int>(std::floor(p[0] * 20.0)),
                              static_cast<int>(std::floor(p[1] * 20.0)),
                              static_cast<int>(std::floor(p[2] * 20.0))};
  };
  std::set<std::array<int, 3>> want, have;
  for (int32_t i = 0; i < scratch.s.all.count; ++i) want.insert(cell(scratch.s.all.points + 3 * i));
  const Thinned t = thin(Thinning::kVoxel, 2048, scratch);
  for (int32_t i = 0; i < t.count; ++i)
    EXPECT_TRUE(have.insert(cell(&t.points[3 * static_cast<size_t>(i)])).second);
  EXPECT_EQ(have, want);
}

TEST(Cloud, PointsBeyondTheLatticeOfVoxelsAreNothingSeen) {
  Scratch scratch(10, Thinning::kVoxel);
  scratch.s.all.count = 10;
  for (int i = 0; i < 30; ++i) scratch.s.all.points[i] = 1e9f;
  const Thinned t = thin(Thinning::kVoxel, 5, scratch);
  EXPECT_EQ(t.count, 0);
  EXPECT_EQ(t.points, std::vector<float>(15));
  EXPECT_EQ(t.shape, std::vector<int32_t>(5, -1));
}

TEST(Cloud, NothingSeenIsSaid) {
  Scratch scratch(10, Thinning::kFurthest);
  const Thinned t = thin(Thinning::kFurthest, 5, scratch);
  EXPECT_EQ(t.count, 0);
  EXPECT_EQ(t.points, std::vector<float>(15));
  EXPECT_EQ(t.shape, std::vector<int32_t>(5, -1));
}

// Of 2000 points 2000 (1 - dropout) are left, within four deviations, each off by `noise`.
TEST(Cloud, ADisturbedOneLosesPointsAndMovesTheOthers) {
  constexpr int32_t kPoints = 2000;
  std::vector<float> points(3 * kPoints);
  std::vector<int32_t> shape(kPoints);
  Cloud cloud{points.data(), shape.data(), 0};
  const auto refill = [&] {
    for (int32_t i = 0; i < kPoints; ++i) {
      points[3 * static_cast<size_t>(i)] = static_cast<float>(i);
      points[3 * static_cast<size_t>(i) + 1] = points[3 * static_cast<size_t>(i) + 2] = 0;
      shape[static_cast<size_t>(i)] = i;
    }
    cloud.count = kPoints;
  };
  for (const double dropout : {0.0, 0.3, 0.9}) {
    refill();
    Stream stream(5, 0, Purpose::kSense);
    disturb_cloud(0.01, dropout, kPoints, stream, &cloud);
    const double left = kPoints * (1 - dropout);
    EXPECT_NEAR(cloud.count, left, 4 * std::sqrt(left * dropout) + 0.5) << dropout;
    double sum = 0, square = 0;
    for (size_t i = 0; i < kPoints; ++i) {
      const size_t first = i % static_cast<size_t>(cloud.count);
      EXPECT_EQ(shape[i], shape[first]);
      EXPECT_EQ(points[3 * i + 1], points[3 * first + 1]);
      EXPECT_NEAR(points[3 * i], static_cast<float>(shape[i]), 0.06);
      if (i == first) sum += static_cast<double>(points[3 * i + 1]), square += std::pow(points[3 * i + 1], 2);
    }
    EXPECT_NEAR(sum / cloud.count, 0, 0.04 / std::sqrt(cloud.count));
    EXPECT_NEAR(std::sqrt(square / cloud.count), 0.01, 0.03 / std::sqrt(cloud.count));
    const auto once = points;
    refill();
    Stream again(5, 0, Purpose::kSense);
    disturb_cloud(0.01, dropout, kPoints, again, &cloud);
    EXPECT_EQ(points, once);
  }
  refill();
  Stream stream(5, 0, Purpose::kSense);
  disturb_cloud(0, 1, kPoints, stream, &cloud);
  EXPECT_EQ(cloud.count, 0);
  EXPECT_EQ(shape[7], -1);
  EXPECT_EQ(points[21], 0);
}

}  // namespace
}  // namespace rdm

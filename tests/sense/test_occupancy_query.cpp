// Questions to a map against the same answers found by trying every voxel, and against the room that was
// scanned.
#include "base/rng.hpp"
#include "occupancy_scenes.hpp"

namespace rdm {
namespace {

struct Scanned {
  Scanned() : map(make_map()) {
    scan_all(*map);
    map->box({-3, -3, -3}, {3, 3, 3}, [&](const OccupiedVoxel& v) { voxels.push_back(v); });
  }
  Map map;
  std::vector<OccupiedVoxel> voxels;
};
const Scanned& scanned() {
  static const Scanned s;
  return s;
}

Vec3 random_point(Stream& stream, double reach) {
  float v[3];
  stream.signed_units(v, 3);
  return {reach * static_cast<double>(v[0]), reach * static_cast<double>(v[1]),
          reach * static_cast<double>(v[2])};
}

TEST(OccupancyQuery, SurfacesAreOccupiedAndTheWayToThemIsFree) {
  const auto& map = *scanned().map;
  // a voxel may also be passed by many rays of other scans: some surface cells are lost at a grazing angle
  int hits = 0, clear = 0, all = 0;
  for (const Vec3& eye : kEyes) {
    const Points points = scan_room(eye);
    for (size_t i = 0; i < points.size(); i += 3) {
      const Vec3 p{points[i], points[i + 1], points[i + 2]};
      hits += occupied(map.at(p));
      const float before = map.at(eye + 0.5 * (p - eye));
      clear += before >= 0 && !occupied(before);
      ++all;
    }
  }
  EXPECT_GT(hits, 0.97 * all);
  EXPECT_GT(clear, 0.99 * all);
  EXPECT_EQ(map.at({0, 0, 0}), -1) << "nobody has seen the inside of the ball";
  EXPECT_EQ(map.at({5, 0, 0}), -1);
}

TEST(OccupancyQuery, ABoxFindsWhatMeetsItAndNothingElse) {
  const auto& s = scanned();
  ASSERT_GT(s.voxels.size(), 1000u);
  Stream stream(1, 0, Purpose::kReset);
  for (int k = 0; k < 200; ++k) {
    const Vec3 a = random_point(stream, 2.5), half = random_point(stream, 0.4);
    const Vec3 low{a.x - std::abs(half.x), a.y - std::abs(half.y), a.z - std::abs(half.z)},
        high = a + a - low;
    size_t want = 0, have = 0;
    for (const OccupiedVoxel& v : s.voxels) {
      bool meets = true;
      for (int i = 0; i < 3; ++i)
        meets &= v.centre[i] - 0.5 * v.side <= high[i] && v.centre[i] + 0.5 * v.side >= low[i];
      want += meets;
    }
    s.map->box(low, high, [&](const OccupiedVoxel&) { ++have; });
    EXPECT_EQ(have, want);
    EXPECT_EQ(s.map->meets_box({a, {}}, a - low), want > 0);
  }
}

TEST(OccupancyQuery, ATurnedBoxMeetsTheVoxelsThatItsPointsLieIn) {
  const auto& s = scanned();
  Stream stream(2, 0, Purpose::kReset);
  int met = 0;
  for (int k = 0; k < 300; ++k) {
    const Vec3 p = random_point(stream, 2);
    const Pose X{p, axis_angle(normalized(random_point(stream, 1)), 3)};
    const Vec3 half{0.3, 0.15, 0.05};
    bool inside = false;
    for (int i = -12; i <= 12 && !inside; ++i)
      for (int j = -6; j <= 6; ++j)
        for (int l = -2; l <= 2; ++l)
          inside |= occupied(s.map->at(X * Vec3{i * half.x / 12, j * half.y / 6, l * half.z / 2}));
    const bool meets = s.map->meets_box(X, half);
    EXPECT_TRUE(meets || !inside);
    met += meets;
    // a box that is far from every occupied voxel meets none
    EXPECT_FALSE(meets && s.map->distance(p, 1) > norm(half));
    // a ball inside the box
    EXPECT_TRUE(meets || s.map->distance(p, 1) >= half.z);
  }
  EXPECT_GT(met, 20);
  EXPECT_LT(met, 280);
}

TEST(OccupancyQuery, DistanceIsTheSmallestOfAll) {
  const auto& s = scanned();
  Stream stream(3, 0, Purpose::kReset);
  for (int k = 0; k < 300; ++k) {
    const Vec3 p = random_point(stream, 3);
    double want = 100;
    for (const OccupiedVoxel& v : s.voxels) {
      double sum = 0;
      for (int i = 0; i < 3; ++i) {
        const double d = std::max(0.0, std::abs(p[i] - v.centre[i]) - 0.5 * v.side);
        sum += d * d;
      }
      want = std::min(want, std::sqrt(sum));
    }
    EXPECT_NEAR(s.map->distance(p, 100), want, 1e-9);
    EXPECT_NEAR(s.map->distance(p, 0.2), std::min(want, 0.2), 1e-9);
  }
  const Map empty = make_map();
  EXPECT_EQ(empty->distance({0, 0, 0}, 3), 3);
}

TEST(OccupancyQuery, RaysEndAtTheWallOrTheBall) {
  const auto& map = *scanned().map;
  Vec3 hit;
  ASSERT_TRUE(map.cast({1.41, 0.13, 0.27}, {-10, -0.5, -1}, 10, true, &hit));
  EXPECT_NEAR(norm(hit), 0.5, 0.1);
  ASSERT_TRUE(map.cast({1.41, 0.13, 0.27}, {1, 0, 0}, 10, true, &hit));
  EXPECT_NEAR(hit.x, 1.95, 1e-9);
  EXPECT_NEAR(hit.y, 0.13, 1e-9);
  EXPECT_FALSE(map.cast({1.41, 0.13, 0.27}, {1, 0, 0}, 0.3, true, &hit));
  // from within the ball, unknown voxels stop a ray unless they may be passed
  EXPECT_FALSE(map.cast({0, 0, 0}, {1, 0, 0}, 10, false, &hit));
  EXPECT_TRUE(map.cast({0, 0, 0}, {1, 0, 0}, 10, true, &hit));
  // the entry is on the face of the voxel
  Stream stream(4, 0, Purpose::kReset);
  for (int k = 0; k < 300; ++k) {
    const Vec3 d = normalized(random_point(stream, 1));
    if (!map.cast(kEyes[1], d, 6, true, &hit)) continue;
    EXPECT_TRUE(occupied(map.at(hit + 1e-6 * d)));
    EXPECT_LT(map.distance(hit, 1), 1e-9);
    for (double t = 0.01; t < norm(hit - kEyes[1]) - 1e-6; t += 0.01)
      EXPECT_FALSE(occupied(map.at(kEyes[1] + t * d)));
  }
  EXPECT_EQ(code_of([&] { map.cast({0, 0, 0}, {0, 0, 0}, 1, true, &hit); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { map.cast({NAN, 0, 0}, {0, 1, 0}, 1, true, &hit); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { map.cast({1e9, 0, 0}, {0, 1, 0}, 1, true, &hit); }), Code::kRange);
  EXPECT_EQ(code_of([&] { map.cast({0, 0, 0}, {0, 1, 0}, 0, true, &hit); }), Code::kRange);
  EXPECT_FALSE(map.cast({0, 0, 5}, {0, 0, 1}, 1e300, true, &hit)) << "to the border of the lattice";
}

TEST(OccupancyQuery, AGridIsPointQuestionsInATurnedFrame) {
  const auto& map = *scanned().map;
  const Pose X{{0.3, 0.2, -0.1}, from_rpy({0.4, -0.7, 1.1})};
  const int32_t n[3] = {9, 7, 5};
  std::vector<int8_t> out(9 * 7 * 5);
  map.grid(X, n, 0.13, out.data());
  const int8_t* at = out.data();
  int seen[3] = {};
  for (int x = -4; x <= 4; ++x)
    for (int y = -3; y <= 3; ++y)
      for (int z = -2; z <= 2; ++z, ++at) {
        const float p = map.at(X * Vec3{0.13 * x, 0.13 * y, 0.13 * z});
        EXPECT_EQ(*at, p < 0 ? -1 : occupied(p));
        ++seen[*at + 1];
      }
  EXPECT_GT(seen[0], 0);
  EXPECT_GT(seen[1], 0);
  EXPECT_GT(seen[2], 0);
}

}  // namespace
}  // namespace rdm

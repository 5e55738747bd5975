#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/rng.hpp"
#include "hulls.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

Hull hull_of(const std::vector<Vec3>& points) {
  return make_hull(points.data(), static_cast<int32_t>(points.size()), "test");
}
TEST(Hull, ABoxHasSixFlatFacesAndABoxsMass) {
  const Vec3 half = {0.02, 0.05, 0.03};
  const Pose X = {{0.4, -0.3, 0.2}, axis_angle(normalized(Vec3{1, 2, 3}), 0.7)};
  const Hull hull = block_hull(half, half, X);
  EXPECT_EQ(hull.num_points, 8);
  ASSERT_EQ(hull.num_faces, 6);
  for (int32_t f = 0; f < 6; ++f) {
    const Hull::Face& face = hull.faces[f];
    ASSERT_EQ(face.count, 4);
    for (int32_t i = 0; i < 4; ++i) {
      const Vec3 &p = hull.corner(face, i), &q = hull.corner(face, (i + 1) % 4);
      EXPECT_NEAR(dot(face.n, p), face.offset, 1e-12);
      // counterclockwise from outside
      EXPECT_GT(dot(cross(q - p, hull.corner(face, (i + 2) % 4) - q), face.n), 0);
    }
  }
  EXPECT_NEAR(hull.volume, 8 * half.x * half.y * half.z, 1e-15);
  const Inertia expected = transformed(box_inertia(0.7, half), X), found = hull_inertia(0.7, hull);
  EXPECT_LT(norm(found.com - expected.com), 1e-12);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(found.moment[i], expected.moment[i], 1e-12);
}

TEST(Hull, ATetrahedronsMomentIsItsClosedForm) {
  const double a = 0.1;  // legs along the axes from one corner
  const Hull hull = hull_of({{0, 0, 0}, {a, 0, 0}, {0, a, 0}, {0, 0, a}});
  EXPECT_EQ(hull.num_faces, 4);
  EXPECT_NEAR(hull.volume, a * a * a / 6, 1e-16);
  EXPECT_LT(norm(hull.com - Vec3{a / 4, a / 4, a / 4}), 1e-15);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(hull.moment[i], 3 * a * a / 40, 1e-15);
    EXPECT_NEAR(hull.moment[3 + i], a * a / 80, 1e-15);
  }
}

TEST(Hull, PointsThatAreNoCornersCountForNothing) {
  const Hull& box = kept_hull({0.03, 0.03, 0.03});
  std::vector<Vec3> points(box.points, box.points + 8);
  for (const Vec3& p : {Vec3{}, Vec3{0.03, 0, 0}, Vec3{0.03, 0.03, 0.01}, Vec3{0.03, 0.03, 0.03}})
    points.insert(points.begin() + 2, p);
  const Hull hull = hull_of(points);
  EXPECT_EQ(hull.num_points, 8);
  EXPECT_EQ(hull.num_faces, 6);
  EXPECT_NEAR(hull.volume, 8 * std::pow(0.03, 3), 1e-15);
}

TEST(Hull, OfAnyPointsItHoldsThemAll) {
  Stream stream(3, 0, Purpose::kTest);
  for (int t = 0; t < 200; ++t) {
    std::vector<Vec3> points(static_cast<size_t>(4 + stream.next() % 29));
    for (Vec3& p : points) {
      for (int k = 0; k < 3; ++k) p[k] = stream.signed_unit();
      if (t % 2 == 0) p = normalized(p);
      if (t % 3 == 0)  // a grid: many points in one plane
        for (int k = 0; k < 3; ++k) p[k] = std::round(2 * p[k]) / 2;
    }
    Hull hull;
    if (guard([&] { hull = hull_of(points); }) != Code::kOk) {
      EXPECT_TRUE(t % 3 == 0 || points.size() < 8) << t;  // a few points of a grid can be flat
      continue;
    }
    for (int32_t f = 0; f < hull.num_faces; ++f)
      for (const Vec3& p : points) EXPECT_LE(dot(hull.faces[f].n, p), hull.faces[f].offset + 1e-5);
    // by the divergence theorem over its faces
    double volume = 0;
    for (int32_t f = 0; f < hull.num_faces; ++f) {
      const Hull::Face& face = hull.faces[f];
      Vec3 area;
      for (int32_t i = 0; i < face.count; ++i)
        area += 0.5 * cross(hull.corner(face, i), hull.corner(face, (i + 1) % face.count));
      volume += dot(face.n, area) * face.offset / 3;
    }
    EXPECT_NEAR(hull.volume, volume, 1e-5);
  }
}

TEST(Hull, RefusesWhatIsNoSolid) {
  const auto refused = [](const std::vector<Vec3>& points) { return guard([&] { hull_of(points); }); };
  EXPECT_EQ(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), Code::kRange);
  EXPECT_EQ(refused(std::vector<Vec3>(33, Vec3{})), Code::kRange);
  EXPECT_EQ(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), Code::kArgument);     // one plane
  EXPECT_EQ(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1e-5}}), Code::kArgument);  // nearly
  EXPECT_EQ(refused({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}), Code::kArgument);     // one line
  EXPECT_EQ(refused(std::vector<Vec3>(8, Vec3{1, 2, 3})), Code::kArgument);              // one point
  EXPECT_EQ(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, HUGE_VAL}}), Code::kArgument);
  EXPECT_EQ(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e4}}), Code::kRange);
  EXPECT_NE(std::string(last_error()).find("test: point 3"), std::string::npos);
}

// A moment is a fifth power of a size over a third: of 1e-70 m it is lost in rounding and comes out negative.
TEST(Hull, RefusesWhatIsTooSmallToWeigh) {
  for (const double a : {1e-7, 1e-20, 1e-70, 1e-150, 1e-300})
    EXPECT_EQ(guard([&] { hull_of({{0, 0, 0}, {a, 0, 0}, {0, a, 0}, {0, 0, a}}); }), Code::kArgument) << a;
  const double a = 1e-5;
  EXPECT_GT(hull_of({{0, 0, 0}, {a, 0, 0}, {0, a, 0}, {0, 0, a}}).moment[0], 0);
}

}  // namespace
}  // namespace rdm

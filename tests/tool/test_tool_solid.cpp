// Surfaces of shapes are closed, look outwards and lie where the shape ends; bytes of event files are as
// specified.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "draw/solid.hpp"
#include "run/events.hpp"
#include "web/page.hpp"

namespace tool {
namespace {

std::array<double, 3> at(const std::vector<float>& list, size_t i) {
  return {static_cast<double>(list[3 * i]), static_cast<double>(list[3 * i + 1]),
          static_cast<double>(list[3 * i + 2])};
}

// Volume inside, by the divergence theorem: right only for a closed surface that looks outwards.
double volume(const Solid& s) {
  double sum = 0;
  for (size_t t = 0; t < s.triangles.size(); t += 3) {
    const auto a = at(s.points, s.triangles[t]), b = at(s.points, s.triangles[t + 1]),
               c = at(s.points, s.triangles[t + 2]);
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

// Every edge is passed once in each direction, by where its ends are.
void expect_closed(const Solid& s) {
  using Point = std::array<long, 3>;
  const auto place = [&](size_t i) {
    const auto p = at(s.points, i);
    return Point{std::lround(p[0] * 1e6), std::lround(p[1] * 1e6), std::lround(p[2] * 1e6)};
  };
  std::map<std::pair<Point, Point>, int> edges;
  for (size_t t = 0; t < s.triangles.size(); t += 3)
    for (size_t k = 0; k < 3; ++k) {
      const Point a = place(s.triangles[t + k]), b = place(s.triangles[t + (k + 1) % 3]);
      EXPECT_NE(a, b);
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
}

void expect_normals(const Solid& s) {
  ASSERT_EQ(s.points.size(), s.normals.size());
  for (size_t i = 0; i < s.points.size() / 3; ++i) {
    const auto p = at(s.points, i), n = at(s.normals, i);
    EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
    EXPECT_GE(p[0] * n[0] + p[1] * n[1] + p[2] * n[2], -1e-6);  // the origin is inside
  }
}

void expect_good(const Solid& s, double true_volume, double share) {
  expect_closed(s);
  expect_normals(s);
  EXPECT_NEAR(volume(s), true_volume, share * true_volume);
}

TEST(Solid, RoundShapes) {
  const float radii[3] = {0.03f, 0.04f, 0.05f};
  expect_good(make_ellipsoid(radii), 4.0 / 3 * M_PI * 0.03 * 0.04 * 0.05, 0.04);
  expect_good(make_cylinder(0.02f, 0.1f, false), M_PI * 0.02 * 0.02 * 0.2, 0.02);
  expect_good(make_cylinder(0.02f, 0.1f, true), M_PI * 0.02 * 0.02 * (0.2 + 4.0 / 3 * 0.02), 0.03);
}

TEST(Solid, Box) {
  const float half[3] = {0.1f, 0.2f, 0.3f};
  expect_good(make_box(half), 8 * 0.1 * 0.2 * 0.3, 1e-5);
}

TEST(Solid, HullOfABoxWithPointsOnItsFaces) {
  std::vector<float> corners;
  for (const float x : {-1.f, 1.f})
    for (const float y : {-1.f, 1.f})
      for (const float z : {-1.f, 1.f}) corners.insert(corners.end(), {0.1f * x, 0.2f * y, 0.3f * z});
  const Solid s = make_hull(corners);
  expect_good(s, 8 * 0.1 * 0.2 * 0.3, 1e-5);
  EXPECT_EQ(s.triangles.size(), 36u);
}

TEST(Solid, HullOfATetrahedron) {
  expect_good(make_hull({1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1}), 8.0 / 3, 1e-5);
}

TEST(Solid, SquareIsSeenFromAbove) {
  const Solid s = make_square(1, 2, 0.5f);
  EXPECT_EQ(s.triangles.size(), 6u);
  EXPECT_EQ(at(s.normals, 0)[2], 1);
}

TEST(Events, SumIsCastagnolis) {
  EXPECT_EQ(crc32c("123456789"), 0xe3069283u);            // the check value of the catalogue of CRCs
  EXPECT_EQ(crc32c(std::string(32, '\0')), 0x8a9136aau);  // RFC 3720, B.4
}

TEST(Events, RowsThatAreNoneAreLeftOut) {
  const std::string header = "TotalEnvSteps,Metrics/EpRet,Time/Total";
  EXPECT_EQ(event_row(header, "nan,1,2", 100), "");
  EXPECT_EQ(event_row(header, "10,1", 100), "");
  EXPECT_EQ(event_row("", "", 100), "");
  const std::string row = event_row(header, "10,nan,2", 100);
  EXPECT_EQ(row.find("Metrics/EpRet"), std::string::npos);
  EXPECT_NE(row.find("Time/Total"), std::string::npos);
  EXPECT_EQ(event_bytes(header + "\n10,nan,2\n11,", 100), event_head(100) + row);  // a row that was cut short
}

TEST(Page, PartsAreFilledOnce) {
  EXPECT_EQ(base64("a", 1) + base64("ab", 2) + base64("abc", 3), "YQ==YWI=YWJj");
  EXPECT_EQ(script_json("{\"a\":\"</script>\"}"), "{\"a\":\"\\u003c/script>\"}");
  const std::string page =
      filled_page("report.html", {{"title", "{{body}}"}, {"about", "&"}, {"body", "B"}, {"data", "{}"}});
  EXPECT_NE(page.find("<title>{{body}}</title>"), std::string::npos);
  EXPECT_EQ(page.find("{{data}}"), std::string::npos);
  EXPECT_THROW(filled_page("report.html", {}), std::runtime_error);
  EXPECT_THROW(filled_page("none.html", {}), std::runtime_error);
}

}  // namespace
}  // namespace tool

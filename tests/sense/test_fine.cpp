// Pictures for people: round edges, half shadows, floors that mirror, and what they leave as it is.
#include <gtest/gtest.h>

#include "heap_count.hpp"
#include "sense/render/fine.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

constexpr RenderOptions kFine{.fine = true}, kFineSlowly{.cull = false, .fine = true};
const Camera kAside = look({1.2, 0.3, 0.5}, {0, 0, 0});

std::vector<RenderShape> finished_crowd(uint64_t seed, int count) {
  std::vector<RenderShape> shapes = crowd(seed, count);
  int i = 0;
  for (RenderShape& s : shapes) {
    s.finish = static_cast<Finish>(i++ % 8);
    if (s.kind == ShapeKind::kBox || s.kind == ShapeKind::kHull)
      s.round = 0.3 * std::min({s.size.x, s.size.y, s.size.z});
  }
  return shapes;
}

TEST(Fine, CullingChangesNoByte) {
  const Camera cameras[] = {kAside, look({0, 0, 2}, {0, 0, 0}), look({3, 3, 0.2}, {0, 0, 0.4}, 0.3)};
  const std::vector<RenderShape> shapes = finished_crowd(21, 50);
  for (const Camera& camera : cameras)
    EXPECT_EQ(take(shapes, camera, 83, 58, kFine).rgb, take(shapes, camera, 83, 58, kFineSlowly).rgb);
}

TEST(Fine, ChangesColoursAlone) {
  const std::vector<RenderShape> shapes = crowd(2, 20);  // no round edges
  const Picture plain = take(shapes, kAside, 64, 48), fine = take(shapes, kAside, 64, 48, kFine);
  EXPECT_EQ(plain.depth, fine.depth);
  EXPECT_EQ(plain.segmentation, fine.segmentation);
  EXPECT_NE(plain.rgb, fine.rgb);
}

TEST(Fine, NoHeap) {
  const std::vector<RenderShape> shapes = finished_crowd(3, 60);
  OwnScratch own;
  Picture p(64, 64);
  const int64_t calls = heap_count();
  render(shapes.data(), static_cast<int32_t>(shapes.size()), kAside, p.image(), kFine, own.scratch);
  EXPECT_EQ(heap_count(), calls);
}

// Distance to a box whose edges have a radius, and its gradient's sign along a ray, by sphere tracing in double.
double round_box_distance(const Vec3& size, double r, const Vec3& p) {
  return signed_distance(ShapeKind::kBox, {size.x - r, size.y - r, size.z - r}, p) - r;
}

TEST(Fine, RaysMeetRoundBoxesWhereTheyAre) {
  Draw draw(5);
  int hits = 0, misses = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 size{draw.uniform(0.01, 0.06), draw.uniform(0.01, 0.12), draw.uniform(0.01, 0.06)};
    RenderShape shape = make_shape(ShapeKind::kBox, size, {});
    shape.round = draw.uniform(0.05, 1) * std::min({size.x, size.y, size.z});
    Primitive s{};
    ASSERT_TRUE(make_primitive(shape, 0, make_view(look({0, 0, 0}, {1, 0, 0}), 64, 64), &s));
    const auto floats = [](const Vec3& v) {
      return Vec3{static_cast<double>(static_cast<float>(v.x)), static_cast<double>(static_cast<float>(v.y)),
                  static_cast<double>(static_cast<float>(v.z))};
    };
    const Vec3 o = floats(draw.box(1)), aim = draw.box(0.05), d = floats(normalized(aim - o));
    const double r = static_cast<double>(s.round);
    const double found = entry(s, wide(o), wide(d))[0];
    double t = 0, gap = HUGE_VAL;
    for (int k = 0; k < 2000 && t < 4; ++k) {
      const double distance = round_box_distance(size, r, o + t * d);
      gap = std::min(gap, distance);
      if (distance < 1e-9) break;
      t += distance;
    }
    if (round_box_distance(size, r, o) < 1e-3) continue;
    if (gap < 1e-9) {
      // A ray that dips in by less than this may count as a miss, and no surface is off by more.
      const double deep = -round_box_distance(size, r, o + (t + 2e-3) * d);
      if (deep < 2e-4) continue;
      EXPECT_NEAR(found, t, 2e-5) << i;
      ++hits;
    } else if (gap > 1e-3) {
      EXPECT_TRUE(std::isinf(found)) << i;
      ++misses;
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 500);
}

TEST(Fine, CornersAreCutOff) {
  RenderShape box = make_shape(ShapeKind::kBox, {0.1, 0.1, 0.1}, {});
  box.round = 0.1;  // a ball
  const Picture ball = take({box}, look({0, 0, 1}, {0, 0, 0}, 0.3), 99, 99, kFine);
  box.round = 0;
  const Picture cube = take({box}, look({0, 0, 1}, {0, 0, 0}, 0.3), 99, 99, kFine);
  const auto at = [](const Picture& p, int32_t x, int32_t y) {
    return std::vector<uint8_t>(p.rgb.begin() + static_cast<ptrdiff_t>(3 * p.at(x, y)),
                                p.rgb.begin() + static_cast<ptrdiff_t>(3 * p.at(x, y)) + 3);
  };
  EXPECT_EQ(at(ball, 2, 2), at(cube, 2, 2));      // the sky
  EXPECT_NE(at(ball, 19, 19), at(cube, 19, 19));  // a corner of the cube, where there is no ball
}

// Of an empty floor seen from above.
TEST(Fine, AShadowHasAMiddleAnEdgeAndAnEnd) {
  const Camera above = look({0, 0, 3}, {0, 0, 0}, 0.5);
  const std::vector<RenderShape> floor{make_shape(ShapeKind::kPlane, {}, {}, 0)};
  std::vector<RenderShape> both = floor;
  both.push_back(make_shape(ShapeKind::kSphere, {0.1, 0, 0}, {{0, 0, 0.8}, {}}, 1));
  const Picture empty = take(floor, above, 200, 200, kFine), with = take(both, above, 200, 200, kFine);
  std::vector<double> shares;
  for (int32_t y = 0; y < 200; ++y)
    for (int32_t x = 0; x < 200; ++x)
      if (with.segmentation[with.at(x, y)] == 0) shares.push_back(with.light(x, y) / empty.light(x, y));
  const double darkest = *std::min_element(shares.begin(), shares.end());
  EXPECT_LT(darkest, 0.7);
  EXPECT_GT(std::count_if(shares.begin(), shares.end(), [](double s) { return s > 0.995; }), 20000);
  EXPECT_GT(
      std::count_if(shares.begin(), shares.end(), [&](double s) { return s > darkest + 0.1 && s < 0.9; }),
      200);
}

TEST(Fine, FloorsMirrorWhatStandsOnThem) {
  RenderShape box = make_shape(ShapeKind::kBox, {0.05, 0.05, 0.05}, {{0, 0, 0.05}, {}}, 1);
  box.color[0] = 250, box.color[1] = box.color[2] = 0;
  const Camera low = look({1, 0, 0.3}, {0, 0, 0}, 0.5);
  const Picture p = take({make_shape(ShapeKind::kPlane, {}, {}, 0), box}, low, 160, 120, kFine);
  // Just below the box's lower edge the floor turns red, at the side it stays grey.
  int32_t y = 0;
  for (int32_t k = 0; k < 120; ++k)
    if (p.segmentation[p.at(80, k)] == 1) y = k;
  const auto redness = [&](int32_t x, int32_t row) {
    const size_t i = 3 * p.at(x, row);
    return p.rgb[i] - p.rgb[i + 2];
  };
  EXPECT_GT(redness(80, y + 4), redness(20, y + 4) + 5);
}

TEST(Fine, GlassShowsWhatIsBehindIt) {
  const Camera camera = look({1, 0, 0.1}, {0, 0, 0.1}, 0.5);
  std::vector<RenderShape> shapes{make_shape(ShapeKind::kSphere, {0.1, 0, 0}, {{0.3, 0, 0.1}, {}}, 1)};
  shapes[0].finish = Finish::kGlass;
  for (uint8_t& c : shapes[0].color) c = 230;
  const Picture alone = take(shapes, camera, 101, 101, kFine);
  shapes.push_back(make_shape(ShapeKind::kBox, {0.02, 0.3, 0.3}, {{-0.3, 0, 0.1}, {}}, 2));
  shapes[1].color[0] = 0, shapes[1].color[1] = 90, shapes[1].color[2] = 0;
  const Picture before = take(shapes, camera, 101, 101, kFine);
  EXPECT_LT(before.light(60, 60), alone.light(60, 60) - 20);
  shapes[0].finish = Finish::kPaint;
  const Picture opaque = take(shapes, camera, 101, 101, kFine);
  shapes.pop_back();
  EXPECT_EQ(opaque.rgb[3 * opaque.at(50, 50)],
            take(shapes, camera, 101, 101, kFine).rgb[3 * opaque.at(50, 50)]);
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "heap_count.hpp"
#include "sense/render/raycast.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

const Camera kAside = look({1.2, 0.3, 0.5}, {0, 0, 0});

// Depth of the point (x, y) of the picture by sphere tracing all shapes in double; 0 where nothing is hit.
// `clear` says that no shape's edge is near enough for floats to err.
double true_depth(const std::vector<RenderShape>& shapes, const View& view, double x, double y, int32_t* id,
                  bool* clear) {
  double best = kMaxDepth;
  *id = -1;
  *clear = true;
  for (const RenderShape& s : shapes) {
    const Vec3 o = inverse(s.X_WS) * view.eye, d = rotate(conjugate(s.X_WS.q), view.R_WC * view.ray_C(x, y));
    double gap = 0;
    const double t = march(s.kind, s.size, o, d, kMaxDepth, &gap);
    if (std::isinf(t) && gap < 1e-5) *clear = false;
    if (!std::isinf(t) && signed_distance(s.kind, s.size, o + (t + 1e-3) * d) > -2e-5) *clear = false;
    if (std::abs(t - best) < 1e-4) *clear = false;
    if (t < best) {
      best = t;
      *id = s.id;
    }
  }
  return *id < 0 ? 0 : best;
}

TEST(Raycast, DepthIsAlongTheOpticalAxis) {
  // A wall square to the axis has the same depth everywhere, however far off the axis.
  const Picture wall = take({make_shape(ShapeKind::kBox, {0.5, 9, 9}, {{-0.5, 0, 0}, {}}, 3)},
                            look({2, 0, 0}, {0, 0, 0}, 1.5), 33, 21);
  for (float depth : wall.depth) EXPECT_NEAR(depth, 2, 2e-6);
  for (int32_t id : wall.segmentation) EXPECT_EQ(id, 3);
}

TEST(Raycast, EachPrimitiveStraightAhead) {
  const struct {
    ShapeKind kind;
    Vec3 size;
    double depth;
  } cases[] = {{ShapeKind::kSphere, {0.1, 0, 0}, 1.9},
               {ShapeKind::kCapsule, {0.1, 0.3, 0}, 1.9},
               {ShapeKind::kBox, {0.2, 0.3, 0.4}, 1.8},
               {ShapeKind::kCylinder, {0.15, 0.3, 0}, 1.85}};
  for (const auto& c : cases) {
    const Picture p =
        take({make_shape(c.kind, c.size, {{1, 2, 3}, {}}, 42)}, look({3, 2, 3}, {1, 2, 3}), 11, 11);
    EXPECT_NEAR(p.depth[p.at(5, 5)], c.depth, 2e-6);
    EXPECT_EQ(p.segmentation[p.at(5, 5)], 42);
    EXPECT_EQ(p.depth[p.at(0, 5)], 0);
    EXPECT_EQ(p.segmentation[p.at(0, 5)], -1);
  }
}

TEST(Raycast, EveryPixelAgreesWithSphereTracing) {
  const std::vector<RenderShape> shapes = crowd(11, 40);
  for (const Camera& camera : {kAside, look({0.1, 0.7, 0.9}, {0, 0, -0.1}), look({0, 0, 1}, {0, 0, 0})}) {
    const Picture p = take(shapes, camera, 61, 47);
    const View view = make_view(camera, p.width, p.height);
    int compared = 0, on_shapes = 0;
    for (int32_t y = 0; y < p.height; ++y)
      for (int32_t x = 0; x < p.width; ++x) {
        int32_t id = -1;
        bool clear = true;
        const double want = true_depth(shapes, view, x + 0.5, y + 0.5, &id, &clear);
        if (!clear) continue;
        ++compared;
        on_shapes += id >= 100;
        EXPECT_EQ(p.segmentation[p.at(x, y)], id) << x << " " << y;
        EXPECT_NEAR(p.depth[p.at(x, y)], want, 1e-5 + 2e-6 * want * want) << x << " " << y;
      }
    EXPECT_GT(compared, 0.95 * p.width * p.height);
    EXPECT_GT(on_shapes, 150);
  }
}

TEST(Raycast, DepthAndViewGiveBackTheSurface) {
  const Picture p =
      take({make_shape(ShapeKind::kSphere, {0.3, 0, 0}, {{0.1, 0.2, 0.3}, {}})}, kAside, 40, 30);
  const View view = make_view(kAside, 40, 30);
  int n = 0;
  for (int32_t y = 0; y < 30; ++y)
    for (int32_t x = 0; x < 40; ++x) {
      const double depth = p.depth[p.at(x, y)];
      if (depth == 0) continue;
      EXPECT_NEAR(norm(view.point(x + 0.5, y + 0.5, depth) - Vec3{0.1, 0.2, 0.3}), 0.3, 2e-6);
      ++n;
    }
  EXPECT_GT(n, 100);
}

TEST(Raycast, CullingChangesNoByte) {
  const Camera cameras[] = {kAside, look({0.05, 0.02, 0.03}, {0.3, 0.1, -0.1}), look({0, 0, 2}, {0, 0, 0}),
                            look({3, 3, 0.2}, {0, 0, 0.4}, 0.3), look({0.5, 0, -0.39}, {0, 0, -0.2}, 2)};
  const std::vector<RenderShape> shapes = crowd(21, 50);
  for (const Camera& camera : cameras)
    for (int side : {1, 3}) {
      const Picture a = take(shapes, camera, 83, 58, {side, true, true});
      const Picture b = take(shapes, camera, 83, 58, {side, true, false});
      EXPECT_EQ(a.rgb, b.rgb);
      EXPECT_EQ(a.depth, b.depth);
      EXPECT_EQ(a.segmentation, b.segmentation);
    }
}

TEST(Raycast, SamplesSmoothColourAndLeaveDepthAlone) {
  const std::vector<RenderShape> shapes = crowd(2, 20);
  const Picture one = take(shapes, kAside, 64, 48, {1, true, true});
  const Picture four = take(shapes, kAside, 64, 48, {4, true, true});
  const Picture again = take(shapes, kAside, 64, 48, {4, true, true});
  EXPECT_EQ(one.depth, four.depth);
  EXPECT_EQ(one.segmentation, four.segmentation);
  EXPECT_NE(one.rgb, four.rgb);
  EXPECT_EQ(four.rgb, again.rgb);
}

TEST(Raycast, NoHeap) {
  const std::vector<RenderShape> shapes = crowd(3, 60);
  OwnScratch own;
  Picture p(64, 64);
  const int64_t calls = heap_count();
  for (int side : {1, 2, 8})
    render(shapes.data(), static_cast<int32_t>(shapes.size()), kAside, p.image(), {side, true, true},
           own.scratch);
  EXPECT_EQ(heap_count(), calls);
  if (kHeapIsCounted) {
    const Picture other(8, 8);
    EXPECT_GT(heap_count(), calls);  // the counter counts
  }
}

TEST(Raycast, WritesThePictureAndNothingElse) {
  const std::vector<RenderShape> shapes = crowd(3, 20);
  OwnScratch own;
  for (int32_t w : {1, 3, 4, 5, 17})
    for (int32_t h : {1, 2, 4, 7}) {
      const auto n = static_cast<size_t>(w * h);
      std::vector<uint8_t> rgb(3 * n + 64, 0xAB);
      std::vector<float> depth(n + 16, -5);
      std::vector<int32_t> segmentation(n + 16, -5);
      const Image image{w, h, rgb.data() + 32, depth.data() + 8, segmentation.data() + 8};
      render(shapes.data(), 21, kAside, image, {2, true, true}, own.scratch);
      for (size_t i = 0; i < 32; ++i) EXPECT_TRUE(rgb[i] == 0xAB && rgb[32 + 3 * n + i] == 0xAB);
      for (size_t i = 0; i < 8; ++i) {
        EXPECT_TRUE(depth[i] == -5 && depth[8 + n + i] == -5);
        EXPECT_TRUE(segmentation[i] == -5 && segmentation[8 + n + i] == -5);
      }
      for (size_t i = 0; i < n; ++i) {
        EXPECT_GE(depth[8 + i], 0);
        EXPECT_GE(segmentation[8 + i], -1);
      }
    }
}

TEST(Raycast, AnyBufferMayBeMissing) {
  const std::vector<RenderShape> shapes = crowd(6, 20);
  OwnScratch own;
  Picture whole(30, 20), part(30, 20);
  render(shapes.data(), 21, kAside, whole.image(), {}, own.scratch);
  render(shapes.data(), 21, kAside, {30, 20, part.rgb.data(), nullptr, nullptr}, {}, own.scratch);
  render(shapes.data(), 21, kAside, {30, 20, nullptr, part.depth.data(), nullptr}, {}, own.scratch);
  render(shapes.data(), 21, kAside, {30, 20, nullptr, nullptr, part.segmentation.data()}, {}, own.scratch);
  render(shapes.data(), 21, kAside, {30, 20, nullptr, nullptr, nullptr}, {}, own.scratch);
  EXPECT_EQ(part.rgb, whole.rgb);
  EXPECT_EQ(part.depth, whole.depth);
  EXPECT_EQ(part.segmentation, whole.segmentation);
}

TEST(Raycast, NothingToSee) {
  const Picture p = take({}, kAside, 9, 6);
  for (float depth : p.depth) EXPECT_EQ(depth, 0);
  for (int32_t id : p.segmentation) EXPECT_EQ(id, -1);
  EXPECT_GT(p.light(4, 3), 100);  // the background is bright
  const RenderShape lost = make_shape(ShapeKind::kSphere, {0.1, 0, 0}, {{std::nan(""), 0, 0}, {}});
  EXPECT_EQ(take({lost}, kAside, 9, 6).segmentation, p.segmentation);
}

TEST(Raycast, RefusesAbsurdArguments) {
  const std::vector<RenderShape> shapes = crowd(1, 10);
  OwnScratch own(11);
  Picture p(16, 16);
  const auto code = [&](int32_t n, const Camera& camera, const Image& image, const RenderOptions& options) {
    return guard([&] { render(shapes.data(), n, camera, image, options, own.scratch); });
  };
  const Image good = p.image();
  EXPECT_EQ(code(11, kAside, good, {}), Code::kOk);
  const Picture before = p;
  EXPECT_EQ(code(12, kAside, good, {}), Code::kRange);
  EXPECT_EQ(code(-1, kAside, good, {}), Code::kRange);
  for (int32_t side : {0, -3, kMaxImageSide + 1, INT32_MAX}) {
    Image bad = good;
    bad.width = side;
    EXPECT_EQ(code(11, kAside, bad, {}), Code::kRange);
    bad = good;
    bad.height = side;
    EXPECT_EQ(code(11, kAside, bad, {}), Code::kRange);
  }
  for (int32_t samples : {0, -1, kMaxSamplesPerSide + 1})
    EXPECT_EQ(code(11, kAside, good, {samples, true, true}), Code::kRange);
  EXPECT_EQ(code(11, look({1, 1, 1}, {1, 1, 1}), good, {}), Code::kArgument);
  EXPECT_EQ(guard([&] { render(nullptr, 1, kAside, good, {}, own.scratch); }), Code::kArgument);
  std::vector<RenderShape> broken = shapes;
  broken[10].size = {-1, -1, -1};
  EXPECT_EQ(guard([&] { render(broken.data(), 11, kAside, good, {}, own.scratch); }), Code::kRange);
  EXPECT_EQ(p.rgb, before.rgb);
  EXPECT_EQ(p.depth, before.depth);
  Arena arena;
  EXPECT_EQ(guard([&] { carve_raycast_scratch(arena, -1); }), Code::kRange);
  EXPECT_EQ(guard([&] { carve_raycast_scratch(arena, kMaxRenderShapes + 1); }), Code::kRange);
}

TEST(Raycast, ManyCrowdedShapesFillTheScratchExactly) {
  std::vector<RenderShape> shapes;
  for (int i = 0; i < 500; ++i)
    shapes.push_back(make_shape(ShapeKind::kSphere, {0.5, 0, 0}, {{0, 0.0001 * i, 0}, {}}, i));
  const Picture p = take(shapes, kAside, 16, 16, {2, true, true});
  for (int32_t id : p.segmentation) EXPECT_TRUE(id >= -1 && id < 500);
}

}  // namespace
}  // namespace rdm

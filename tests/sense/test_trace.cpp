#include <gtest/gtest.h>

#include <numeric>

#include "sense/render/trace.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

struct PlanarScene {
  View view = make_view(look({1.5, 0.2, 0.4}, {0, 0, 0}), 32, 24);
  Rays rays = make_rays(view);
  std::vector<Primitive> primitives;
  std::vector<int32_t> order;

  explicit PlanarScene(const std::vector<RenderShape>& shapes)
      : primitives(shapes.size()), order(shapes.size()) {
    for (size_t i = 0; i < shapes.size(); ++i)
      EXPECT_TRUE(make_primitive(shapes[i], static_cast<int32_t>(i), view, &primitives[i]));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [this](int32_t a, int32_t b) {
      return primitives[static_cast<size_t>(a)].nearest < primitives[static_cast<size_t>(b)].nearest;
    });
  }
  Hits run(bool stop, float x, float y) const {
    Hits hits;
    trace(rays, primitives.data(), {order.data(), static_cast<int32_t>(order.size())}, stop, x, y, &hits);
    return hits;
  }
};

TEST(Trace, RaysAreThoseOfTheView) {
  const PlanarScene stage({});
  const Hits hits = stage.run(true, 8.5f, 4.25f);
  for (int r = 0; r < kTileSide; ++r)
    for (int i = 0; i < kFloat4Lanes; ++i) {
      const Vec3 want = stage.view.R_WC * stage.view.ray_C(8.5 + i, 4.25 + r);
      EXPECT_NEAR(hits.d[r].x[i], want.x, 1e-6);
      EXPECT_NEAR(hits.d[r].y[i], want.y, 1e-6);
      EXPECT_NEAR(hits.d[r].z[i], want.z, 1e-6);
      EXPECT_EQ(hits.who[r][i], -1);
      EXPECT_EQ(hits.t[r][i], static_cast<float>(kMaxDepth));
    }
}

TEST(Trace, StoppingEarlyChangesNothing) {
  const PlanarScene stage(crowd(4, 60));
  int hits = 0;
  for (float y = 0.5f; y < 24; y += kTileSide)
    for (float x = 0.5f; x < 32; x += kTileSide) {
      const Hits a = stage.run(true, x, y), b = stage.run(false, x, y);
      for (int r = 0; r < kTileSide; ++r)
        for (int i = 0; i < kFloat4Lanes; ++i) {
          EXPECT_EQ(a.t[r][i], b.t[r][i]);
          EXPECT_EQ(a.who[r][i], b.who[r][i]);
          hits += a.who[r][i] > 0;
        }
    }
  EXPECT_GT(hits, 50);
}

TEST(Trace, NearestWinsWhateverTheOrder) {
  std::vector<RenderShape> shapes{make_shape(ShapeKind::kSphere, {0.1, 0, 0}, {{-0.5, 0, 0}, {}}),
                                  make_shape(ShapeKind::kSphere, {0.1, 0, 0}, {{0.5, 0.05, 0.1}, {}})};
  for (int turn = 0; turn < 2; ++turn) {
    const PlanarScene stage(shapes);
    const int front = shapes[0].X_WS.p.x > 0 ? 0 : 1;
    int seen[2] = {};
    for (float y = 0.5f; y < 24; y += kTileSide)
      for (float x = 0.5f; x < 32; x += kTileSide) {
        const Hits hits = stage.run(true, x, y);
        for (int r = 0; r < kTileSide; ++r)
          for (int i = 0; i < kFloat4Lanes; ++i)
            if (hits.who[r][i] >= 0) {
              ++seen[hits.who[r][i]];
              const bool is_front = hits.who[r][i] == front;
              EXPECT_TRUE(is_front ? hits.t[r][i] < 1.2f : hits.t[r][i] > 1.8f);
            }
      }
    EXPECT_GT(seen[front], seen[1 - front]);  // nearer looks larger and hides the other
    std::swap(shapes[0], shapes[1]);
  }
}

TEST(Trace, OfEqualDepthsTheFirstIsMet) {
  const RenderShape ball = make_shape(ShapeKind::kSphere, {0.2, 0, 0}, {});
  const PlanarScene stage({ball, ball, ball});
  const Hits hits = stage.run(true, 14.5f, 10.5f);
  for (int r = 0; r < kTileSide; ++r)
    for (int i = 0; i < kFloat4Lanes; ++i) EXPECT_EQ(hits.who[r][i], 0);
}

TEST(Trace, NothingBeyondTheFarLimit) {
  const PlanarScene stage({make_shape(ShapeKind::kBox, {1, 500, 500}, {{1.5 - kMaxDepth - 2, 0, 0}, {}})});
  EXPECT_EQ(stage.run(true, 16.5f, 12.5f).who[0][0], -1);
  const PlanarScene nearer({make_shape(ShapeKind::kBox, {1, 500, 500}, {{1.5 - kMaxDepth + 4, 0, 0}, {}})});
  EXPECT_EQ(nearer.run(true, 16.5f, 12.5f).who[0][0], 0);
}

}  // namespace
}  // namespace rdm

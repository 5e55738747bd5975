#include <gtest/gtest.h>

#include "sense/render/paint.hpp"
#include "sense/render/shade.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

const Camera kAbove = look({0, 0, 3}, {0, 0, 0}, 0.5);

// World point of the floor z = 0 as a pixel of a picture taken from kAbove.
struct Spot {
  int32_t x, y;
};
Spot spot(const Picture& p, const Vec3& p_W) {
  const View view = make_view(kAbove, p.width, p.height);
  const Vec3 c = transpose(view.R_WC) * (p_W - view.eye);
  return {static_cast<int32_t>(0.5 * p.width + c.x / c.z / view.pixel),
          static_cast<int32_t>(0.5 * p.height + c.y / c.z / view.pixel)};
}

std::vector<RenderShape> ball_above_floor(double height) {
  std::vector<RenderShape> shapes{make_shape(ShapeKind::kPlane, {}, {}, 0),
                                  make_shape(ShapeKind::kSphere, {0.1, 0, 0}, {{0, 0, height}, {}}, 1)};
  return shapes;
}

// Where the middle of a thing at this height throws its shadow.
Vec3 shadow_of(double height) {
  const Vec3 l = light_direction(0, 0);
  return {-height * l.x / l.z, -height * l.y / l.z, 0};
}

TEST(Paint, ABallThrowsAShadowWhereTheLightSays) {
  for (int side : {1, 3}) {
    const Picture with = take(ball_above_floor(0.5), kAbove, 200, 200, {side, true, true});
    const Picture without = take(ball_above_floor(0.5), kAbove, 200, 200, {side, false, true});
    const Spot dark = spot(with, shadow_of(0.5)), other = spot(with, -1 * shadow_of(0.5));
    EXPECT_LT(with.light(dark.x, dark.y), 0.8 * without.light(dark.x, dark.y));
    EXPECT_EQ(with.light(other.x, other.y), without.light(other.x, other.y));
  }
}

// Pixels of the floor in half shadow.
int half_dark(int side) {
  const Picture with = take(ball_above_floor(1), kAbove, 200, 200, {side, true, true});
  const Picture without = take(ball_above_floor(1), kAbove, 200, 200, {side, false, true});
  std::vector<double> shares;
  for (int32_t y = 0; y < 200; ++y)
    for (int32_t x = 0; x < 200; ++x)
      if (with.segmentation[with.at(x, y)] == 0) shares.push_back(with.light(x, y) / without.light(x, y));
  const double darkest = *std::min_element(shares.begin(), shares.end());
  EXPECT_LT(darkest, 0.85);
  return static_cast<int>(std::count_if(shares.begin(), shares.end(), [&](double share) {
    return share > darkest + 0.3 * (1 - darkest) && share < darkest + 0.8 * (1 - darkest);
  }));
}

TEST(Paint, OneSampleIsHardMoreAreSoft) {
  EXPECT_EQ(half_dark(1), 0);
  EXPECT_GT(half_dark(3), 50);
}

TEST(Paint, TouchingTheFloorDarkensItAround) {
  // Beside the ball, away from its shadow.
  const Picture low = take(ball_above_floor(0.1), kAbove, 200, 200),
                high = take(ball_above_floor(1.5), kAbove, 200, 200);
  const Vec3 away = -0.13 * normalized(shadow_of(1));
  const Spot at = spot(low, away);
  ASSERT_EQ(low.segmentation[low.at(at.x, at.y)], 0);
  const Picture bare = take({make_shape(ShapeKind::kPlane, {}, {}, 0)}, kAbove, 200, 200);
  EXPECT_LT(low.light(at.x, at.y), bare.light(at.x, at.y) - 1);
  const Spot far = spot(low, {0.4, -0.4, 0});
  EXPECT_EQ(low.light(far.x, far.y), bare.light(far.x, far.y));
}

TEST(Paint, SideTowardsTheLightIsBrighter) {
  const std::vector<RenderShape> shapes{make_shape(ShapeKind::kSphere, {0.3, 0, 0}, {}, 1)};
  const Picture p = take(shapes, kAbove, 100, 100, {2, true, true});
  const Vec3 l = light_direction(0, 0), flat = 0.2 * normalized(Vec3{l.x, l.y, 0});
  const Spot bright = spot(p, flat), dim = spot(p, -1 * flat);
  EXPECT_GT(p.light(bright.x, bright.y), p.light(dim.x, dim.y) + 20);
}

TEST(Paint, ColoursAreTheShapes) {
  std::vector<RenderShape> shapes{make_shape(ShapeKind::kBox, {0.3, 0.3, 0.1}, {}, 1)};
  const uint8_t colors[3][3] = {{200, 40, 40}, {40, 200, 40}, {40, 40, 200}};
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 3; ++k) shapes[0].color[k] = colors[c][k];
    const Picture p = take(shapes, kAbove, 21, 21);
    const uint8_t* rgb = p.rgb.data() + 3 * p.at(10, 10);
    for (int k = 0; k < 3; ++k) EXPECT_GT(rgb[c], k == c ? 150 : rgb[k] + 60);
  }
}

TEST(Paint, LightRaysLieInTheDisc) {
  const Vec3 key = light_direction(0, 0);
  for (int side = 1; side <= kMaxSamplesPerSide; ++side) {
    const LightRays rays = make_light_rays(side, kLightSpread);
    const int count = side * side * rays.per_sample;
    ASSERT_LE(count, kMaxSamplesPerSide * kMaxSamplesPerSide);
    Vec3 mean;
    for (int k = 0; k < count; ++k)
      for (int r = 0; r < kTileSide; ++r)
        for (int i = 0; i < kFloat4Lanes; ++i) {
          const Vec3 l{rays.at[k][r].x[i], rays.at[k][r].y[i], rays.at[k][r].z[i]};
          EXPECT_NEAR(norm(l), 1, 1e-6);
          EXPECT_LE(norm(cross(l, key)), kLightSpread);
          EXPECT_LE(norm(l - key), side == 1 ? 1e-6 : kLightSpread);
          mean += (1.0 / (count * 16)) * l;
        }
    EXPECT_NEAR(norm(mean - key), 0, 2e-3);
  }
}

TEST(Paint, PlainFloorLooksTheSameWithOneSampleOrMany) {
  // Tiles without things or shadows take one sample; the checker is averaged in closed form.
  const std::vector<RenderShape> floor{make_shape(ShapeKind::kPlane, {}, {}, 0)};
  const Picture one = take(floor, kAbove, 64, 64, {1, true, true}),
                many = take(floor, kAbove, 64, 64, {5, true, true});
  EXPECT_EQ(one.rgb, many.rgb);
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include "sense/render/primitive.hpp"
#include "sense/render/shade.hpp"
#include "sense_shapes.hpp"

namespace rdm {
namespace {

double sum(const Lanes3& c) {
  return c.x[0] + c.y[0] + c.z[0];
}

Surface surface(const Vec3& n, float lit = 1, float open = 1) {
  const Vec3 d{-0.3, 0.9, -0.4};  // from a side where no mirror image of the light is seen
  return {wide(d), wide(d), wide(n), splat(0.5f, 0.5f, 0.5f), splat(lit), splat(open)};
}

Lanes3 lit(const Surface& s) {
  return shade(s, wide(light_direction(0, 0)));
}

TEST(Shade, BrighterTheMoreItFacesTheLight) {
  const Vec3 key = light_direction(0, 0), side = normalized(cross(key, {0.2, 1, 0.1}));
  double before = HUGE_VAL;
  for (double angle = 0; angle < 1.5; angle += 0.1) {
    // Compared with the same point in shadow, so that only the key light counts.
    const Vec3 n = std::cos(angle) * key + std::sin(angle) * side;
    const double gain = sum(lit(surface(n, 1))) - sum(lit(surface(n, 0)));
    EXPECT_GT(gain, 0);
    EXPECT_LT(gain, before) << angle;
    before = gain;
  }
}

TEST(Shade, ShadowAndClosenessDarken) {
  const Vec3 up{0, 0, 1};
  EXPECT_LT(sum(lit(surface(up, 0))), 0.6 * sum(lit(surface(up, 1))));
  EXPECT_LT(sum(lit(surface(up, 1, 0.3f))), sum(lit(surface(up, 1, 1))));
  EXPECT_GT(sum(lit(surface(up, 0))), 0.1);  // shadows are not black
}

TEST(Shade, LightDirectionsFillTheDisc) {
  const Vec3 key = light_direction(0, 0);
  EXPECT_GT(key.z, 0.5);
  for (double angle = 0; angle < 6; angle += 0.5) {
    const Vec3 l = light_direction(std::cos(angle), std::sin(angle));
    EXPECT_NEAR(norm(l), 1, 1e-12);
    EXPECT_NEAR(std::tan(std::acos(dot(l, key))), kLightSpread, 1e-6);
  }
}

TEST(Shade, CheckerIsAveragedOverTheSample) {
  const float white[3] = {1, 1, 1};
  const auto tone = [&](float x, float y, float w) {
    return checker(white, splat(x), splat(y), splat(w), splat(w)).x[0];
  };
  const float light = tone(0.05f, 0.05f, 1e-4f), dark = tone(0.15f, 0.05f, 1e-4f);
  EXPECT_NEAR(light, 1, 1e-3);
  EXPECT_LT(dark, 0.9);
  EXPECT_NEAR(tone(0.15f, 0.15f, 1e-4f), light, 1e-3);
  EXPECT_NEAR(tone(-0.05f, 0.05f, 1e-4f), dark, 1e-3);
  EXPECT_NEAR(tone(0.1f, 0.05f, 0.02f), 0.5 * (light + dark), 1e-3);  // on the line between two squares
  EXPECT_NEAR(tone(0.033f, 0.071f, 20), 0.5 * (light + dark), 1e-2);  // many squares
}

TEST(Shade, HazeGrowsFromNothingToAll) {
  double before = -1;
  for (float r = 0; r < 90; r += 1) {
    const double h = haze(splat(r), 1)[0];
    EXPECT_GT(h, before);
    before = h;
  }
  EXPECT_EQ(haze(splat(0), 1)[0], 0);
  EXPECT_GT(before, 0.999);
  EXPECT_LT(haze(splat(4), 2)[0], haze(splat(4), 1)[0]);
  EXPECT_LT(haze(splat(1.8f), 1.8f)[0], 0.01);  // straight down is clear
}

TEST(Shade, OcclusionComesFromWhatIsAboveAndClose) {
  const View view = make_view(look({0, 0, 0}, {1, 0, 0}), 64, 64);
  Primitive ball{};
  ASSERT_TRUE(make_primitive(make_shape(ShapeKind::kSphere, {0.1, 0, 0}, {{1, 0, 0.1}, {}}), 0, view, &ball));
  const auto hidden = [&](const Vec3& p, const Vec3& n) { return occlusion(ball, wide(p), wide(n))[0]; };
  const Vec3 up{0, 0, 1};
  EXPECT_GT(hidden({1, 0, 0}, up), 0.8);  // where it touches the ground
  double before = 2;
  for (double x = 0; x < 0.5; x += 0.02) {
    const double h = hidden({1 + x, 0, 0}, up);
    EXPECT_LT(h, before);
    before = h;
  }
  EXPECT_EQ(hidden({1 + 0.1 * kOcclusionReach, 0, 0}, up), 0);
  EXPECT_EQ(hidden({1, 0, 0}, -up), 0);
}

TEST(Shade, SrgbBothWays) {
  EXPECT_EQ(from_srgb(0), 0);
  EXPECT_EQ(from_srgb(255), 1);
  EXPECT_NEAR(from_srgb(188), 0.5029, 1e-4);  // the standard's own curve
  EXPECT_NEAR(from_srgb(10), 10 / 255.0 / 12.92, 1e-7);
  int before = -1, steps = 0;
  for (float v = 0; v < 17; v += 0.001f) {
    const int c = to_srgb(v);
    EXPECT_GE(c, before);
    steps += c != before;
    before = c;
  }
  EXPECT_GT(steps, 200);
  EXPECT_EQ(before, 255);
  EXPECT_EQ(to_srgb(-1), 0);
  EXPECT_EQ(to_srgb(std::nanf("")), 0);
  EXPECT_EQ(to_srgb(HUGE_VALF), 255);
}

}  // namespace
}  // namespace rdm

#include "sense/render/shade.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "sense/render/waves.hpp"

namespace rdm {

namespace {

constexpr float kSquare = 0.1f;     // m
constexpr float kDarker = 0.74f;    // of the second square
constexpr float kHazeRange = 3.5f;  // eye heights at which half of the floor is left
constexpr float kLowEye = 0.8f;     // m: lower eyes see as far as this one

}  // namespace

Vec3 light_direction(double u, double v, double spread) {
  const Vec3 key = normalized(Vec3{0.42, -0.38, 0.82});
  const Vec3 side = normalized(cross({0, 0, 1}, key)), up = cross(key, side);
  return normalized(key + spread * (u * side + v * up));
}

Lanes3 shade(const Surface& s, const Lanes3& key) {
  const Lanes3 v = normalized(splat(0, 0, 0) - s.d);
  const Float4 facing = max(dot(s.n, v), splat(0));
  const Float4 key_light = 1.95f * s.lit * max(dot(s.n, key), splat(0));
  const Float4 up = 0.5f + 0.5f * s.n.z;
  const Lanes3 sky = mix(splat(0.25f, 0.23f, 0.22f), splat(0.42f, 0.47f, 0.56f), up);
  Lanes3 light = s.open * sky + key_light * splat(1.0f, 0.96f, 0.90f);
  light = light + (0.18f * facing * s.open) * splat(1, 1, 1);

  const Lanes3 h = normalized(key + v);
  Float4 gloss = max(dot(s.n, h), splat(0));
  for (int i = 0; i < 5; ++i) gloss = gloss * gloss;
  const Float4 edge = 1.0f - facing;
  const Float4 rim = 0.10f * s.open * edge * edge * edge * up;
  return s.albedo * light + (0.22f * gloss * s.lit) * splat(1, 1, 1) + rim * splat(0.8f, 0.9f, 1.0f);
}

Lanes3 background(const Lanes3& d) {
  const Float4 height = clamp(d.z / sqrt(dot(d, d)), -1, 1);
  const Lanes3 horizon = splat(0.80f, 0.84f, 0.89f), zenith = splat(0.36f, 0.47f, 0.62f);
  const Float4 rise = max(height, splat(0));
  return mix(horizon, zenith, rise * (2.0f - rise));
}

Float4 haze(Float4 r, float height) {
  const Float4 q = r * (1 / (kHazeRange * std::fmax(height, kLowEye))), q2 = q * q;
  return 1.0f - 1.0f / (1.0f + q2 * q2);
}

Lanes3 checker(const float color[3], Float4 x, Float4 y, Float4 wx, Float4 wy) {
  const float scale = 1 / kSquare;
  const Float4 tone = square_wave(x * scale, max(wx * scale, splat(1e-3f))) *
                      square_wave(y * scale, max(wy * scale, splat(1e-3f)));
  const Float4 bright = kDarker + (1 - kDarker) * (0.5f + 0.5f * tone);
  return bright * splat(color[0], color[1], color[2]);
}

Float4 occlusion(const Primitive& s, const Lanes3& p, const Lanes3& n) {
  const Lanes3 spine = splat(s.spine[0], s.spine[1], s.spine[2]);
  const Lanes3 out = p - splat(s.p_ES[0], s.p_ES[1], s.p_ES[2]);
  const Float4 along = clamp(dot(out, spine) / max(dot(spine, spine), splat(1e-12f)), -1, 1);
  const Lanes3 v = along * spine - out;
  const Float4 square = max(dot(v, v), splat(1e-12f));
  const Float4 share = clamp(dot(n, v) / sqrt(square), 0, 1) * min(s.thick * s.thick / square, splat(1));
  const float reach = kOcclusionReach * s.thick;
  const Float4 left = max(1.0f - square * (1 / (reach * reach)), splat(0));
  return share * left * left;
}

float from_srgb(uint8_t value) {
  const float v = static_cast<float>(value) * (1 / 255.0f);
  if (v <= 0.04045f) return v / 12.92f;
  const auto base = static_cast<double>((v + 0.055f) / 1.055f);
  return static_cast<float>(elementary::exp(2.4 * elementary::log(base)));
}

uint8_t to_srgb(float value) {
  if (!(value > 0)) return 0;
  if (!(value < 16)) return 255;
  return encode_srgb(value * (1 + 0.12f * value) / (1 + 0.55f * value));  // highlights bend, shadows stay
}

uint8_t encode_srgb(float v) {
  const float s1 = std::sqrt(v), s2 = std::sqrt(s1), s3 = std::sqrt(s2);
  const float srgb =
      v <= 0.0031308f ? 12.92f * v : 0.66200269f * s1 + 0.68412206f * s2 - 0.32358360f * s3 - 0.02254115f * v;
  return static_cast<uint8_t>(std::min(255.0f, 255.0f * srgb + 0.5f));
}

}  // namespace rdm

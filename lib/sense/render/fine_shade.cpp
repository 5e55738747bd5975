#include "sense/render/fine_shade.hpp"

#include <algorithm>

#include "sense/render/waves.hpp"

namespace rdm {

namespace {

constexpr Look kLooks[] = {
    {0.045f, 0.30f, 6, 0.05f, 0, 0},      // kPaint
    {0.035f, 0.55f, 4, 0.22f, 0, 0},      // kSkin
    {0.050f, 0.16f, 7, 0.08f, 0, 0},      // kPlastic
    {0.025f, 0.70f, 3, 0.10f, 0, 0},      // kRubber
    {0.040f, 0.45f, 5, 0.04f, 0, 0},      // kWood
    {0.600f, 0.20f, 6, 0.00f, 0.85f, 0},  // kMetal
    {0.060f, 0.05f, 8, 0.15f, 0, 0.72f},  // kGlass
    {0.010f, 1.00f, 2, 0.25f, 0, 0},      // kCloth
};

constexpr float kTile = 0.1f, kJoint = 0.0022f;  // m
constexpr float kBrightTile = 0.77f, kDarkTile = 0.63f, kDarkJoint = 0.80f;

Float4 smooth(Float4 v, float lo, float hi) {
  const Float4 t = clamp((v - lo) * (1 / (hi - lo)), 0, 1);
  return t * t * (3.0f - 2.0f * t);
}

// Hash of whole numbers to [0, 1).
Float4 noise_at(Float4 x, Float4 y, int32_t seed) {
  Float4 out;
  for (int i = 0; i < kFloat4Lanes; ++i) {
    uint32_t h = static_cast<uint32_t>(static_cast<int32_t>(x[i])) * 0x9E3779B1u ^
                 static_cast<uint32_t>(static_cast<int32_t>(y[i])) * 0x85EBCA77u ^
                 static_cast<uint32_t>(seed) * 0xC2B2AE3Du;
    h ^= h >> 15;
    h *= 0x2C1B3C6Du;
    h ^= h >> 12;
    h *= 0x297A2D39u;
    h ^= h >> 15;
    out[i] = static_cast<float>(h >> 8) * (1.0f / 16777216);
  }
  return out;
}
Float4 noise(Float4 x, Float4 y, int32_t seed) {
  x = clamp(x, -1e6f, 1e6f);
  y = clamp(y, -1e6f, 1e6f);
  const Float4 x0 = floor(x), y0 = floor(y);
  Float4 u = x - x0, v = y - y0;
  u = u * u * (3.0f - 2.0f * u);
  v = v * v * (3.0f - 2.0f * v);
  const Float4 a = noise_at(x0, y0, seed), b = noise_at(x0 + 1.0f, y0, seed);
  const Float4 c = noise_at(x0, y0 + 1.0f, seed), d = noise_at(x0 + 1.0f, y0 + 1.0f, seed);
  return a + u * (b - a) + v * (c - a + u * (a - b - c + d));
}

Float4 raised(Float4 cosine, int doublings) {
  for (int i = 0; i < doublings; ++i) cosine = cosine * cosine;
  return cosine;
}

}  // namespace

const Look& look_of(Finish finish) {
  return kLooks[static_cast<int>(finish)];
}

Float4 fresnel(float head_on, Float4 cosine) {
  const Float4 m = clamp(1.0f - cosine, 0, 1), m2 = m * m;
  return head_on + (1 - head_on) * (m2 * m2 * m);
}

Lanes3 sky(const Lanes3& d, const Lanes3& key) {
  const Lanes3 v = normalized(d);
  const Float4 rise = max(v.z, splat(0));
  const Lanes3 horizon = splat(0.66f, 0.84f, 1.08f), zenith = splat(0.03f, 0.16f, 0.52f);
  const Float4 share = rise * (2.0f - rise) + 0.25f * rise * (1.0f - rise);
  Lanes3 out = mix(horizon, zenith, share);
  const Float4 toward = max(dot(v, key), splat(0));
  const Float4 glow = toward * toward * toward * toward;
  return out + (0.10f * glow) * splat(1.0f, 0.93f, 0.82f);
}

Lanes3 surroundings(const Lanes3& r, const Lanes3& key, float blur) {
  const Float4 rise = clamp(r.z, 0, 1);
  const Lanes3 above = mix(splat(0.80f, 0.84f, 0.90f), splat(0.30f, 0.42f, 0.62f), rise * (2.0f - rise));
  const Lanes3 below = splat(0.36f, 0.36f, 0.37f);
  const float soft = 0.06f + 0.9f * blur;
  const Lanes3 all = mix(below, above, smooth(r.z, -soft, soft));
  const Float4 panel = smooth(dot(r, key), 0.93f - 0.55f * blur, 0.965f + 0.02f * blur);
  // A strip aside, which draws a line on bottles and eggs.
  const Float4 aside = dot(r, splat(-0.68f, -0.62f, 0.38f));
  const Float4 strip = smooth(aside, 0.90f - 0.5f * blur, 0.94f + 0.03f * blur);
  return all + (0.8f * (1 - 0.75f * blur)) * strip * splat(0.9f, 0.95f, 1.0f) +
         ((1.9f * (1 - 0.75f * blur)) * panel) * splat(1.0f, 0.97f, 0.92f);
}

Lanes3 shade_fine(const Surface& s, const Look& look, const Lanes3& key) {
  const Lanes3 v = normalized(splat(0, 0, 0) - s.d);
  const Float4 facing = clamp(dot(s.n, v), 0, 1);
  const Float4 slope = dot(s.n, key);
  const Float4 diffuse = max((slope + look.wrap) * (1 / (1 + look.wrap)), splat(0));
  // Light that creeps around turns warm, as in skin.
  const Lanes3 warm = splat(1.0f, 0.95f, 0.86f);
  const Float4 key_light = 2.55f * s.lit * diffuse;
  const Float4 up = 0.5f + 0.5f * s.n.z;
  const Lanes3 dome = mix(splat(0.25f, 0.235f, 0.225f), splat(0.35f, 0.43f, 0.56f), up);
  Lanes3 light = s.open * dome + key_light * warm + (0.13f * facing * s.open) * splat(1.0f, 0.98f, 0.96f);
  const Lanes3 scattered = splat(1 - look.metal) * (s.albedo * light);

  const Lanes3 r = normalized(2.0f * dot(s.n, v) * s.n - v);
  const Float4 share = fresnel(look.mirror, facing) * (1 - 0.65f * look.blur);
  const Float4 free = s.open * s.open;
  const Lanes3 mirrored = free * surroundings(r, key, look.blur);
  const Float4 lobe = raised(max(dot(s.n, normalized(key + v)), splat(0)), look.gloss);
  const auto width = static_cast<float>(1 << look.gloss);
  const Float4 shine = (0.04f * (width + 8)) * lobe * s.lit * max(slope, splat(0));
  const Lanes3 tint = look.metal > 0 ? mix(splat(1, 1, 1), s.albedo, splat(look.metal)) : splat(1, 1, 1);
  return scattered + tint * (share * mirrored) + tint * ((look.mirror * 1.6f * shine) * warm);
}

Lanes3 tiles(const float color[3], Float4 x, Float4 y, Float4 wx, Float4 wy) {
  const float scale = 1 / kTile;
  const Float4 u = x * scale, v = y * scale;
  const Float4 wu = max(wx * scale, splat(1e-3f)), wv = max(wy * scale, splat(1e-3f));
  const Float4 tone = square_wave(u, wu) * square_wave(v, wv);
  Float4 bright = kDarkTile + (kBrightTile - kDarkTile) * (0.5f + 0.5f * tone);
  const float half = 0.5f * kJoint * scale;
  const Float4 ju = line_share(u, wu, half), jv = line_share(v, wv, half);
  const Float4 joint = ju + jv - ju * jv;
  bright = bright * (1.0f - (1 - kDarkJoint) * joint);
  return bright * splat(color[0], 0.975f * color[1], 0.93f * color[2]);
}

Float4 grain(const Lanes3& p, int axis, int32_t id) {
  const Float4 along = axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  const Float4 a = axis == 0 ? p.y : p.x, b = axis == 2 ? p.y : p.z;
  const float shift = static_cast<float>(id % 97) * 0.37f;
  // Rings about a heart that lies outside of the plank and wanders along it.
  const Float4 wander = noise(6.0f * along + shift, splat(shift), 3) - 0.5f;
  const Float4 u = a * 100.0f + 1.2f * wander + (3.0f + shift * 0.1f), v = b * 100.0f + 1.6f * wander - 2.0f;
  const Float4 radius = sqrt(u * u + v * v) * 1.6f + noise(14.0f * along + shift, u, 11) * 0.35f;
  const Float4 ring = radius - floor(radius);
  const Float4 late = ring * ring * ring;  // slowly darker, then suddenly light
  const Float4 fibre = noise(60.0f * along + shift, 1400.0f * (a + 0.7f * b), 7);
  return 1.0f - 0.17f * late - 0.09f * fibre;
}

uint8_t to_fine_srgb(float value) {
  if (!(value > 0)) return 0;
  if (!(value < 64)) return 255;
  const float x = 0.70f * value;
  // Hill-shaped curve (Narkowicz 2015's form, own coefficients).
  const float v = std::min(1.0f, x * (1.9f * x + 0.16f) / (x * (1.80f * x + 0.62f) + 0.16f));
  return encode_srgb(v);
}

}  // namespace rdm

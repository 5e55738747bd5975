#include "sense/render/paint.hpp"

#include <cmath>
#include <numbers>

#include "base/elementary.hpp"
#include "sense/render/shade.hpp"

namespace rdm {

namespace {

constexpr float kOffSurface = 1e-4f;  // m: nearer, a shadow's caster is the surface itself

// Sphere about the points that a tile sees.
struct Ball {
  float x, y, z, r;
};

Ball ball_about(const Hits* hits, int count) {
  Lanes3 lo = splat(kNoHit, kNoHit, kNoHit), hi = splat(-kNoHit, -kNoHit, -kNoHit);
  for (int k = 0; k < count; ++k)
    for (int r = 0; r < kTileSide; ++r) {
      const Int4 hit = hits[k].who[r] >= 0;
      const Lanes3 p = hits[k].t[r] * hits[k].d[r];
      lo = select(hit, min(lo, p), lo);
      hi = select(hit, max(hi, p), hi);
    }
  const float x1 = largest(hi.x), y1 = largest(hi.y), z1 = largest(hi.z);
  const float x0 = -largest(-lo.x), y0 = -largest(-lo.y), z0 = -largest(-lo.z);
  if (!(x0 <= x1)) return {0, 0, 0, -1};
  const float dx = x1 - x0, dy = y1 - y0, dz = z1 - z0;
  return {0.5f * (x0 + x1), 0.5f * (y0 + y1), 0.5f * (z0 + z1),
          0.5f * std::sqrt(dx * dx + dy * dy + dz * dz)};
}

// Primitives that may stand between the ball and the light.
int32_t list_shadows(const Painter& painter, const Ball& ball, int32_t* out) {
  const float lx = painter.lights.key.x[0], ly = painter.lights.key.y[0], lz = painter.lights.key.z[0];
  int32_t n = 0;
  for (int32_t k = 0; k < painter.all.count; ++k) {
    const Primitive& s = painter.scratch.primitives[painter.all.at[k]];
    if (s.kind == ShapeKind::kPlane) continue;
    const float x = s.p_ES[0] - ball.x, y = s.p_ES[1] - ball.y, z = s.p_ES[2] - ball.z;
    const float along = x * lx + y * ly + z * lz, reach = 1.01f * (s.radius + ball.r) + 1e-3f;
    if (along < -reach) continue;
    const float wide = reach + static_cast<float>(1.1 * kLightSpread) * (along + reach);
    if (x * x + y * y + z * z - along * along <= wide * wide) out[n++] = painter.all.at[k];
  }
  return n;
}

// Primitives that may hide a part of the sky from the ball.
int32_t list_near(const Painter& painter, const Ball& ball, int32_t* out) {
  int32_t n = 0;
  for (int32_t k = 0; k < painter.all.count; ++k) {
    const Primitive& s = painter.scratch.primitives[painter.all.at[k]];
    if (s.kind == ShapeKind::kPlane) continue;
    const float x = s.p_ES[0] - ball.x, y = s.p_ES[1] - ball.y, z = s.p_ES[2] - ball.z;
    const float reach = 1.01f * (s.radius + ball.r + kOcclusionReach * s.thick);
    if (x * x + y * y + z * z <= reach * reach) out[n++] = painter.all.at[k];
  }
  return n;
}

// Share of the light's rays of a sample that reach the points p.
Float4 light_share(const Painter& painter, const IndexList& list, Int4 who, const Lanes3& p, const Lanes3& n,
                   int sample, int row) {
  const LightRays& lights = painter.lights;
  const int samples = painter.options.samples_per_side * painter.options.samples_per_side;
  Int4 left[kMaxRaysPerSample];
  for (int j = 0; j < lights.per_sample; ++j)
    left[j] = (who >= 0) & (dot(n, lights.at[sample + j * samples][row]) > 0.0f);
  Float4 lost = splat(0);
  for (int32_t k = 0; k < list.count; ++k) {
    const Primitive& s = painter.scratch.primitives[list.at[k]];
    const Lanes3 o = to_shape(s, p);
    // A convex shape throws no shadow on itself; its rounded normals would say so at the edges.
    const Int4 other = who != list.at[k];
    for (int j = 0; j < lights.per_sample; ++j) {
      const Int4 asked = left[j] & other;
      if (!any(asked)) continue;
      const Float4 t = entry(s, o, rotate_to_shape(s, lights.at[sample + j * samples][row]));
      const Int4 dark = asked & (t > kOffSurface) & (t < kNoHit);
      lost += select(dark, splat(1), splat(0));
      left[j] &= ~dark;
    }
  }
  return 1.0f - lost * (1 / static_cast<float>(lights.per_sample));
}

// Colour of a plane where the rays d meet it at depth t; a sample stands for `share` of a pixel's side.
Lanes3 floor_albedo(const Painter& painter, const Primitive& s, const Lanes3& d, Float4 t, float share) {
  const Lanes3 v = rotate_to_shape(s, d);
  const Lanes3 right = rotate_to_shape(s, painter.rays.right), down = rotate_to_shape(s, painter.rays.down);
  const Float4 slope = 1.0f / select(v.z < 0.0f, v.z, splat(-1));
  const Float4 wx = abs(right.x - v.x * right.z * slope) + abs(down.x - v.x * down.z * slope);
  const Float4 wy = abs(right.y - v.y * right.z * slope) + abs(down.y - v.y * down.z * slope);
  return checker(s.color, s.o_S[0] + t * v.x, s.o_S[1] + t * v.y, share * t * wx, share * t * wy);
}

struct Nearby {
  IndexList shadow, near;
};

// Colour of four rays.
Lanes3 color_of(const Painter& painter, const Nearby& nearby, const Hits& hits, int r, int sample,
                float share) {
  const Lanes3 d = hits.d[r];
  const Int4 who = hits.who[r], hit = who >= 0;
  const Lanes3 behind = background(d);
  if (!any(hit)) return behind;
  const Float4 t = select(hit, hits.t[r], splat(1));
  Surface surface{t * d, d, splat(0, 0, 1), splat(0, 0, 0), splat(1), splat(1)};
  Int4 left = hit;
  Float4 fade = splat(0);
  for (int i = 0; i < kFloat4Lanes; ++i) {
    if (!left[i]) continue;
    const Int4 same = left & (who == who[i]);
    left &= ~same;
    const Primitive& s = painter.scratch.primitives[who[i]];
    const bool plane = s.kind == ShapeKind::kPlane;
    const Lanes3 n = rotate_from_shape(s, surface_normal(s, to_shape(s, surface.p)));
    surface.n = select(same, n, surface.n);
    const Lanes3 color =
        plane ? floor_albedo(painter, s, d, t, share) : splat(s.color[0], s.color[1], s.color[2]);
    surface.albedo = select(same, color, surface.albedo);
    if (plane) fade = select(same, haze(t * sqrt(dot(d, d)), s.o_S[2]), fade);
  }
  if (nearby.shadow.count > 0)
    surface.lit = light_share(painter, nearby.shadow, who, surface.p, surface.n, sample, r);
  for (int32_t k = 0; k < nearby.near.count; ++k) {
    const int32_t index = nearby.near.at[k];
    const Float4 hidden = occlusion(painter.scratch.primitives[index], surface.p, surface.n);
    surface.open = surface.open * (1.0f - select(who == index, splat(0), 0.8f * hidden));
  }
  const Lanes3 near_color = shade(surface, painter.lights.key);
  return select(hit, mix(near_color, behind, fade), behind);
}

void store(const Painter& painter, const Lanes3 (&sum)[kTileSide], float scale, int32_t x, int32_t y,
           uint8_t* rgb) {
  const int32_t width = painter.view.width, height = painter.view.height;
  for (int32_t r = 0; r < kTileSide && y + r < height; ++r)
    for (int32_t i = 0; i < kFloat4Lanes && x + i < width; ++i) {
      uint8_t* out =
          rgb + 3 * (static_cast<size_t>(y + r) * static_cast<size_t>(width) + static_cast<size_t>(x + i));
      out[0] = to_srgb(scale * sum[r].x[i]);
      out[1] = to_srgb(scale * sum[r].y[i]);
      out[2] = to_srgb(scale * sum[r].z[i]);
    }
}

}  // namespace

LightRays make_light_rays(int32_t samples_per_side) {
  // Ranks of a 4 x 4 ordered dither: neighbours differ most.
  constexpr int kRank[kTileSide][kFloat4Lanes] = {
      {0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
  constexpr double kGoldenAngle = 2.399963229728653;
  LightRays out;
  const int samples = samples_per_side * samples_per_side;
  out.per_sample = samples > 1 && samples <= 16 ? kMaxRaysPerSample : 1;
  const Vec3 key = light_direction(0, 0);
  out.key = splat(static_cast<float>(key.x), static_cast<float>(key.y), static_cast<float>(key.z));
  const int count = samples * out.per_sample;
  for (int k = 0; k < count; ++k)
    for (int r = 0; r < kTileSide; ++r)
      for (int i = 0; i < kFloat4Lanes; ++i) {
        const double radius = count > 1 ? std::sqrt((k + 0.5) / count) : 0;
        const double angle = kGoldenAngle * k + kRank[r][i] * (std::numbers::pi / 8);
        const elementary::SinCos turn = elementary::sincos(angle);
        const Vec3 l = light_direction(radius * turn.cos, radius * turn.sin);
        out.at[k][r].x[i] = static_cast<float>(l.x);
        out.at[k][r].y[i] = static_cast<float>(l.y);
        out.at[k][r].z[i] = static_cast<float>(l.z);
      }
  return out;
}

void paint_tile(const Painter& painter, const IndexList& seen, bool flat, int32_t x, int32_t y,
                uint8_t* rgb) {
  const RenderOptions& options = painter.options;
  const Primitive* primitives = painter.scratch.primitives;
  const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
  Hits hits[kMaxSamplesPerSide * kMaxSamplesPerSide];
  Nearby nearby;
  const auto look_around = [&](int count, float margin) {
    Ball ball = ball_about(hits, count);
    if (ball.r < 0) {
      nearby = {};
      return;
    }
    ball.r *= margin;
    nearby.shadow = {painter.scratch.shadow,
                     options.shadows ? list_shadows(painter, ball, painter.scratch.shadow) : 0};
    nearby.near = {painter.scratch.near, list_near(painter, ball, painter.scratch.near)};
  };

  int side = options.samples_per_side;
  if (flat && side > 1) {
    trace(painter.rays, primitives, seen, options.cull, fx + 0.5f, fy + 0.5f, hits);
    look_around(1, 2);
    if (nearby.shadow.count == 0 && nearby.near.count == 0) side = 1;
  }
  const int count = side * side;
  const float share = 1 / static_cast<float>(side);
  for (int k = 0; k < count; ++k) {
    const int row = k / side, column = k % side;
    const float dx = share * (static_cast<float>(column) + 0.5f),
                dy = share * (static_cast<float>(row) + 0.5f);
    trace(painter.rays, primitives, seen, options.cull, fx + dx, fy + dy, &hits[k]);
  }
  look_around(count, 1);
  if (!options.cull) nearby = {options.shadows ? painter.all : IndexList{}, painter.all};

  Lanes3 sum[kTileSide] = {};
  for (int k = 0; k < count; ++k)
    for (int r = 0; r < kTileSide; ++r) sum[r] = sum[r] + color_of(painter, nearby, hits[k], r, k, share);
  store(painter, sum, share * share, x, y, rgb);
}

}  // namespace rdm

#include "sense/render/paint.hpp"

#include <cmath>
#include <numbers>

#include "base/elementary.hpp"
#include "sense/render/light.hpp"
#include "sense/render/shade.hpp"

namespace rdm {

namespace {

struct Nearby {
  IndexList shadow, near;
};

Lanes3 checkered(const Painter& painter, const Primitive& s, const Lanes3& d, Float4 t, float share) {
  const Footprint f = footprint(painter, s, d, t, share);
  return checker(s.color, f.x, f.y, f.wx, f.wy);
}

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
        plane ? checkered(painter, s, d, t, share) : splat(s.color[0], s.color[1], s.color[2]);
    surface.albedo = select(same, color, surface.albedo);
    if (plane) fade = select(same, haze(t * sqrt(dot(d, d)), s.o_S[2]), fade);
  }
  const int samples = painter.options.samples_per_side * painter.options.samples_per_side;
  if (nearby.shadow.count > 0)
    surface.lit = light_share(painter, nearby.shadow, who, surface.p, surface.n,
                              {sample, samples, painter.lights.per_sample}, r);
  for (int32_t k = 0; k < nearby.near.count; ++k) {
    const int32_t index = nearby.near.at[k];
    const Float4 hidden = occlusion(painter.scratch.primitives[index], surface.p, surface.n);
    surface.open = surface.open * (1.0f - select(who == index, splat(0), 0.8f * hidden));
  }
  const Lanes3 near_color = shade(surface, painter.lights.key);
  return select(hit, mix(near_color, behind, fade), behind);
}

}  // namespace

LightRays make_light_rays(int32_t samples_per_side, double spread) {
  // Ranks of a 4 x 4 ordered dither: neighbours differ most.
  constexpr int kRank[kTileSide][kFloat4Lanes] = {
      {0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
  constexpr double kGoldenAngle = 2.399963229728653;
  LightRays out;
  const int samples = samples_per_side * samples_per_side;
  out.per_sample = samples > 1 && samples <= 16 ? kRaysPerSample : 1;
  const Vec3 key = light_direction(0, 0);
  out.key = splat(static_cast<float>(key.x), static_cast<float>(key.y), static_cast<float>(key.z));
  const int count = samples * out.per_sample;
  for (int k = 0; k < count; ++k)
    for (int r = 0; r < kTileSide; ++r)
      for (int i = 0; i < kFloat4Lanes; ++i) {
        const double radius = count > 1 ? std::sqrt((k + 0.5) / count) : 0;
        const double angle = kGoldenAngle * k + kRank[r][i] * (std::numbers::pi / 8);
        const elementary::SinCos turn = elementary::sincos(angle);
        const Vec3 l = light_direction(radius * turn.cos, radius * turn.sin, spread);
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
    nearby.shadow = {painter.scratch.shadow, options.shadows
                                                 ? list_toward(painter, ball, light_direction(0, 0),
                                                               kLightSpread, painter.scratch.shadow)
                                                 : 0};
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
  store_tile<to_srgb>(painter, sum, share * share, x, y, rgb);
}

}  // namespace rdm

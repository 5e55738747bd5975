#include "sense/render/fine.hpp"

#include <algorithm>
#include <cmath>

#include "sense/render/fine_shade.hpp"
#include "sense/render/light.hpp"

namespace rdm {

namespace {

// Samples of a pixel: few where all of a tile shows one surface, more where edges are. The light's rays that
// they share: a quick look for half shadows, then all of them; edges hide noise, and make do with fewer.
constexpr int kFewSide = 2, kFew = kFewSide * kFewSide;
constexpr int kManySide = 3, kMany = kManySide * kManySide;
constexpr int kLightRays = kFineLightSide * kFineLightSide * kRaysPerSample;
RaySet quick_rays(int sample) {
  return {sample * (kLightRays / (4 * kFew)), kLightRays / 4, 4};
}
RaySet all_rays(int sample) {
  return {sample, kFew, kLightRays / kFew};
}
RaySet edge_rays(int sample) {
  return {sample, 2 * kMany, 4};
}
static_assert(kLightRays / kFew <= kMaxRaysPerSample && kMany + 3 * 2 * kMany <= kLightRays);

constexpr float kMirror = 0.05f;         // of floors, head on
constexpr float kMirrorReach = 0.35f;    // m along the mirrored ray at which half is left
constexpr float kMirrorSpread = 0.035f;  // tangent of the half angle into which floors scatter it

struct Nearby {
  IndexList shadow, near, mirror;
};

int grain_axis(const Primitive& s) {
  if (s.kind == ShapeKind::kCapsule || s.kind == ShapeKind::kCylinder) return 2;
  return s.size[0] > s.size[1] ? (s.size[0] > s.size[2] ? 0 : 2) : (s.size[1] > s.size[2] ? 1 : 2);
}

Lanes3 albedo_at(const Primitive& s, const Lanes3& p_S) {
  const Lanes3 color = splat(s.color[0], s.color[1], s.color[2]);
  if (s.finish != Finish::kWood) return color;
  const Float4 g = grain(p_S, grain_axis(s), s.id);
  return color * Lanes3{g, g * g, g * g * g};
}

Lanes3 tiled(const Painter& painter, const Primitive& s, const Lanes3& d, Float4 t, float share) {
  const Footprint f = footprint(painter, s, d, t, share);
  return tiles(s.color, f.x, f.y, f.wx, f.wy);
}

// Nearest of the listed primitives that rays o + t d in E meet beyond a surface; those of `skip` are left out.
struct Second {
  Float4 t;
  Int4 who;
};
Second follow(const Painter& painter, const IndexList& list, const Lanes3& o, const Lanes3& d, Int4 asked,
              Int4 skip, bool glass) {
  Second out{splat(static_cast<float>(kMaxDepth)), splat_int(-1)};
  for (int32_t k = 0; k < list.count; ++k) {
    const Primitive& s = painter.scratch.primitives[list.at[k]];
    if (!glass && s.finish == Finish::kGlass) continue;
    const Float4 t = entry(s, to_shape(s, o), rotate_to_shape(s, d));
    const Int4 closer = asked & (skip != list.at[k]) & (t > 1e-4f) & (t < out.t);
    out.t = select(closer, t, out.t);
    out.who = select(closer, splat_int(list.at[k]), out.who);
  }
  return out;
}

// Colour of what a second ray meets: lit, but without shadows of its own.
Lanes3 glimpse(const Painter& painter, const Second& hit, const Lanes3& o, const Lanes3& d,
               const Lanes3& missed) {
  Lanes3 out = missed;
  Int4 left = hit.who >= 0;
  const Lanes3 p = o + select(left, hit.t, splat(0)) * d;
  for (int i = 0; i < kFloat4Lanes; ++i) {
    if (!left[i]) continue;
    const Int4 same = left & (hit.who == hit.who[i]);
    left &= ~same;
    const Primitive& s = painter.scratch.primitives[hit.who[i]];
    const Lanes3 p_S = to_shape(s, p);
    const Lanes3 n = rotate_from_shape(s, surface_normal(s, p_S));
    const Lanes3 albedo = s.kind == ShapeKind::kPlane
                              ? tiles(s.color, p_S.x, p_S.y, splat(0.01f), splat(0.01f))
                              : albedo_at(s, p_S);
    const Surface seen{p, d, n, albedo, splat(0.8f), splat(0.8f)};
    Lanes3 color = shade_fine(seen, look_of(s.finish), painter.lights.key);
    if (s.kind == ShapeKind::kPlane) color = mix(color, missed, haze(sqrt(dot(p, p)), s.o_S[2]));
    out = select(same, color, out);
  }
  return out;
}

// Colour of four rays.
Lanes3 color_of(const Painter& painter, const Nearby& nearby, const Hits& hits, int r, const RaySet& set,
                float share, Int4* half_lit) {
  const Lanes3 d = hits.d[r];
  const Lanes3& key = painter.lights.key;
  const Int4 who = hits.who[r], hit = who >= 0;
  const Lanes3 behind = sky(d, key);
  if (!any(hit)) return behind;
  const Float4 t = select(hit, hits.t[r], splat(1));
  Surface surface{t * d, d, splat(0, 0, 1), splat(0, 0, 0), splat(1), splat(1)};
  // Normals first, since light and occlusion want those of all four.
  Int4 left = hit;
  for (int i = 0; i < kFloat4Lanes; ++i) {
    if (!left[i]) continue;
    const Int4 same = left & (who == who[i]);
    left &= ~same;
    const Primitive& s = painter.scratch.primitives[who[i]];
    const Lanes3 p_S = to_shape(s, surface.p);
    surface.n = select(same, rotate_from_shape(s, surface_normal(s, p_S)), surface.n);
    surface.albedo =
        select(same, s.kind == ShapeKind::kPlane ? tiled(painter, s, d, t, share) : albedo_at(s, p_S),
               surface.albedo);
  }
  if (nearby.shadow.count > 0)
    surface.lit = light_share(painter, nearby.shadow, who, surface.p, surface.n, set, r);
  *half_lit |= (surface.lit > 0.0f) & (surface.lit < 1.0f);
  for (int32_t k = 0; k < nearby.near.count; ++k) {
    const int32_t index = nearby.near.at[k];
    const Float4 hidden = occlusion(painter.scratch.primitives[index], surface.p, surface.n);
    surface.open = surface.open * (1.0f - select(who == index, splat(0), 0.8f * hidden));
  }
  Lanes3 out = behind;
  left = hit;
  for (int i = 0; i < kFloat4Lanes; ++i) {
    if (!left[i]) continue;
    const Int4 same = left & (who == who[i]);
    left &= ~same;
    const Primitive& s = painter.scratch.primitives[who[i]];
    if (s.kind == ShapeKind::kPlane) {
      Lanes3 color = shade_fine(surface, look_of(Finish::kCloth), key);
      if (nearby.mirror.count > 0) {
        const Lanes3 v = normalized(d);
        const Float4 cosine = -dot(surface.n, v);
        const Lanes3 jitter = painter.lights.at[set.first][r] - key;
        const Lanes3 ray = normalized(v + (2.0f * cosine) * surface.n +
                                      splat(kMirrorSpread / static_cast<float>(kFineLightSpread)) * jitter);
        const Second second = follow(painter, nearby.mirror, surface.p, ray, same, who, true);
        const Float4 reach = second.t * (1 / kMirrorReach);
        const Float4 strength =
            select(second.who >= 0, fresnel(kMirror, cosine) / (1.0f + reach * reach), splat(0));
        color =
            mix(color, glimpse(painter, second, surface.p, ray, color), min(1.6f * strength, splat(0.6f)));
      }
      const Float4 fade = haze(t * sqrt(dot(d, d)), s.o_S[2]);
      out = select(same, mix(color, behind, fade), out);
      continue;
    }
    const Look& look = look_of(s.finish);
    Lanes3 color = shade_fine(surface, look, key);
    if (look.through > 0) {
      const Second second = follow(painter, painter.all, surface.p, d, same, who, false);
      const Lanes3 beyond = glimpse(painter, second, surface.p, d, behind);
      const Lanes3 tint = mix(splat(1, 1, 1), surface.albedo, splat(0.85f));
      const Float4 facing = clamp(-dot(surface.n, normalized(d)), 0, 1);
      const Float4 passes = look.through * (1.0f - fresnel(look.mirror, facing));
      color = mix(color, tint * beyond, passes);
    }
    out = select(same, color, out);
  }
  return out;
}

// Primitives that rays from the eye to the ball may meet once a level floor has mirrored them.
int32_t list_mirrored(const Painter& painter, const Ball& ball, int32_t* out) {
  const Vec3 at{ball.x, ball.y, ball.z};
  const double distance = norm(at);
  if (!(distance > 1e-3)) return 0;
  return list_toward(painter, ball, 1 / distance * Vec3{at.x, at.y, -at.z},
                     2 * kMirrorSpread + ball.r / distance, out);
}

Nearby look_around(const Painter& painter, const Ball& ball, bool plane) {
  const RaycastScratch& scratch = painter.scratch;
  Nearby out;
  if (ball.r < 0) return out;
  if (!painter.options.cull) return {painter.all, painter.all, plane ? painter.all : IndexList{}};
  out.shadow = {scratch.shadow,
                list_toward(painter, ball, light_direction(0, 0), kFineLightSpread, scratch.shadow)};
  out.near = {scratch.near, list_near(painter, ball, scratch.near)};
  if (plane) out.mirror = {scratch.mirror, list_mirrored(painter, ball, scratch.mirror)};
  return out;
}

// Whether every ray of the samples meets the same thing: nothing, or one primitive.
bool uniform(const Hits* hits, int count) {
  const Int4 first = splat_int(hits[0].who[0][0]);
  Int4 differs = splat_int(0);
  for (int k = 0; k < count; ++k)
    for (int r = 0; r < kTileSide; ++r) differs |= hits[k].who[r] != first;
  return !any(differs);
}

}  // namespace

void paint_fine_tile(const Painter& painter, const IndexList& seen, int32_t x, int32_t y, uint8_t* rgb) {
  const Primitive* primitives = painter.scratch.primitives;
  const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
  const bool cull = painter.options.cull;
  const bool plane = std::any_of(seen.at, seen.at + seen.count,
                                 [&](int32_t k) { return primitives[k].kind == ShapeKind::kPlane; });
  Hits hits[kMany];
  Nearby nearby;
  Lanes3 sum[kTileSide] = {};
  const auto trace_all = [&](int side) {
    const float share = 1 / static_cast<float>(side);
    for (int k = 0; k < side * side; ++k) {
      const int row = k / side, column = k % side;
      trace(painter.rays, primitives, seen, cull, fx + share * (static_cast<float>(column) + 0.5f),
            fy + share * (static_cast<float>(row) + 0.5f), &hits[k]);
    }
    nearby = look_around(painter, ball_about(hits, side * side), plane);
  };
  const auto color_all = [&](int side, RaySet (&rays)(int)) {  // whether any point is half in shadow
    Int4 half_lit = splat_int(0);
    for (int r = 0; r < kTileSide; ++r) sum[r] = splat(0, 0, 0);
    for (int k = 0; k < side * side; ++k)
      for (int r = 0; r < kTileSide; ++r)
        sum[r] =
            sum[r] + color_of(painter, nearby, hits[k], r, rays(k), 1 / static_cast<float>(side), &half_lit);
    return any(half_lit);
  };
  int side = kFewSide;
  trace_all(side);
  if (!uniform(hits, kFew)) {
    side = kManySide;
    trace_all(side);
    color_all(side, edge_rays);
  } else if (color_all(side, quick_rays)) {
    color_all(side, all_rays);
  }
  const float share = 1 / static_cast<float>(side);
  store_tile<to_fine_srgb>(painter, sum, share * share, x, y, rgb);
}

}  // namespace rdm

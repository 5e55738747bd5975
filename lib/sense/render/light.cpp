#include "sense/render/light.hpp"

#include <cmath>

#include "sense/render/shade.hpp"

namespace rdm {

namespace {
constexpr float kOffSurface = 1e-4f;  // m: nearer, a shadow's caster is the surface itself
}  // namespace

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

int32_t list_toward(const Painter& painter, const Ball& ball, const Vec3& to, double spread, int32_t* out) {
  const auto lx = static_cast<float>(to.x), ly = static_cast<float>(to.y), lz = static_cast<float>(to.z);
  int32_t n = 0;
  for (int32_t k = 0; k < painter.all.count; ++k) {
    const Primitive& s = painter.scratch.primitives[painter.all.at[k]];
    if (s.kind == ShapeKind::kPlane) continue;
    const float x = s.p_ES[0] - ball.x, y = s.p_ES[1] - ball.y, z = s.p_ES[2] - ball.z;
    const float along = x * lx + y * ly + z * lz, reach = 1.01f * (s.radius + ball.r) + 1e-3f;
    if (along < -reach) continue;
    const float wide = reach + static_cast<float>(1.1 * spread) * (along + reach);
    if (x * x + y * y + z * z - along * along <= wide * wide) out[n++] = painter.all.at[k];
  }
  return n;
}

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

Float4 light_share(const Painter& painter, const IndexList& list, Int4 who, const Lanes3& p, const Lanes3& n,
                   const RaySet& set, int row) {
  const LightRays& lights = painter.lights;
  const auto ray = [&](int j) -> const Lanes3& { return lights.at[set.first + j * set.stride][row]; };
  Int4 left[kMaxRaysPerSample];
  for (int j = 0; j < set.count; ++j) left[j] = (who >= 0) & (dot(n, ray(j)) > 0.0f);
  Float4 lost = splat(0);
  for (int32_t k = 0; k < list.count; ++k) {
    const Primitive& s = painter.scratch.primitives[list.at[k]];
    const Lanes3 o = to_shape(s, p);
    // A convex shape throws no shadow on itself; its rounded normals would say so at the edges.
    const Int4 other = who != list.at[k];
    for (int j = 0; j < set.count; ++j) {
      const Int4 asked = left[j] & other;
      if (!any(asked)) continue;
      const Float4 t = entry(s, o, rotate_to_shape(s, ray(j)));
      const Int4 dark = asked & (t > kOffSurface) & (t < kNoHit);
      lost += select(dark, splat(1), splat(0));
      left[j] &= ~dark;
    }
  }
  return 1.0f - lost * (1 / static_cast<float>(set.count));
}

Footprint footprint(const Painter& painter, const Primitive& s, const Lanes3& d, Float4 t, float share) {
  const Lanes3 v = rotate_to_shape(s, d);
  const Lanes3 right = rotate_to_shape(s, painter.rays.right), down = rotate_to_shape(s, painter.rays.down);
  const Float4 slope = 1.0f / select(v.z < 0.0f, v.z, splat(-1));
  const Float4 wx = abs(right.x - v.x * right.z * slope) + abs(down.x - v.x * down.z * slope);
  const Float4 wy = abs(right.y - v.y * right.z * slope) + abs(down.y - v.y * down.z * slope);
  return {s.o_S[0] + t * v.x, s.o_S[1] + t * v.y, share * t * wx, share * t * wy};
}

}  // namespace rdm

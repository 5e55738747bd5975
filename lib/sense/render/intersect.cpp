#include "sense/render/intersect.hpp"

#include <algorithm>

namespace rdm {

namespace {

constexpr float kRounding = 0.004f;  // m

// How far |v| reaches into the rounded rim of a half length, with v's sign.
Float4 rim(Float4 v, float half, float rounding) {
  const Float4 over = max(abs(v) - (half - rounding), splat(0));
  return select(v < 0.0f, -over, over);
}

// Of the faces near p's, by how near they are: edges look as round as a radius of about `round`.
Lanes3 round_hull_normal(const Hull& hull, const Lanes3& p, float round) {
  Float4 most = splat(-kNoHit);
  for (int32_t i = 0; i < hull.num_faces; ++i)
    most = max(most, dot(wide(hull.faces[i].n), p) - static_cast<float>(hull.faces[i].offset));
  Lanes3 sum = splat(0, 0, 0);
  for (int32_t i = 0; i < hull.num_faces; ++i) {
    const Lanes3 n = wide(hull.faces[i].n);
    const Float4 behind = most - (dot(n, p) - static_cast<float>(hull.faces[i].offset));
    const Float4 share = max(1.0f - behind * (1 / round), splat(0));
    sum = sum + (share * share) * n;
  }
  return normalized(sum);
}

// Of the face whose plane p is farthest out of.
Lanes3 hull_normal(const Hull& hull, const Lanes3& p) {
  Lanes3 best = splat(0, 0, 1);
  Float4 most = splat(-kNoHit);
  for (int32_t i = 0; i < hull.num_faces; ++i) {
    const Hull::Face& face = hull.faces[i];
    const Lanes3 n = wide(face.n);
    const Float4 beyond = dot(n, p) - static_cast<float>(face.offset);
    best = select(beyond > most, n, best);
    most = max(most, beyond);
  }
  return best;
}

}  // namespace

Lanes3 surface_normal(const Primitive& s, const Lanes3& p) {
  switch (s.kind) {
    case ShapeKind::kSphere:
      return normalized(p);
    case ShapeKind::kCapsule:
      return normalized(Lanes3{p.x, p.y, p.z - clamp(p.z, -s.size[1], s.size[1])});
    case ShapeKind::kBox: {
      if (s.round > 0)
        return normalized(p - Lanes3{clamp(p.x, s.round - s.size[0], s.size[0] - s.round),
                                     clamp(p.y, s.round - s.size[1], s.size[1] - s.round),
                                     clamp(p.z, s.round - s.size[2], s.size[2] - s.round)});
      const float r = std::min(kRounding, 0.4f * std::min({s.size[0], s.size[1], s.size[2]}));
      return normalized(Lanes3{rim(p.x, s.size[0], r), rim(p.y, s.size[1], r), rim(p.z, s.size[2], r)});
    }
    case ShapeKind::kCylinder: {
      const float r = std::min(kRounding, 0.4f * std::min(s.size[0], s.size[1]));
      const Float4 across = sqrt(p.x * p.x + p.y * p.y);
      const Float4 scale = rim(across, s.size[0], r) / max(across, splat(1e-12f));
      return normalized(Lanes3{scale * p.x, scale * p.y, rim(p.z, s.size[1], r)});
    }
    case ShapeKind::kEllipsoid: {
      const float x = 1 / s.size[0], y = 1 / s.size[1], z = 1 / s.size[2];
      return normalized(Lanes3{x * x * p.x, y * y * p.y, z * z * p.z});
    }
    case ShapeKind::kHull:
      return s.round > 0 ? round_hull_normal(*s.hull, p, s.round) : hull_normal(*s.hull, p);
    case ShapeKind::kPlane:
      break;
  }
  return splat(0, 0, 1);
}

}  // namespace rdm

#include "sense/entry.hpp"

#include <algorithm>

namespace rdm {

namespace {

constexpr float kRounding = 0.004f;  // m

// How far |v| reaches into the rounded rim of a half length, with v's sign.
Lanes rim(Lanes v, float half, float rounding) {
  const Lanes over = max(abs(v) - (half - rounding), splat(0));
  return select(v < 0.0f, -over, over);
}

}  // namespace

Lanes3 surface_normal(const Primitive& s, const Lanes3& p) {
  switch (s.kind) {
    case ShapeKind::kSphere:
      return normalized(p);
    case ShapeKind::kCapsule:
      return normalized(Lanes3{p.x, p.y, p.z - clamp(p.z, -s.size[1], s.size[1])});
    case ShapeKind::kBox: {
      const float r = std::min(kRounding, 0.4f * std::min({s.size[0], s.size[1], s.size[2]}));
      return normalized(Lanes3{rim(p.x, s.size[0], r), rim(p.y, s.size[1], r), rim(p.z, s.size[2], r)});
    }
    case ShapeKind::kCylinder: {
      const float r = std::min(kRounding, 0.4f * std::min(s.size[0], s.size[1]));
      const Lanes across = sqrt(p.x * p.x + p.y * p.y);
      const Lanes scale = rim(across, s.size[0], r) / max(across, splat(1e-12f));
      return normalized(Lanes3{scale * p.x, scale * p.y, rim(p.z, s.size[1], r)});
    }
    case ShapeKind::kPlane:
      break;
  }
  return splat(0, 0, 1);
}

}  // namespace rdm

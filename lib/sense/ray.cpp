#include "sense/ray.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sense/render/intersect.hpp"
#include "sense/scene_shapes.hpp"

namespace rdm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// How far along o + t d, in the shape's frame, the line enters it. Pictures' intersections are floats, so they
// are asked from the point that is nearest to the shape's centre.
double entry_of(const RenderShape& shape, const Vec3& o, const Vec3& d) {
  if (shape.kind == ShapeKind::kPlane) return o.z > 0 && d.z < 0 ? -o.z / d.z : kInfinity;
  const double middle = -dot(o, d);
  const Vec3 nearest = o + middle * d;
  const double radius = shape.kind == ShapeKind::kCapsule ? shape.size.x + shape.size.y : norm(shape.size);
  if (norm(nearest) > radius) return kInfinity;
  Primitive s{};
  s.kind = shape.kind;
  s.hull = shape.hull;
  for (int k = 0; k < 3; ++k) s.size[k] = static_cast<float>(shape.size[k]);
  return middle + static_cast<double>(entry(s, wide(nearest), wide(d))[0]);
}

// At a point of the surface; of edges the side that it is farthest out of.
Vec3 normal_at(const RenderShape& shape, const Vec3& p) {
  const Vec3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return normalized(p);
    case ShapeKind::kCapsule:
      return normalized(Vec3{p.x, p.y, p.z - std::clamp(p.z, -s.y, s.y)});
    case ShapeKind::kEllipsoid:
      return normalized(Vec3{p.x / (s.x * s.x), p.y / (s.y * s.y), p.z / (s.z * s.z)});
    case ShapeKind::kCylinder:
      if (std::sqrt(p.x * p.x + p.y * p.y) - s.x > std::fabs(p.z) - s.y) return normalized(Vec3{p.x, p.y, 0});
      return {0, 0, std::copysign(1.0, p.z)};
    case ShapeKind::kBox: {
      int side = 0;
      for (int k = 1; k < 3; ++k)
        if (std::fabs(p[k]) - s[k] > std::fabs(p[side]) - s[side]) side = k;
      Vec3 n;
      n[side] = std::copysign(1.0, p[side]);
      return n;
    }
    case ShapeKind::kHull: {
      const Hull::Face* const faces = shape.hull->faces;
      const auto out = [&](const Hull::Face& f) { return dot(f.n, p) - f.offset; };
      return std::max_element(faces, faces + shape.hull->num_faces,
                              [&](const Hull::Face& a, const Hull::Face& b) { return out(a) < out(b); })
          ->n;
    }
    case ShapeKind::kPlane:
      break;
  }
  return {0, 0, 1};
}

}  // namespace

bool cast_ray(const World& world, const Vec3& origin, const Vec3& direction, double range, RayHit* out) {
  RayHit hit;
  hit.distance = kInfinity;
  for (int32_t i = 0; i < static_cast<int32_t>(world.scene().shapes.size()); ++i) {
    const RenderShape shape = shape_of(world, i);
    const Mat3 R_WS = to_matrix(shape.X_WS.q), R_SW = transpose(R_WS);
    const Vec3 o = R_SW * (origin - shape.X_WS.p), d = R_SW * direction;
    const double t = entry_of(shape, o, d);
    if (!(t > 0 && t <= range && t < hit.distance)) continue;
    hit = {i, t, origin + t * direction, R_WS * normal_at(shape, o + t * d)};
  }
  if (hit.shape >= 0) *out = hit;
  return hit.shape >= 0;
}

}  // namespace rdm

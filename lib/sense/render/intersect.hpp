// Where rays enter a primitive, and its normal there, for four rays at once. Exact analytic forms.
//
// A ray is o + t d in the shape's frame S; t is the depth, d is not of unit length (primitive.hpp). Each form
// (Ericson, "Real-time collision detection", 2005, 5.3; Hughes et al., "Computer graphics", 2013, ch. 15):
//   sphere     |o + t d|^2 = r^2: t = t_m - sqrt((r^2 - |m|^2) / d.d), m = o + t_m d the point nearest the
//              centre
//   tube z     a t^2 + 2 b t + c = 0 of the parts normal to z, from m instead of o: the same root, without
//              the difference of large numbers that a far eye would give; a capsule is a tube and the sphere
//              of the end that the ray meets first, a cylinder what is within the tube and between two planes
//   ellipsoid  a sphere of radius 1 once all is divided by the half axes
//   box        slabs (Kay and Kajiya 1986): the last of three entries, if it comes before the first of three
//              exits
//   hull       the same over the planes of its faces (Cyrus and Beck 1978)
//   round box  all points within r of a smaller box. Along a ray the square of the distance to a convex body is a
//              convex function, so Newton's method from outside never passes the first root
//
// Only entering counts: an eye inside a shape looks out of it, and a ray that leaves a surface never meets
// that surface again. All shapes are convex.
#pragma once
#include <limits>

#include "sense/render/primitive.hpp"

namespace rdm {

inline constexpr float kNoHit = std::numeric_limits<float>::infinity();

namespace detail {

// The point of the line nearest to the shape's centre: solving from there keeps small radii exact at large
// distances.
struct Middle {
  Float4 dd, t;
  Lanes3 p;
};
inline Middle middle(const Lanes3& o, const Lanes3& d) {
  const Float4 dd = dot(d, d);
  const Float4 t = -dot(o, d) / dd;
  return {dd, t, o + t * d};
}

// d without zeros, so that 1 / d is finite.
inline Float4 not_zero(Float4 d) {
  return select(abs(d) < 1e-12f, splat(1e-12f), d);
}

// Half chord of the infinite cylinder about z: roots are (-b +- root) / a. A floor under a turns a ray along
// the axis into one that meets the cylinder far away, beyond both ends.
struct Tube {
  Float4 a, b, c, square;
};
inline Tube tube(const Middle& m, const Lanes3& d, float radius) {
  const Float4 a = max(d.x * d.x + d.y * d.y, 1e-9f * m.dd);
  const Float4 b = m.p.x * d.x + m.p.y * d.y;
  const Float4 c = m.p.x * m.p.x + m.p.y * m.p.y - radius * radius;
  return {a, b, c, b * b - a * c};
}

inline Float4 entry_sphere(const Primitive& s, const Lanes3& o, const Lanes3& d) {
  const Middle m = middle(o, d);
  const Float4 square = s.size[0] * s.size[0] - dot(m.p, m.p);
  return select(square >= 0.0f, m.t - sqrt(max(square, splat(0)) / m.dd), splat(kNoHit));
}

inline Float4 entry_capsule(const Primitive& s, const Lanes3& o, const Lanes3& d) {
  const float radius = s.size[0], half = s.size[1];
  const Middle m = middle(o, d);
  const Tube k = tube(m, d, radius);
  const Int4 meets = k.square >= 0.0f;
  if (!any(meets)) return splat(kNoHit);
  const Float4 side = (-k.b - sqrt(max(k.square, splat(0)))) / k.a;
  const Float4 z = m.p.z + side * d.z;
  const Float4 end = clamp(z, -half, half);
  const Int4 straight = z == end;
  // The ball at the end that the side's point lies beyond.
  const Float4 w = m.p.z - end;
  const Float4 b = k.b + w * d.z;
  const Float4 square = b * b - m.dd * (k.c + w * w);
  const Float4 ball = (-b - sqrt(max(square, splat(0)))) / m.dd;
  const Int4 hit = meets & (straight | (square >= 0.0f));
  return select(hit, m.t + select(straight, side, ball), splat(kNoHit));
}

inline Float4 entry_cylinder(const Primitive& s, const Lanes3& o, const Lanes3& d) {
  const float radius = s.size[0], half = s.size[1];
  const Middle m = middle(o, d);
  const Tube k = tube(m, d, radius);
  const Int4 meets = k.square >= 0.0f;
  if (!any(meets)) return splat(kNoHit);
  const Float4 root = sqrt(max(k.square, splat(0)));
  const Float4 inv = 1.0f / not_zero(d.z);
  const Float4 below = (-half - m.p.z) * inv, above = (half - m.p.z) * inv;
  const Float4 in = max((-k.b - root) / k.a, min(below, above));
  const Float4 out = min((-k.b + root) / k.a, max(below, above));
  return select(meets & (in <= out), m.t + in, splat(kNoHit));
}

inline Float4 entry_box(const Primitive& s, const Lanes3& o, const Lanes3& d) {
  const Float4 ix = 1.0f / not_zero(d.x), iy = 1.0f / not_zero(d.y), iz = 1.0f / not_zero(d.z);
  const Float4 ax = (-s.size[0] - o.x) * ix, bx = (s.size[0] - o.x) * ix;
  const Float4 ay = (-s.size[1] - o.y) * iy, by = (s.size[1] - o.y) * iy;
  const Float4 az = (-s.size[2] - o.z) * iz, bz = (s.size[2] - o.z) * iz;
  const Float4 in = max(max(min(ax, bx), min(ay, by)), min(az, bz));
  const Float4 out = min(min(max(ax, bx), max(ay, by)), max(az, bz));
  return select(in <= out, in, splat(kNoHit));
}

inline Float4 entry_round_box(const Primitive& s, const Lanes3& o, const Lanes3& d) {
  constexpr int kSteps = 10;
  const Float4 first = entry_box(s, o, d);
  Int4 left = first < kNoHit;
  if (!any(left)) return first;
  const float r = s.round;
  Lanes3 p = o + select(left, first, splat(0)) * d;
  Float4 t = first, gap = splat(0);
  for (int i = 0; i < kSteps; ++i) {
    const Lanes3 v =
        p - Lanes3{clamp(p.x, r - s.size[0], s.size[0] - r), clamp(p.y, r - s.size[1], s.size[1] - r),
                   clamp(p.z, r - s.size[2], s.size[2] - r)};
    gap = dot(v, v) - r * r;
    const Float4 slope = 2.0f * dot(v, d);
    const Int4 outside = gap > 0.0f;
    left &= ~(outside & (slope >= 0.0f));
    const Float4 step = select(left & outside, -gap / select(slope < 0.0f, slope, splat(-1)), splat(0));
    if (!any(left & (gap > 1e-4f * r * r))) break;
    t += step;
    p = p + step * d;
  }
  return select(left & (gap < 0.02f * r * r), t, splat(kNoHit));
}

inline Float4 entry_ellipsoid(const Primitive& s, const Lanes3& o, const Lanes3& d) {
  const float x = 1 / s.size[0], y = 1 / s.size[1], z = 1 / s.size[2];
  const Middle m = middle({x * o.x, y * o.y, z * o.z}, {x * d.x, y * d.y, z * d.z});
  const Float4 square = 1.0f - dot(m.p, m.p);
  return select(square >= 0.0f, m.t - sqrt(max(square, splat(0)) / m.dd), splat(kNoHit));
}

inline Float4 entry_hull(const Primitive& s, const Lanes3& o, const Lanes3& d) {
  Float4 in = splat(-kNoHit), out = splat(kNoHit);
  for (int32_t i = 0; i < s.hull->num_faces; ++i) {
    const Hull::Face& face = s.hull->faces[i];
    const Lanes3 n = wide(face.n);
    const Float4 slope = not_zero(dot(n, d));
    const Float4 t = (static_cast<float>(face.offset) - dot(n, o)) / slope;
    in = select(slope < 0.0f, max(in, t), in);
    out = select(slope < 0.0f, out, min(out, t));
  }
  return select(in <= out, in, splat(kNoHit));
}

inline Float4 entry_plane(const Lanes3& o, const Lanes3& d) {
  const Int4 meets = (o.z > 0.0f) & (d.z < 0.0f);
  return select(meets, o.z / select(meets, -d.z, splat(1)), splat(kNoHit));
}

}  // namespace detail

// t at which the lines o + t d, in the shape's frame, enter the shape; kNoHit where they miss it. A t that
// is not positive means that the shape lies behind o, or holds it.
inline Float4 entry(const Primitive& s, const Lanes3& o, const Lanes3& d) {
  switch (s.kind) {
    case ShapeKind::kSphere:
      return detail::entry_sphere(s, o, d);
    case ShapeKind::kCapsule:
      return detail::entry_capsule(s, o, d);
    case ShapeKind::kBox:
      return s.round > 0 ? detail::entry_round_box(s, o, d) : detail::entry_box(s, o, d);
    case ShapeKind::kCylinder:
      return detail::entry_cylinder(s, o, d);
    case ShapeKind::kEllipsoid:
      return detail::entry_ellipsoid(s, o, d);
    case ShapeKind::kHull:
      return detail::entry_hull(s, o, d);
    case ShapeKind::kPlane:
      return detail::entry_plane(o, d);
  }
  return splat(kNoHit);
}

// Unit normals at points p of the surface, in the shape's frame. The edges of boxes and cylinders are
// rounded off by up to 4 mm, for the eye only.
Lanes3 surface_normal(const Primitive& s, const Lanes3& p);

}  // namespace rdm

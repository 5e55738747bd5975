#include "physics/collision/manifold.hpp"

#include <algorithm>
#include <cmath>

#include "physics/collision/thinning.hpp"

// The contact of two convex solids in stages:
//   1. two round sides (spheres, capsules, sides of cylinders): with r = p_a - p_b, k = u_a . u_b,
//      a = u_a . r, b = u_b . r the lines p_a + s u_a and p_b + t u_b are nearest at
//        s = (k b - a) / (1 - k^2),   t = k s + b,
//      and an end takes the place of what lies beyond it (Ericson, Real-Time Collision Detection, 2005,
//      section 5.1.9). Where 1 - k^2 is small: the two ends of the stretch side by side.
//   2. all others: the overlap's normal n and depth (convex.cpp), and what each solid shows along n.
//   3. if a shown face stands square to n, the other feature is clipped at the sides of that face
//      (Sutherland and Hodgman, Reentrant polygon clipping, 1974). What is below it counts, with depth
//      n_face . (p_face - p). It is the reference face of Box2D's manifolds. Else one point, in the middle.
//   4. at most kManifoldPoints stay (thinning.hpp).
// Points and normals are in the world; normals point from b into a.
namespace rdm {
namespace {

constexpr double kFlat = 0.985;      // cosine between the overlap's normal and a face it counts for
constexpr double kAlong = 0.1;       // sine between two edges that count as along each other
constexpr double kPreferred = 1e-3;  // by which a's face must fit better than b's to be the one cut at
constexpr double kSideways = 1e-9;   // sine of two axes that have no crossing
constexpr double kDeepEnough = 0.9;  // share of the deepest point's depth at which two ends may replace it
constexpr int kMostCut = 2 * Feature::kMost;
static_assert(kMaxHullPoints <= kMostCut, "a hull's points are thinned out too");

// Of points in any order: at most kManifoldPoints, the deepest first.
int thin_out(ManifoldPoint* points, int count) {
  deepest_first(points, count);
  return keep_spread<kMostCut>(points, count, kManifoldPoints,
                               [](const ManifoldPoint& point) { return point.p; });
}

// What is left of a polygon (or edge, or point) on the inner side of the plane through `corner`.
int cut(const Vec3* in, int count, const Vec3& outward, const Vec3& corner, Vec3* out) {
  const auto beyond = [&](const Vec3& p) { return dot(outward, p - corner); };
  int kept = 0;
  const int edges = count > 2 ? count : count - 1;
  if (count == 1 || edges == 1) {
    // ends of an edge stay ends
    if (beyond(in[0]) <= 0) out[kept++] = in[0];
  }
  for (int i = 0; i < edges; ++i) {
    const Vec3 &p = in[i], &q = in[(i + 1) % count];
    const double bp = beyond(p), bq = beyond(q);
    if ((bp > 0) != (bq > 0) && kept < kMostCut) out[kept++] = p + (bp / (bp - bq)) * (q - p);
    if (bq <= 0 && kept < kMostCut) out[kept++] = q;
  }
  return kept;
}

// Points of `edge` or face `other` in front of the face, below its plane. `sign` 1: the face is b's.
int points_on_face(const Feature& face, const Feature& other, double sign, ManifoldPoint* out) {
  Vec3 buffers[2][kMostCut];
  int count = other.count, now = 0;
  std::copy_n(other.points, count, buffers[0]);
  for (int i = 0; i < face.count && count > 0; ++i) {
    const Vec3 &p = face.points[i], &q = face.points[(i + 1) % face.count];
    Vec3 outward = cross(q - p, face.n);
    // corners may go either way round
    if (dot(outward, face.points[(i + 2) % face.count] - p) > 0) outward = -outward;
    count = cut(buffers[now], count, outward, p, buffers[1 - now]);
    now = 1 - now;
  }
  int found = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3& p = buffers[now][i];
    const double depth = dot(face.n, face.points[0] - p);
    if (depth > 0) out[found++] = {p, sign * face.n, depth};
  }
  return found;
}

// A solid with a straight axis that is as good as a capsule where its side touches.
bool has_side(const Convex& solid) {
  return solid.kind == ShapeKind::kCapsule || solid.kind == ShapeKind::kCylinder ||
         solid.kind == ShapeKind::kSphere;
}

struct Axis {
  Vec3 p, u;  // centre, unit direction
  double half, radius;
  bool capped;  // beyond its ends it is not round
};
Axis axis_of(const Convex& s) {
  return {s.p, s.R.col(2), s.kind == ShapeKind::kSphere ? 0 : s.size.y, s.size.x,
          s.kind == ShapeKind::kCylinder};
}

// Contact points of two round sides (stage 1 above); -1: a cylinder's cap is involved, so stages 2 and 3 decide.
int round_sides(const Axis& a, const Axis& b, ManifoldPoint* out) {
  const Vec3 r = a.p - b.p;
  const double k = dot(a.u, b.u), ar = dot(a.u, r), br = dot(b.u, r), d = 1 - k * k;
  double s = 0, t;
  const bool along = d < kAlong * kAlong && a.half > 0 && b.half > 0;
  if (d > kSideways) s = std::clamp((k * br - ar) / d, -a.half, a.half);
  t = k * s + br;
  if (std::fabs(t) > b.half) {
    t = std::clamp(t, -b.half, b.half);
    s = std::clamp(k * t - ar, -a.half, a.half);
  }
  const auto at = [&](double sa, double tb, ManifoldPoint* point) {
    const Vec3 pa = a.p + sa * a.u, pb = b.p + tb * b.u, gap = pa - pb;
    const double distance = norm(gap);
    if (distance >= a.radius + b.radius || distance == 0) return false;
    point->n = (1 / distance) * gap;
    point->depth = a.radius + b.radius - distance;
    point->p = pb + (b.radius - 0.5 * point->depth) * point->n;
    return true;
  };
  if (along) {
    // parallel axes: the points are the ends of the stretch where both lie side by side
    const double way = k < 0 ? -1 : 1, shift = -ar;  // of b's centre along a
    const double low = std::max(-a.half, shift - b.half), high = std::min(a.half, shift + b.half);
    if (low < high) {
      int count = 0;
      double deepest = 0;
      for (const double sa : {low, high}) {
        const double tb = std::clamp(way * (sa - shift), -b.half, b.half);
        if (!at(sa, tb, out + count)) continue;
        deepest = std::max(deepest, out[count++].depth);
      }
      // deeper than the stretch is long: the shortest way out is along the axis, over a cap
      return (a.capped || b.capped) && deepest > high - low ? -1 : count;
    }
  }
  const double to_cap =
      std::min(a.capped ? a.half - std::fabs(s) : HUGE_VAL, b.capped ? b.half - std::fabs(t) : HUGE_VAL);
  if (to_cap <= 0) return -1;
  if (!at(s, t, out)) return 0;
  return out->depth > to_cap ? -1 : 1;
}

}  // namespace

int manifold_on_plane(const Convex& a, const Vec3& n, double offset, ManifoldPoint* out) {
  ManifoldPoint points[kMaxHullPoints];
  int count = 0;
  const auto add = [&](const Vec3& p) {
    const double depth = offset - dot(n, p);
    if (depth > 0) points[count++] = {p, n, depth};
  };
  if (a.hull) {
    for (int32_t i = 0; i < a.hull->num_points; ++i) add(a.p + a.R * a.hull->points[i]);
  } else {
    const Feature f = shown(a, -n);
    for (int i = 0; i < f.count; ++i) add(f.points[i]);
  }
  count = thin_out(points, count);
  std::copy_n(points, count, out);
  return count;
}

// The axis is cut at the sides of the box that it runs across; what is left ends in two spheres.
int capsule_on_box(const Convex& capsule, const Convex& box, double depth, ManifoldPoint* out) {
  const Mat3 R = transpose(box.R);
  const Vec3 c = R * (capsule.p - box.p), u = R * capsule.R.col(2);
  const double radius = capsule.size.x;
  double low = -capsule.size.y, high = capsule.size.y;
  for (int k = 0; k < 3; ++k) {
    if (std::fabs(u[k]) < kAlong) continue;
    const double s = (-box.size[k] - c[k]) / u[k], t = (box.size[k] - c[k]) / u[k];
    low = std::max(low, std::min(s, t));
    high = std::min(high, std::max(s, t));
  }
  if (!(high - low > kSideways)) return 0;
  int count = 0;
  for (const double s : {low, high}) {
    const Vec3 center = c + s * u;
    Vec3 on = center;
    for (int k = 0; k < 3; ++k) on[k] = std::clamp(on[k], -box.size[k], box.size[k]);
    const Vec3 gap = center - on;
    const double distance = norm(gap);
    if (!(distance < radius) || distance < kSideways) return 0;
    const Vec3 n = (1 / distance) * (box.R * gap);
    out[count++] = {box.p + box.R * center - (0.5 * (radius + distance)) * n, n, radius - distance};
  }
  return std::max(out[0].depth, out[1].depth) > kDeepEnough * depth ? 2 : 0;
}

int manifold_between(const Convex& a, const Convex& b, ManifoldPoint* out) {
  if (has_side(a) && has_side(b)) {
    const int count = round_sides(axis_of(a), axis_of(b), out);
    if (count >= 0) return count;
  }
  Overlap overlap;
  if (!find_overlap(a, b, &overlap)) return 0;
  const Feature of_a = shown(a, -overlap.n), of_b = shown(b, overlap.n);
  const double fits_a = of_a.count > 2 ? -dot(of_a.n, overlap.n) : 0,
               fits_b = of_b.count > 2 ? dot(of_b.n, overlap.n) : 0;
  const bool on_a = fits_a > fits_b + kPreferred;
  ManifoldPoint points[kMostCut];
  int count = 0;
  if (std::max(fits_a, fits_b) > kFlat)
    count = on_a ? points_on_face(of_a, of_b, -1, points) : points_on_face(of_b, of_a, 1, points);
  if (count == 0) {
    out[0] = {overlap.p, overlap.n, overlap.depth};
    return 1;
  }
  count = thin_out(points, count);
  std::copy_n(points, count, out);
  return count;
}

}  // namespace rdm

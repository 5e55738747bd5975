#include "physics/collision/convex.hpp"

#include <ccd/ccd.h>

#include <algorithm>
#include <cmath>

// Support mapping h(d), the point of a solid farthest along d. In the solid's own frame, half sizes s:
//   sphere     r d/|d|                              capsule   the sphere's, from the end (0, 0, +-s_z)
//   box        (+-s_x, +-s_y, +-s_z), signs of d    cylinder  (r d_xy/|d_xy|, +-s_z)
//   ellipsoid  S S d / |S d|, S = diag(s): d . x is largest on |S^-1 x| = 1 where S^-2 x is along d
//   hull       the corner with the largest d . x
// In the world h(d) = p + R h_local(R^T d).
//
// Overlap. Solids overlap when their Minkowski difference a - b holds the origin; libccd finds that out by
// portal refinement, from support points alone (MPR: Snethen, XenoCollide, Game Programming Gems 7, 2008).
// Along a unit n from b into a they overlap by
//   f(n) = n . (h_b(n) - h_a(-n)),
// and the depth is the least f over all n; f < 0 for any n shows them apart. For flat faces the portal's
// normal is that n. For round ones it leans towards the line of centres, and `sharpen` goes downhill in f.
//
// Most pairs that come here are near and apart. A few projections from one solid onto the other and back lead
// towards their nearest points (von Neumann's alternating projections), and the way between them is tried as
// such an n before anything else.
//
// Feature: what a solid shows along n, the face whose normal is nearest to n, an edge, or h(n) alone. The
// manifold is cut out of the features of the two.
namespace rdm {
namespace {

constexpr double kLevel = 1e-3;      // sine of the tilt below which a cap has no farthest point of its own
constexpr double kCapFrom = 0.7;     // cosine between axis and direction from which a cap is shown
constexpr double kTolerance = 1e-7;  // m
constexpr double kWidest = 0.2, kNarrowest = 1e-4;  // rad, steps of sharpen
constexpr double kInside = 0.6;                     // of a step: near enough for the next, a quarter as wide
constexpr int kStepsEach = 8;
constexpr int kIterations = 200;
constexpr int kTries = 4, kProjections = 3;  // ways that are tried, and projections before each

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const Vec3 p =
      farthest(*static_cast<const Convex*>(object), {direction->v[0], direction->v[1], direction->v[2]});
  ccdVec3Set(out, p.x, p.y, p.z);
}

void center(const void* object, ccd_vec3_t* out) {
  const Convex& solid = *static_cast<const Convex*>(object);
  // a hull need not hold the origin of its frame
  const Vec3 p = solid.hull ? solid.p + solid.R * solid.hull->com : solid.p;
  ccdVec3Set(out, p.x, p.y, p.z);
}

int32_t farthest_corner(const Hull& hull, const Vec3& d) {
  int32_t best = 0;
  double most = dot(d, hull.points[0]);
  for (int32_t i = 1; i < hull.num_points; ++i) {
    const double reach = dot(d, hull.points[i]);
    if (reach > most) most = reach, best = i;
  }
  return best;
}

// Farthest in the solid's own frame.
Vec3 farthest_local(const Convex& solid, const Vec3& d) {
  const Vec3& s = solid.size;
  switch (solid.kind) {
    case ShapeKind::kSphere:
    case ShapeKind::kCapsule: {
      const double length = norm(d);
      const Vec3 out = length > 0 ? (s.x / length) * d : Vec3{0, 0, s.x};
      return solid.kind == ShapeKind::kSphere ? out : out + Vec3{0, 0, std::copysign(s.y, d.z)};
    }
    case ShapeKind::kBox:
      return {std::copysign(s.x, d.x), std::copysign(s.y, d.y), std::copysign(s.z, d.z)};
    case ShapeKind::kCylinder: {
      const double out = std::sqrt(d.x * d.x + d.y * d.y);
      const double scale = out > 0 ? s.x / out : 0;
      return {scale * d.x, scale * d.y, std::copysign(s.y, d.z)};
    }
    case ShapeKind::kEllipsoid: {
      const Vec3 q{s.x * d.x, s.y * d.y, s.z * d.z};
      const double length = norm(q);
      if (!(length > 0)) return {0, 0, s.z};
      return (1 / length) * Vec3{s.x * q.x, s.y * q.y, s.z * q.z};
    }
    case ShapeKind::kHull:
      return solid.hull->points[farthest_corner(*solid.hull, d)];
    case ShapeKind::kPlane:
      break;
  }
  return {};
}

// Solids whose nearest points to a place are written down at once.
bool has_nearest(ShapeKind kind) {
  return kind == ShapeKind::kBox || kind == ShapeKind::kCylinder || kind == ShapeKind::kCapsule;
}

// Of the surface about what nearest() is on, m.
double radius_of(const Convex& solid) {
  return solid.kind == ShapeKind::kBox ? 0 : solid.size.x;
}

// The point nearest to p of a box, or of the axis of a cylinder or capsule.
Vec3 nearest(const Convex& solid, const Vec3& p) {
  const Vec3& s = solid.size;
  if (solid.kind != ShapeKind::kBox) {
    const Vec3 axis = solid.R.col(2);
    return solid.p + std::clamp(dot(axis, p - solid.p), -s.y, s.y) * axis;
  }
  Vec3 x = transpose(solid.R) * (p - solid.p);
  for (int k = 0; k < 3; ++k) x[k] = std::clamp(x[k], -s[k], s[k]);
  return solid.p + solid.R * x;
}

Feature side_of_box(const Convex& box, const Vec3& n) {
  int k = 0;
  double best = -1, cosine = 0;
  for (int i = 0; i < 3; ++i) {
    const double c = dot(n, box.R.col(i));
    if (std::fabs(c) <= best) continue;
    best = std::fabs(c);
    cosine = c;
    k = i;
  }
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  Feature f;
  f.n = std::copysign(1.0, cosine) * box.R.col(k);
  const Vec3 center = box.p + box.size[k] * f.n, u = box.size[i] * box.R.col(i),
             v = box.size[j] * box.R.col(j);
  f.count = 4;
  f.points[0] = center + u + v;
  f.points[1] = center - u + v;
  f.points[2] = center - u - v;
  f.points[3] = center + u - v;
  return f;
}

Feature part_of_cylinder(const Convex& c, const Vec3& n) {
  const Vec3 axis = c.R.col(2);
  const double cosine = dot(n, axis), radius = c.size.x, half = c.size.y;
  const Vec3 out = n - cosine * axis;
  const double sine = norm(out);
  Feature f;
  if (std::fabs(cosine) < kCapFrom) {
    const Vec3 line = c.p + (radius / sine) * out;
    f.count = 2;
    f.points[0] = line - half * axis;
    f.points[1] = line + half * axis;
    return f;
  }
  f.n = std::copysign(1.0, cosine) * axis;
  const Vec3 cap = c.p + half * f.n;
  const Vec3 first = sine > kLevel ? (1 / sine) * out : c.R.col(0), second = cross(axis, first);
  constexpr double kDiagonal = 0.70710678118654752;
  constexpr int kRimPoints = 8;
  constexpr double kRim[kRimPoints][2] = {
      {1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
      {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};
  f.count = kRimPoints;
  for (int i = 0; i < f.count; ++i)
    f.points[i] = cap + (radius * kRim[i][0]) * first + (radius * kRim[i][1]) * second;
  return f;
}

Feature side_of_hull(const Convex& solid, const Vec3& n) {
  const Hull& hull = *solid.hull;
  const Vec3 d = transpose(solid.R) * n;
  const int32_t tip = farthest_corner(hull, d);
  const Hull::Face* best = nullptr;
  for (int32_t i = 0; i < hull.num_faces; ++i) {
    const Hull::Face& face = hull.faces[i];
    const uint8_t *first = hull.corners + face.first, *end = first + face.count;
    if ((!best || dot(d, face.n) > dot(d, best->n)) && std::find(first, end, tip) != end) best = &face;
  }
  Feature f;
  f.n = solid.R * best->n;
  f.count = std::min(best->count, Feature::kMost);
  for (int i = 0; i < f.count; ++i)
    f.points[i] = solid.p + solid.R * hull.corner(*best, i * best->count / f.count);
  return f;
}

// MPR's normal leans towards the line of centres where surfaces are round. The least depth over all normals
// is near by: found by steps to four sides, along an axis of the solid that may have edges, and to where
// parabolas through them are lowest. False when a normal shows them apart.
bool sharpen(const Convex& a, const Convex& b, Overlap* out) {
  const bool round_a = a.kind == ShapeKind::kEllipsoid;
  const Mat3& R = round_a ? b.R : a.R;
  Vec3 n = normalized(out->n);
  double least = HUGE_VAL;
  const auto try_normal = [&](const Vec3& along) {
    const Vec3 trial = normalized(along);
    const double depth = dot(trial, farthest(b, trial) - farthest(a, -trial));
    if (depth < least) least = depth, n = trial;
    return depth;
  };
  try_normal(n);
  for (double step = kWidest; step > kNarrowest; step *= 0.25)
    for (int k = 0; k < kStepsEach; ++k) {
      const Vec3 from = n, u = R.col(std::fabs(dot(n, R.col(2))) < 0.9 ? 2 : 0),
                 side = normalized(cross(n, u));
      const double here = least;
      Vec3 lowest = from;
      bool inside = true;
      for (const Vec3& way : {step * cross(side, from), step * side}) {
        const double up = try_normal(from + way), down = try_normal(from - way), bend = up + down - 2 * here;
        const double low = bend > 0 ? std::clamp(0.5 * (down - up) / bend, -1.0, 1.0) : 0;
        lowest += low * way;
        inside = inside && std::fabs(low) < kInside;
      }
      try_normal(lowest);
      if (inside || !(least < here)) break;
    }
  if (!(least > 0)) return false;
  out->n = n;
  out->depth = least;
  out->p = round_a ? farthest(a, -n) + (0.5 * least) * n : farthest(b, n) - (0.5 * least) * n;
  return true;
}

}  // namespace

Vec3 farthest(const Convex& solid, const Vec3& direction) {
  return solid.p + solid.R * farthest_local(solid, transpose(solid.R) * direction);
}

Feature shown(const Convex& solid, const Vec3& n) {
  Feature f;
  switch (solid.kind) {
    case ShapeKind::kBox:
      return side_of_box(solid, n);
    case ShapeKind::kCylinder:
      return part_of_cylinder(solid, n);
    case ShapeKind::kHull:
      return side_of_hull(solid, n);
    case ShapeKind::kCapsule: {
      const Vec3 half = solid.size.y * solid.R.col(2), out = solid.p + solid.size.x * n;
      f.count = 2;
      f.points[0] = out - half;
      f.points[1] = out + half;
      return f;
    }
    case ShapeKind::kSphere:
    case ShapeKind::kEllipsoid:
    case ShapeKind::kPlane:
      break;
  }
  f.count = 1;
  f.points[0] = farthest(solid, n);
  return f;
}

bool shown_apart(const Convex& a, const Convex& b) {
  if (!has_nearest(a.kind) || !has_nearest(b.kind)) return false;
  const double reach = radius_of(a) + radius_of(b);
  Vec3 p = a.p, q = b.p;
  for (int k = 0; k < kTries; ++k) {
    for (int i = 0; i < kProjections; ++i) {
      q = nearest(b, p);
      p = nearest(a, q);
    }
    const Vec3 n = p - q;
    const double length = norm(n);
    if (length <= reach) return false;
    if (dot(n, farthest(b, n) - farthest(a, -n)) < -kTolerance * length) return true;
  }
  return false;
}

bool find_overlap(const Convex& a, const Convex& b, Overlap* out) {
  if (shown_apart(a, b)) return false;
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = support;
  ccd.center1 = ccd.center2 = center;
  ccd.max_iterations = kIterations;
  ccd.mpr_tolerance = kTolerance;
  ccd_real_t depth;
  ccd_vec3_t direction, p;
  if (ccdMPRPenetration(&a, &b, &ccd, &depth, &direction, &p) != 0) return false;
  out->n = -Vec3{direction.v[0], direction.v[1], direction.v[2]};
  out->p = {p.v[0], p.v[1], p.v[2]};
  out->depth = depth;
  if (!(depth > 0 && std::fabs(dot(out->n, out->n) - 1) < 1e-6)) return false;
  const bool round = a.kind == ShapeKind::kEllipsoid || b.kind == ShapeKind::kEllipsoid;
  return !round || sharpen(a, b, out);
}

}  // namespace rdm

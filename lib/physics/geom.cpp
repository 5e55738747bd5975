#include "physics/geom.hpp"

#include <algorithm>
#include <cmath>

#include "physics/convert.hpp"
#include "physics/manifold.hpp"

namespace rdm {
namespace {

constexpr double kFlat = 0.99;  // cosine between a contact's normal and that of a face it counts for

// The side of a box whose outward normal is nearest to `n`; false when none is near.
bool face_of_box(const Geom& box, const Vec3& n, double* half, Face* face) {
  const Mat3 r = mat_from_ode(dGeomGetRotation(box.id));
  for (int k = 0; k < 3; ++k) {
    const double cosine = dot(n, r.col(k));
    if (std::fabs(cosine) < kFlat) continue;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    face->n = std::copysign(1.0, cosine) * r.col(k);
    face->center = from_ode(dGeomGetPosition(box.id)) + box.size[k] * face->n;
    face->offset = dot(face->n, face->center);
    face->side[0] = r.col(i);
    face->side[1] = r.col(j);
    half[0] = box.size[i], half[1] = box.size[j];
    face->half = half;
    return true;
  }
  return false;
}

// Keeps `most` of `count` points, in front: the deepest, then each time the one farthest from all kept.
int spread_points(dContactGeom* points, int count, int most) {
  if (count <= most) return count;
  int first = 0;
  for (int i = 1; i < count; ++i)
    if (points[i].depth > points[first].depth) first = i;
  std::swap(points[0], points[first]);
  double gap[kMaxPairPoints];  // m2, to the nearest kept point
  std::fill_n(gap, count, HUGE_VAL);
  for (int kept = 1; kept < most; ++kept) {
    const Vec3 last = from_ode(points[kept - 1].pos);
    int next = kept;
    for (int i = kept; i < count; ++i) {
      const Vec3 d = from_ode(points[i].pos) - last;
      gap[i] = std::min(gap[i], dot(d, d));
      if (gap[i] > gap[next]) next = i;
    }
    std::swap(points[kept], points[next]);
    std::swap(gap[kept], gap[next]);
  }
  return most;
}

}  // namespace

Geom make_geom(const ShapeDef& shape, const Pose& X_WS) {
  const Vec3& s = shape.size;
  Geom geom;
  geom.kind = shape.kind;
  geom.size = s;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      geom.id = dCreateSphere(nullptr, s.x);
      break;
    case ShapeKind::kCapsule:
      geom.id = dCreateCapsule(nullptr, s.x, 2 * s.y);
      break;
    case ShapeKind::kBox:
      geom.id = dCreateBox(nullptr, 2 * s.x, 2 * s.y, 2 * s.z);
      break;
    case ShapeKind::kCylinder:
      geom.id = dCreateCylinder(nullptr, s.x, 2 * s.y);
      break;
    case ShapeKind::kPlane:
      geom.plane_n = rotate(X_WS.q, {0, 0, 1});
      geom.plane_d = dot(geom.plane_n, X_WS.p);
      geom.id = dCreatePlane(nullptr, geom.plane_n.x, geom.plane_n.y, geom.plane_n.z, geom.plane_d);
      return geom;
  }
  dQuaternion q;
  to_ode(X_WS.q, q);
  dGeomSetPosition(geom.id, X_WS.p.x, X_WS.p.y, X_WS.p.z);
  dGeomSetQuaternion(geom.id, q);
  return geom;
}

int collide_geoms(const Geom& a, const Geom& b, int most, dContactGeom* out) {
  // Two boxes have no more points; asked for fewer, ODE would choose them by an arc tangent of the C library.
  dContactGeom all[kMaxPairPoints];
  const int found = dCollide(a.id, b.id, kMaxPairPoints, all, sizeof all[0]);
  const bool first = a.kind == ShapeKind::kCylinder;
  const auto as_found = [&] {
    const int kept = spread_points(all, found, most);
    std::copy_n(all, kept, out);
    return kept;
  };
  if (found == 0 || (!first && b.kind != ShapeKind::kCylinder)) return as_found();
  const Geom &round = first ? a : b, &flat = first ? b : a;
  const Vec3 n = first ? from_ode(all[0].normal) : -from_ode(all[0].normal);
  Face face;
  double half[2];
  if (flat.kind == ShapeKind::kPlane) {
    face.n = flat.plane_n;
    face.offset = flat.plane_d;
  } else if (flat.kind != ShapeKind::kBox || !face_of_box(flat, n, half, &face)) {
    return as_found();
  }
  const Cylinder cylinder = {from_ode(dGeomGetPosition(round.id)), mat_from_ode(dGeomGetRotation(round.id)),
                             round.size.x, round.size.y};
  ManifoldPoint points[kManifoldPoints];
  const int count = std::min(cylinder_on_face(cylinder, face, points), most);
  if (count <= 0) return as_found();
  for (int i = 0; i < count; ++i) {
    out[i] = all[0];
    to_ode(points[i].p, out[i].pos);
    to_ode(first ? face.n : -face.n, out[i].normal);
    out[i].depth = points[i].depth;
  }
  return count;
}

}  // namespace rdm

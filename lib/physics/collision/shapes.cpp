#include "physics/collision/shapes.hpp"

#include <algorithm>
#include <cmath>

#include "physics/collision/manifold.hpp"
#include "physics/collision/thinning.hpp"
#include "physics/ode_library/ode_convert.hpp"

namespace rdm {
namespace {

// ODE lets a cylinder rock on faces, and knows no contact of it with a capsule or another cylinder; it has no
// ellipsoid, and one point for two hulls.
bool is_ours(const Geom& geom) {
  return geom.kind == ShapeKind::kCylinder || geom.kind == ShapeKind::kEllipsoid ||
         geom.kind == ShapeKind::kHull;
}

// ODE has one point for a capsule and a box, on which it rocks: its two ends on the box stand in for it.
int capsule_ends(const Geom& a, const Geom& b, int found, dContactGeom* points) {
  const bool first = a.kind == ShapeKind::kCapsule;
  if (found != 1 ||
      !(first ? b.kind == ShapeKind::kBox : a.kind == ShapeKind::kBox && b.kind == ShapeKind::kCapsule))
    return found;
  ManifoldPoint ends[2];
  if (capsule_on_box(convex_of(first ? a : b), convex_of(first ? b : a), points[0].depth, ends) != 2)
    return found;
  points[1] = points[0];
  for (int i = 0; i < 2; ++i) {
    to_ode(ends[i].p, points[i].pos);
    to_ode((first ? 1.0 : -1.0) * ends[i].n, points[i].normal);
    points[i].depth = ends[i].depth;
  }
  return 2;
}

}  // namespace

Convex convex_of(const Geom& geom) {
  return {geom.kind, geom.size, from_ode(dGeomGetPosition(geom.id)), mat_from_ode(dGeomGetRotation(geom.id)),
          geom.hull};
}

Geom make_geom(const ShapeDef& shape, const Hull* hull, const Pose& X_WS) {
  const Vec3& s = shape.size;
  Geom geom;
  geom.kind = shape.kind;
  geom.size = s;
  geom.hull = hull;
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
    case ShapeKind::kEllipsoid:
    case ShapeKind::kHull:
      geom.id = dCreateSphere(nullptr, norm(s));
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

void resize_geom(Geom* geom, const Vec3& size, const Hull* hull) {
  geom->hull = hull;
  if (norm(size - geom->size) == 0) return;
  geom->size = size;
  switch (geom->kind) {
    case ShapeKind::kSphere:
      dGeomSphereSetRadius(geom->id, size.x);
      return;
    case ShapeKind::kCapsule:
      dGeomCapsuleSetParams(geom->id, size.x, 2 * size.y);
      return;
    case ShapeKind::kBox:
      dGeomBoxSetLengths(geom->id, 2 * size.x, 2 * size.y, 2 * size.z);
      return;
    case ShapeKind::kCylinder:
      dGeomCylinderSetParams(geom->id, size.x, 2 * size.y);
      return;
    case ShapeKind::kEllipsoid:
    case ShapeKind::kHull:
      dGeomSphereSetRadius(geom->id, norm(size));
      return;
    case ShapeKind::kPlane:
      return;
  }
}

int collide_geoms(const Geom& a, const Geom& b, int most, dContactGeom* out) {
  if (!is_ours(a) && !is_ours(b)) {
    // Two boxes have no more points; asked for fewer, ODE would choose them by an arc tangent of the C
    // library.
    dContactGeom all[kMaxPairPoints];
    const int found = capsule_ends(a, b, dCollide(a.id, b.id, kMaxPairPoints, all, sizeof all[0]), all);
    const int kept = keep_spread<kMaxPairPoints>(
        all, found, most, [](const dContactGeom& point) { return from_ode(point.pos); });
    std::copy_n(all, kept, out);
    return kept;
  }
  ManifoldPoint points[kManifoldPoints];
  int count = 0;
  double sign = 1;
  if (b.kind == ShapeKind::kPlane) {
    count = manifold_on_plane(convex_of(a), b.plane_n, b.plane_d, points);
  } else if (a.kind == ShapeKind::kPlane) {
    count = manifold_on_plane(convex_of(b), a.plane_n, a.plane_d, points);
    sign = -1;
  } else {
    count = manifold_between(convex_of(a), convex_of(b), points);
  }
  count = std::min(count, most);
  for (int i = 0; i < count; ++i) {
    out[i] = {};
    to_ode(points[i].p, out[i].pos);
    to_ode(sign * points[i].n, out[i].normal);
    out[i].depth = points[i].depth;
    out[i].g1 = a.id;
    out[i].g2 = b.id;
    out[i].side1 = out[i].side2 = -1;
  }
  return count;
}

}  // namespace rdm

// One collision shape in ODE: how it is made, and the contact points of two of them.
#pragma once
#include <ode/ode.h>

#include "physics/collision/convex.hpp"

namespace rdm {

inline constexpr int kMaxPairPoints = 8;

struct Geom {
  dGeomID id = nullptr;  // null: the shape does not collide
  ShapeKind kind = ShapeKind::kSphere;
  Vec3 size;
  const Hull* hull = nullptr;
  Vec3 plane_n;        // of a plane: n . x = plane_d on it, world
  double plane_d = 0;  // m
};

// A geom of its own, in no space, at X_WS. The caller destroys it, and keeps the hull of a shape of that
// kind. ODE knows ellipsoids and hulls as the spheres about them.
Geom make_geom(const ShapeDef& shape, const Hull* hull, const Pose& X_WS);

// As it stands; not of a plane.
Convex convex_of(const Geom& geom);

// Of the same kind, not a plane.
void resize_geom(Geom* geom, const Vec3& size, const Hull* hull);

// At most `most` points, the deepest among them; normals point from b into a. ODE finds those of spheres,
// capsules, boxes and planes with each other, but for the ends of a capsule that lies along a box; all others
// are manifold.hpp's.
int collide_geoms(const Geom& a, const Geom& b, int most, dContactGeom* out);

}  // namespace rdm

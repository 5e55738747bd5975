// Contact points of convex solids: enough of them to stand, lie and be held still.
//
// One point of deepest overlap lets a thing rock. Where a face, or an edge along it, meets a face, the
// overlap of the two is cut out and its corners are the points; two edges along each other give two.
#pragma once
#include "physics/collision/convex.hpp"

namespace rdm {

struct ManifoldPoint {
  Vec3 p;        // world
  Vec3 n;        // unit, from b into a
  double depth;  // m, > 0
};
inline constexpr int kManifoldPoints = 4;

// Of a on the half space n . x < offset: at most kManifoldPoints.
int manifold_on_plane(const Convex& a, const Vec3& n, double offset, ManifoldPoint* out);

// Of two solids: at most kManifoldPoints, the deepest first; 0 when they are apart.
int manifold_between(const Convex& a, const Convex& b, ManifoldPoint* out);

// Points of a capsule that lies along a face or an edge of a box: where both of its ends on the box, one of
// them about as deep as the deepest point (`depth`, m), are inside. 2, or 0: one point is enough.
int capsule_on_box(const Convex& capsule, const Convex& box, double depth, ManifoldPoint* out);

}  // namespace rdm

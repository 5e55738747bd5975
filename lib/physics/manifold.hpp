// Contact points of a cylinder on a flat face: enough of them to stand and lie still.
//
// The engine's collider gives a cylinder a changing handful of points and lets it creep; these are the
// rim points of the lower cap, or the ends of the lowest line of the side.
#pragma once
#include "base/vec.hpp"

namespace rdm {

struct ManifoldPoint {
  Vec3 p;        // on the cylinder, world
  double depth;  // below the face, m, > 0
};
inline constexpr int kManifoldPoints = 4;

// A face: the plane n . x = offset, seen from the side n points to. With `half` not null it is the
// rectangle about `center` with unit sides `side` and half lengths half[0], half[1].
struct Face {
  Vec3 n;
  double offset = 0;
  Vec3 center;
  Vec3 side[2];
  const double* half = nullptr;
};

struct Cylinder {
  Vec3 p;
  Mat3 R;  // axis: third column
  double radius;
  double half_length;
};

// The number of points, at most kManifoldPoints; -1 when the cylinder does not meet the face squarely
// enough, or not with its whole foot, for this to be the right answer.
int cylinder_on_face(const Cylinder& cylinder, const Face& face, ManifoldPoint* out);

}  // namespace rdm

// The convex hull of a few points, with its faces and what a uniform solid of its form weighs.
#pragma once
#include <cstdint>

#include "base/vec.hpp"

namespace rdm {

inline constexpr int32_t kMaxHullPoints = 32;

struct Hull {
  static constexpr int kMostPoints = kMaxHullPoints, kMostFaces = 2 * kMostPoints - 4;
  struct Face {
    Vec3 n;         // unit, outward
    double offset;  // m: n . p on the face
    int32_t first, count;
  };
  Vec3 points[kMostPoints];  // its corners only
  int32_t num_points = 0;
  Face faces[kMostFaces];  // flat ones are one face, however many corners they have
  int32_t num_faces = 0;
  uint8_t corners[3 * kMostFaces];  // of faces, in order around each, counterclockwise from outside
  double volume = 0;                // m3
  Vec3 com;
  double moment[6] = {0, 0, 0, 0, 0, 0};  // about com per kg, as Inertia::moment, m2

  const Vec3& corner(const Face& face, int32_t i) const { return points[corners[face.first + i]]; }
};

// Points inside the hull of the others count for nothing. Error(kArgument) where points are not finite, lie
// in one plane, or so near each other (all within 1e-6 m) that faces cannot be told apart; Error(kRange) for
// a count outside [4, kMaxHullPoints] or a point farther than 1e3 m from the origin.
Hull make_hull(const Vec3* points, int32_t count, const char* owner);

// The hull `factor` times as large about its frame's origin.
void scale_hull(const Hull& hull, double factor, Hull* out);

// Half sizes of the box about the frame's origin that holds the hull, m.
Vec3 half_box(const Hull& hull);

}  // namespace rdm

// A convex solid by how far it reaches in a direction, and by what it shows there: a face, an edge or a
// point.
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

struct Convex {
  ShapeKind kind = ShapeKind::kSphere;  // not a plane
  Vec3 size;                            // as ShapeDef::size
  Vec3 p;                               // p_WS
  Mat3 R;                               // R_WS
  const Hull* hull = nullptr;
};

// A part of the surface: 1 point, 2 ends of an edge, or the corners of a flat face in order around it.
struct Feature {
  static constexpr int kMost = 16;  // of faces with more corners, an even choice
  Vec3 points[kMost];               // world
  int count = 0;
  Vec3 n;  // of a face: its outward normal
};

// The point of the solid that is farthest along `direction`, which need not be a unit vector.
Vec3 farthest(const Convex& solid, const Vec3& direction);

// The part of the surface that looks along the unit vector n most nearly; of a hull, of its faces about the
// farthest point. The first point of a cylinder's cap is its farthest along n.
Feature shown(const Convex& solid, const Vec3& n);

// How two solids overlap: moved by depth along n, `a` only touches `b`.
struct Overlap {
  Vec3 n;  // unit, from b into a
  Vec3 p;
  double depth;  // m
};
// True: a direction was found along which they are apart; false says nothing. Of boxes, cylinders, capsules.
bool shown_apart(const Convex& a, const Convex& b);
// False when they are apart. Exact for shallow overlap.
bool find_overlap(const Convex& a, const Convex& b, Overlap* out);

}  // namespace rdm

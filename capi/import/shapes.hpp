// Primitives as convex sets: how far they reach, whether two of them touch, and the smallest around a mesh.
#pragma once
#include "geometry.hpp"
#include "import.hpp"

namespace rdm::import {

struct Primitive {
  int32_t kind = RDM_SHAPE_SPHERE;
  V3 size;
  Pose X;
};

// The point of it that is farthest along `way`.
V3 farthest(const Primitive& s, V3 way);
// Whether they have a point in common (GJK).
bool touch(const Primitive& a, const Primitive& b);
double volume_of(const Primitive& s);
// Mass and moments of a homogeneous one of density 1, in the frame that it stands in.
Mass solid(const Primitive& s);

struct Mesh {
  std::vector<V3> points;
  std::vector<std::array<uint32_t, 3>> faces;
};
// .stl (binary, text), .obj; UNSUPPORTED for others. Bounds: 2 million corners and faces, 1e6 m.
Mesh read_mesh(const std::string& path, Budget* budget);
Mesh parse_mesh(std::string bytes, bool obj);
// The smallest of box, capsule and sphere that holds the points, along their axes or the frame's.
Primitive around(const std::vector<V3>& points);

}  // namespace rdm::import

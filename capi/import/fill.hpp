// What a shape weighs at density 1: primitives as shells, meshes in the four ways of MJCF, hulls of points.
#pragma once
#include "budget.hpp"
#include "geometry.hpp"
#include "shapes.hpp"

namespace rdm::import {

enum class Fill {
  kLegacy,  // MJCF's own: pyramids from the middle of the surface, all counted as positive
  kExact,   // signed volumes: right for closed surfaces
  kConvex,  // of the hull
  kShell    // the surface; density is per square metre
};

// The surface alone, in its own pose; an ellipsoid's area is Thomsen's.
Mass shell(const Primitive& s);
// Whether each edge has a triangle to either side, which go about it in opposite ways.
bool is_closed(const Mesh& mesh);
Mass scaled(double factor, const Mass& m);
// Mass 0 for a surface that encloses nothing. What a hull costs is taken from the budget.
Mass filled(const Mesh& mesh, Fill how, Budget* budget);

inline constexpr size_t kMostOfHull = 4096;  // corners: the work grows with their square
// Each point once, in a fixed order.
std::vector<V3> corners_of(const std::vector<V3>& points);
// The hull's triangles, turned outwards; no faces for points in one plane. RANGE above kMostOfHull corners.
Mesh hull_of(const std::vector<V3>& points, Budget* budget);

}  // namespace rdm::import

// Surfaces of shapes as triangles, for viewers that know nothing but triangles.
#pragma once
#include <cstdint>
#include <vector>

namespace tool {

struct Solid {
  std::vector<float> points;        // [n][3] m, in the shape's frame
  std::vector<float> normals;       // [n][3] unit, outwards
  std::vector<uint16_t> triangles;  // [m][3] into points, counter-clockwise from outside
};

// Round shapes have `kAround` points about an axis: 2 % off the true surface at most.
inline constexpr int kAround = 24;

Solid make_ellipsoid(const float radii[3]);
// Along z; a rounded one is a capsule.
Solid make_cylinder(float radius, float half_length, bool rounded);
Solid make_box(const float half[3]);
// A square in the plane z = 0 about (x, y), seen from above.
Solid make_square(float x, float y, float half);
// The convex hull of corners [n][3], n at most 100 or so: it tries all planes through three of them.
Solid make_hull(const std::vector<float>& corners);

}  // namespace tool

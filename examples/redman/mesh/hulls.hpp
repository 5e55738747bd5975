// Convex hulls of many points, by qhull, and hulls of few that stand for them.
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace tool {

struct Plane {
  Point n;
  double offset;  // n . p + offset is how far p is outside
};
struct Hull {
  std::vector<Point> corners;
  std::vector<Plane> planes;
  double volume;
};
// Failure, which begins with `what`, for points in one plane, or a tool without qhull.
Hull hull_of(std::vector<Point> points, const std::string& what);

struct FewHull {
  Hull hull;
  size_t corners;  // of the whole
  double error;    // m: the farthest corner of the whole outside of it
  double share;    // of the whole's volume
};
// At most `most` of their corners, the farthest out first.
FewHull few_hull(const std::vector<Point>& points, size_t most, const std::string& what);

// How far p is outside of the plane, m.
double beyond(const Plane& plane, const Point& p);

}  // namespace tool

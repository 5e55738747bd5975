// Fewer contact points that hold as well: the deepest, then each time the one farthest from all kept. Physics
// engines reduce their manifolds so: time goes with the number of points, stability with their spread.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/vec.hpp"

namespace rdm {

template <class Point>
void deepest_first(Point* points, int count) {
  int first = 0;
  for (int i = 1; i < count; ++i)
    if (points[i].depth > points[first].depth) first = i;
  std::swap(points[0], points[first]);
}

// Brings the `most` points to keep, of up to kMost, to the front; place(point) is where one is. Returns how
// many there are; fewer than `most` stay in their order.
template <int kMost, class Point, class Place>
int keep_spread(Point* points, int count, int most, Place place) {
  if (count <= most) return count;
  deepest_first(points, count);
  double gap[kMost];  // m2, to the nearest kept point
  std::fill_n(gap, count, HUGE_VAL);
  for (int kept = 1; kept < most; ++kept) {
    const Vec3 last = place(points[kept - 1]);
    int next = kept;
    for (int i = kept; i < count; ++i) {
      const Vec3 d = place(points[i]) - last;
      gap[i] = std::min(gap[i], dot(d, d));
      if (gap[i] > gap[next]) next = i;
    }
    std::swap(points[kept], points[next]);
    std::swap(gap[kept], gap[next]);
  }
  return most;
}

}  // namespace rdm

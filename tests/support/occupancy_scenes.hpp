// Maps, scans and rooms that the tests of lib/sense/occupancy share.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "base/error.hpp"
#include "sense/map/occupancy.hpp"

namespace rdm {

struct EndMap {
  void operator()(Occupancy* m) const { Occupancy::destroy(m); }
};
using Map = std::unique_ptr<Occupancy, EndMap>;

inline Map make_map(double resolution = 0.05, size_t memory = 64u << 20, double max_range = 0) {
  OccupancyConfig c;
  c.resolution = resolution;
  c.memory = memory;
  c.max_range = max_range;
  return Map(Occupancy::create(c, {}));
}

// Whether a probability is at or above the default threshold.
inline bool occupied(float probability) {
  return probability >= static_cast<float>(OccupancyConfig{}.threshold);
}

using Points = std::vector<float>;

// What a sensor at `eye` sees of a room of half size 1.98 m with a ball of radius 0.5 m in its middle: rays
// in all directions. Every surface point is exact.
inline Points scan_room(const Vec3& eye, int rings = 60, int sectors = 120) {
  Points out;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double z = -1 + 2 * (i + 0.5) / rings, a = 2 * M_PI * (j + 0.31) / sectors,
                   r = std::sqrt(1 - z * z);
      const Vec3 d{r * std::cos(a), r * std::sin(a), z};
      double t = HUGE_VAL;
      for (int k = 0; k < 3; ++k)
        if (d[k] != 0) t = std::min(t, ((d[k] > 0 ? 1.98 : -1.98) - eye[k]) / d[k]);
      const double b = dot(eye, d), square = b * b - (dot(eye, eye) - 0.25);
      if (square > 0 && -b - std::sqrt(square) > 0) t = std::min(t, -b - std::sqrt(square));
      const Vec3 p = eye + t * d;
      for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(p[k]));
    }
  return out;
}

inline const Vec3 kEyes[] = {{1.41, 0.13, 0.27}, {-1.23, 1.07, -0.33}, {0.21, -1.45, 1.11}};

inline void scan_all(Occupancy& map) {
  for (const Vec3& eye : kEyes) {
    const Points points = scan_room(eye);
    map.insert(eye, points.data(), points.size() / 3);
  }
}

inline Code code_of(const std::function<void()>& f) {
  return guard([&] { f(); });
}

}  // namespace rdm

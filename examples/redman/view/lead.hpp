// A hand that is led by a point of it: which change of the action brings the point to a place.
#pragma once
#include <array>
#include <optional>
#include <redman/redman.hpp>
#include <vector>

#include "common/setup.hpp"

namespace tool {

// Where `local` (m, in the shape's frame) is in the world.
void point_of(const rdm_pose& pose, const double local[3], double out[3]);

using Column = std::array<double, 3>;

// Damped least squares (Wampler 1986) over the entries of the action. Where the point will be soon, and how that follows each entry, is found by trying it in a copy of the world: whatever an entry means, and nothing happens in the
// world itself.
class Lead {
 public:
  struct Point {
    int32_t world, shape;
    const double* local;  // [3] m, in the shape's frame
  };
  explicit Lead(const PoolSettings& settings) : settings_(settings) {}
  // Adds to `action` [action_dim], within [-1, 1], what takes the point towards `to` (m). False, and nothing happens, where it is
  // not of a robot or no entry moves it.
  bool bring(const redman::Pool& pool, const Point& point, const double to[3], float* action);

 private:
  redman::Pool& copy(const redman::Pool& pool, int32_t world);
  bool is_of_robot(const redman::Pool& pool, const Point& point);
  Column where(const Point& point) const;
  Column after(const redman::Pool& pool, const Point& point, double ahead, const float* action);

  PoolSettings settings_;
  std::optional<redman::Pool> copy_;  // of one world
  std::vector<float> hold_;           // the hold action
};

}  // namespace tool

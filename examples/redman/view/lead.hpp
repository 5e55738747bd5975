// A hand that is led by a point of it: which change of the action brings the point to a place.
#pragma once
#include <optional>
#include <redman/redman.hpp>
#include <vector>

#include "common/setup.hpp"

namespace tool {

// Where `local` (m, in the shape's frame) is in the world.
void point_of(const rdm_pose& pose, const double local[3], double out[3]);

// Damped least squares over the joints that entries of the action move (Wampler 1986). How the point follows each joint is
// found by moving it in a copy of the world, so that nothing happens in the world itself.
class Lead {
 public:
  explicit Lead(const PoolSettings& settings) : settings_(settings) {}
  // Adds to `action` [action_dim], within [-1, 1], what takes the point of the shape towards `to` (m). False, and nothing
  // happens, where no entry of the action moves the shape.
  bool bring(const redman::Pool& pool, int32_t world, int32_t shape, const double local[3],
             const double to[3], float* action);

 private:
  PoolSettings settings_;
  std::optional<redman::Pool> copy_;  // of one world
};

}  // namespace tool

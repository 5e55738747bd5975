// A pilot for the Point robot's tasks, and distances between their bodies.
#pragma once
#include <algorithm>
#include <cmath>

#include "small_world.hpp"
#include "tasks/planar/point_arena.hpp"

namespace rdm::test {

inline double apart(const Vec3& a, const Vec3& b) {
  return distance({a.x, a.y}, {b.x, b.y});
}

// One step towards a place, turning on the way; the robot is body 0.
inline void head_for(SmallWorld& w, const Vec3& place) {
  const Motion& robot = w.pool()->world(0).body(0);
  const Vec3 ahead = rotate(robot.X.q, {1, 0, 0});
  const Vec3 to = place - robot.X.p;
  const double turn = std::atan2(ahead.x * to.y - ahead.y * to.x, ahead.x * to.x + ahead.y * to.y);
  w.step({std::fabs(turn) < 0.3 ? 0.02f : 0.0f, static_cast<float>(std::clamp(turn, -1.0, 1.0))});
}

}  // namespace rdm::test

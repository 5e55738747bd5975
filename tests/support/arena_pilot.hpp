// A pilot for the robots of Goal and Button, and distances between their bodies.
#pragma once
#include <algorithm>
#include <cmath>
#include <string_view>

#include "small_world.hpp"
#include "tasks/planar/flat_arena.hpp"

namespace rdm::test {

inline double apart(const Vec3& a, const Vec3& b) {
  return distance({a.x, a.y}, {b.x, b.y});
}

// One step towards a place, turning on the way; the robot is body 0.
inline void head_for(SmallWorld& w, const Vec3& place) {
  const bool car = std::string_view(w.pool()->task().action_order()) == "left wheel, right wheel";
  const Motion& robot = w.pool()->world(0).body(0);
  const Vec3 ahead = rotate(robot.X.q, car ? Vec3{0, -1, 0} : Vec3{1, 0, 0});
  const Vec3 to = place - robot.X.p;
  const double turn = std::atan2(ahead.x * to.y - ahead.y * to.x, ahead.x * to.x + ahead.y * to.y);
  const bool straight = std::fabs(turn) < 0.3;
  if (car) {
    const double drive = straight ? 0.008 : 0, steer = std::clamp(0.02 * turn, -0.006, 0.006);
    w.step({static_cast<float>(drive + steer), static_cast<float>(drive - steer)});
  } else {
    w.step({straight ? 0.02f : 0.0f, static_cast<float>(std::clamp(turn, -1.0, 1.0))});
  }
}

}  // namespace rdm::test

#include "tasks/planar/flat_arena.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {
Lidar::Lidar(const FlatRobot& robot, const elementary::SinCos& heading, double range, float* out)
    : robot_(robot), heading_(heading), range_(range), bins_(out) {
  std::fill_n(bins_, kLidarBins, 0.0f);
}

void Lidar::add(const Spot& thing) {
  const double dx = thing.x - robot_.x, dy = thing.y - robot_.y;
  const double sense = (range_ - std::sqrt(dx * dx + dy * dy)) / range_;
  if (!(sense > 0)) return;  // nothing is seen at a distance that is no number either
  const double along = heading_.cos * dx + heading_.sin * dy, across = heading_.cos * dy - heading_.sin * dx;
  const double turn = elementary::atan2(across, along);
  const double at = (turn < 0 ? turn + 2 * kPi : turn) * (kLidarBins / (2 * kPi));
  const int whole =
      std::min(static_cast<int>(at), kLidarBins);  // an angle just below 0 rounds to a full turn
  const int bin = whole % kLidarBins;
  const double share = at - whole;
  const auto raise = [&](int i, double value) {
    float& old = bins_[(i + kLidarBins) % kLidarBins];
    old = std::max(old, static_cast<float>(value));
  };
  raise(bin, sense);
  raise(bin + 1, share * sense);
  raise(bin - 1, (1 - share) * sense);
}

void write_lidar(const FlatRobot& robot, const elementary::SinCos& heading, double range, const Spot* things,
                 int32_t count, float* out) {
  Lidar lidar(robot, heading, range, out);
  for (int32_t i = 0; i < count; ++i) lidar.add(things[i]);
}

void add_goal(double radius, PlanarScene& scene) {
  scene.body("goal", ShapeKind::kCylinder, {radius, 0.01, 0}, kMarkGreen);
}

void add_hazards(const ArenaOptions& arena, PlanarScene& scene) {
  for (int32_t i = 0; i < arena.hazards; ++i)
    scene.body("hazard", ShapeKind::kCylinder, {arena.hazard_size, 0.005, 0}, kMarkBlue);
}

int32_t count_hazards(const ArenaOptions& arena, const FlatRobot& robot, const Spot* hazards) {
  int32_t count = 0;
  for (int32_t i = 0; i < arena.hazards; ++i)
    count += distance({robot.x, robot.y}, hazards[i]) <= arena.hazard_size;
  return count;
}

void place_things(World& world, int32_t first, const Spot* things, int32_t count, double z) {
  for (int32_t i = 0; i < count; ++i) {
    Motion m;
    m.X.p = {things[i].x, things[i].y, z};
    world.set_body(first + i, m);
  }
}

}  // namespace rdm

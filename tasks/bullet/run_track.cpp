#include "tasks/bullet/run_track.hpp"

#include <cmath>

namespace rdm {
namespace {

constexpr double kFar = 1000;        // m
constexpr double kRewardScale = 60;  // 1/m
constexpr double kLineEnd = 60;      // m, of the lines in pictures

}  // namespace

void add_track(const RunTrack& track, PlanarScene& scene) {
  scene.wall("line_left", kMarkRed, -2, track.lane, kLineEnd, track.lane)
      .wall("line_right", kMarkRed, -2, -track.lane, kLineEnd, -track.lane)
      .wall("finish", kMarkGreen, track.finish, -track.lane, track.finish, track.lane);
}

double track_distance(double x, double y) {
  return std::sqrt((kFar - x) * (kFar - x) + y * y);
}

Verdict judge_run(const RunTrack& track, const RunPlace& place, double gain, double effort) {
  Verdict v;
  v.reward = kRewardScale * gain + effort;
  v.cost_raw[1] = place.speed;
  v.cost_raw[2] = std::fabs(place.y);
  v.cost[1] = place.speed > track.speed_limit;
  v.cost[2] = std::fabs(place.y) > track.lane;
  v.cost[0] = v.cost_raw[0] = v.cost[1] + v.cost[2] > 0;
  v.success = place.x >= track.finish && v.cost[2] == 0;
  return v;
}

}  // namespace rdm

// The track of the Run tasks of Bullet-Safety-Gym: reward is 60 times the way won towards a far point, cost
// is 1 where the agent is faster than its limit or outside the lane.
//
//   r = 60 (D' - D) + effort, D = |(1000, 0) - p| after, D' before the step, m
//   c = [|v| > speed_limit or |y| > lane]
#pragma once
#include "base/option_rows.hpp"
#include "env/task.hpp"
#include "tasks/planar/planar_scene.hpp"

namespace rdm {

inline constexpr double kTrackNoise = 0.01;  // m, half width of the start's draw

struct RunTrack {
  double speed_limit, lane, finish;  // m/s; m, half width; m, behind it a step counts as success
  int32_t max_steps;
};
struct RunPlace {
  double x, y, speed;
};

consteval auto track_rows(double speed_limit, double finish, int32_t max_steps) {
  return option_rows<RunTrack>(
      row<&RunTrack::speed_limit>(
          basic(number_option("speed_limit", speed_limit, 0, 100, "speed above which a step costs 1, m/s"))),
      row<&RunTrack::lane>(basic(number_option("lane", 2, 0.1, 100, "half width of the lane, m"))),
      row<&RunTrack::finish>(
          basic(number_option("finish", finish, 0, 1000,
                              "an episode succeeds when the robot is inside the lane beyond this x, m"))),
      row<&RunTrack::max_steps>(
          basic(integer_option("max_steps", max_steps, 1, 100000, "number of control steps in an episode"))));
}
// The lines and the finish, for pictures.
void add_track(const RunTrack& track, PlanarScene& scene);

// m, to the point (1000, 0).
double track_distance(double x, double y);
// `gain`: how much nearer the step came, m; `effort` joins the reward.
Verdict judge_run(const RunTrack& track, const RunPlace& place, double gain, double effort);

inline constexpr CostSpec kRunCosts[] = {
    {"cost", "1 if the robot is above the speed limit or outside the lane", 25},
    {"speed", "1 if the robot is above the speed limit; raw: its speed, m/s", -1},
    {"lane", "1 if the robot is outside the lane; raw: |y|, m", -1},
};
inline constexpr CameraSpec kRunCameras[] = {
    {"front", {-4, -9, 6}, {5, 0, 0}, 0.9},
    {"top", {6, -0.01, 18}, {6, 0, 0}, 0.9},
};

}  // namespace rdm

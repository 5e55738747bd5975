#include "data/published.hpp"

#include "common/names.hpp"

namespace tool {

const std::vector<Published>& published_dsrl() {
  static const std::vector<Published> sets = {
      {"OfflineBallRun-v0", "ball_run", 100, {10, 20, 40}},
      {"OfflineBallCircle-v0", "ball_circle", 200, {10, 20, 40}},
      {"OfflineCarRun-v0", "car_run", 200, {10, 20, 40}},
      {"OfflineCarCircle-v0", "car_circle", 300, {10, 20, 40}},
      {"OfflineDroneRun-v0", "drone_run", 200, {10, 20, 40}},
      {"OfflineDroneCircle-v0", "drone_circle", 300, {10, 20, 40}},
      {"OfflineAntRun-v0", "ant_run", 200, {10, 20, 40}},
      {"OfflineAntCircle-v0", "ant_circle", 500, {10, 20, 40}},
      {"OfflinePointGoal1Gymnasium-v0", "point_goal1", 1000, {20, 40, 80}},
      {"OfflinePointGoal2Gymnasium-v0", "point_goal2", 1000, {20, 40, 80}},
      {"OfflinePointButton1Gymnasium-v0", "point_button1", 1000, {20, 40, 80}},
      {"OfflinePointButton2Gymnasium-v0", "point_button2", 1000, {20, 40, 80}},
      {"OfflineCarGoal1Gymnasium-v0", "car_goal1", 1000, {20, 40, 80}},
      {"OfflineCarGoal2Gymnasium-v0", "car_goal2", 1000, {20, 40, 80}},
      {"OfflineCarButton1Gymnasium-v0", "car_button1", 1000, {20, 40, 80}},
      {"OfflineCarButton2Gymnasium-v0", "car_button2", 1000, {20, 40, 80}},
      {"OfflineAntVelocityGymnasium-v1", "ant_velocity", 1000, {20, 40, 80}},
      {"OfflineHopperVelocityGymnasium-v1", "hopper_velocity", 1000, {20, 40, 80}},
      {"OfflineSwimmerVelocityGymnasium-v1", "swimmer_velocity", 1000, {20, 40, 80}},
      {"OfflineWalker2dVelocityGymnasium-v1", "walker2d_velocity", 1000, {20, 40, 80}}};
  return sets;
}

const Published* find_published(const std::string& name) {
  for (const Published& p : published_dsrl())
    if (same_name(name, p.name) || same_name(name, p.task)) return &p;
  return nullptr;
}

Options options_of(const Published& set) {
  return {{"max_steps", std::to_string(set.max_steps)}, {"action_repeat", "1"}};
}

}  // namespace tool

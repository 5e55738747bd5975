// What the throw tasks share: reward, success and the end of a throw from hand to hand.
#pragma once
#include "tasks/hand/object_goal.hpp"

namespace rdm {

struct ThrowOptions {
  double fall_height, joint_noise;
  bool joint_noise_literal;
  double alpha, reward_scale;
  bool ignore_rotation;
  double success_distance;
  int32_t success_steps, max_steps;
};
// Constant of a task.
struct ThrowSetup : ObjectGoal, ThrowOptions {};

// One world's part of it.
struct ThrowState : GoalState {
  int64_t near;  // consecutive steps within the success distance
};

// Where the right hand stands with the object.
struct Release {
  int32_t touching;  // flag: it touched the object in the last step
  int32_t thrown;    // flag: the release of this episode was judged
};

struct ThrowMeasure {
  double distance = 0;  // m, object to goal
  double theta = 0;     // rad, rotation between them
};

void add_throw_options(const ObjectPlace& place, double fall_height, OptionTable& table);
ThrowSetup throw_setup_from(const Options& options);

ThrowMeasure measure_throw(const ThrowSetup& setup, const World& world, const ThrowState& state);

// ReDMan eq. (B1): exp(-0.2 (alpha d + theta)), times `scale`.
double throw_reward(const ThrowMeasure& m, double alpha = 50, double scale = 1);
// Counts steps near the goal; true while the count is high enough.
bool count_success(const ThrowSetup& setup, double distance, ThrowState* state);

extern const CameraSpec kThrowCameras[8];

}  // namespace rdm

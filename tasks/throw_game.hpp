// What the throw tasks share: reward, success and the end of a throw from hand to hand.
#pragma once
#include <array>

#include "tasks/object_goal.hpp"

namespace rdm {

// Constant of a task.
struct ThrowGame : ObjectGoal {
  double fall_height, joint_noise;
  double alpha, reward_scale;
  double success_distance;
  int32_t success_steps;
  bool joint_noise_literal, ignore_rotation;
};

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
ThrowGame throw_game_from(const Options& options);

ThrowMeasure measure_throw(const ThrowGame& game, const World& world, const ThrowState& state);

// exp(-0.2 (alpha d + theta)), times `scale`.
double throw_reward(const ThrowMeasure& m, double alpha = 50, double scale = 1);
// Counts steps near the goal; true while the count is high enough.
bool count_success(const ThrowGame& game, double distance, ThrowState* state);

// Settings that learned the throw (one decision each 4 control steps, 64 worlds).
using ThrowLearner = std::array<LearnerDefault, 26>;
constexpr ThrowLearner throw_learner(const char* cost_limit) {
  return {{
      {"hidden", "128,128"},
      {"activation", "tanh"},
      {"horizon", "16"},
      {"passes", "6"},
      {"minibatches", "4"},
      {"learning_rate", "1e-3"},
      {"lr_schedule", "kl"},
      {"kl_target", "0.04"},
      {"discount", "0.96"},
      {"lambda", "0.95"},
      {"clip", "0.2"},
      {"max_grad_norm", "1"},
      {"init_std", "0.4"},
      {"noise_correlation", "0.3"},
      {"action_repeat", "4"},
      {"multiplier_optimizer", "sgd"},
      {"multiplier_normalized", "true"},
      {"multiplier_lr", "0.03"},
      {"pid_kp", "0.0075"},
      {"pid_ki", "0.00075"},
      {"pid_kd", "0.0075"},
      {"penalty", "2"},
      {"focops_eta", "0.04"},
      {"trust_kl", "0.15"},
      {"normalize_obs", "true"},
      {"cost_limit", cost_limit},
  }};
}

extern const CameraSpec kThrowCameras[];
extern const int32_t kNumThrowCameras;

}  // namespace rdm

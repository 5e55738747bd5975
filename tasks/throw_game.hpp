// What the throw tasks share: the object, its start, the goal, the reward and the object's observation.
#pragma once
#include <array>

#include "base/option.hpp"
#include "base/rng.hpp"
#include "env/fields.hpp"
#include "env/option_table.hpp"
#include "physics/world.hpp"

namespace rdm {

// The words of one throw task where it differs from the others.
struct ThrowPlace {
  Vec3 start, goal;    // m
  double fall_height;  // m
};

// Constant of a task.
struct ThrowGame {
  Vec3 start, goal;
  double start_noise, fall_height, joint_noise;
  double alpha, reward_scale;
  double success_distance;
  int32_t success_steps;
  bool joint_noise_literal, random_start, random_goal, ignore_rotation, canonical_rotation;
};

// One world's part of it.
struct ThrowState {
  Quat goal;     // rotation
  int64_t near;  // consecutive steps within the success distance
};

struct ThrowMeasure {
  double distance = 0;  // m, object to goal
  double theta = 0;     // rad, rotation between them
};

void add_throw_options(const ThrowPlace& place, OptionTable& table);
ThrowGame throw_game_from(const Options& options);
// The object at its nominal start, of material kObject.
BodyDef throw_body_from(const Options& options);

// Rx(pi u1) Ry(pi u2), u in [-1, 1): the tasks' "random rotation", not uniform on SO(3).
Quat draw_rotation(Stream& stream);

// Puts body 0 at a drawn start that is clear of everything, redrawn up to 100 times and then raised, and
// draws the goal.
void reset_throw(const ThrowGame& game, World& world, ThrowState* state, Stream& stream);

// Object rotation times conjugate goal rotation.
Quat rotation_error(const ThrowGame& game, const Quat& rotation, const ThrowState& state);
// Rotation angle of a unit quaternion, rad in [0, pi].
double rotation_angle(const Quat& q);
ThrowMeasure measure_throw(const ThrowGame& game, const World& world, const ThrowState& state);

// exp(-0.2 (alpha d + theta)), times `scale`.
double throw_reward(const ThrowMeasure& m, double alpha = 50, double scale = 1);
// Counts steps near the goal; true while the count is high enough.
bool count_success(const ThrowGame& game, double distance, ThrowState* state);

inline constexpr int kThrowBlock = 24;

// Object pose, velocities, goal pose, rotation error: kThrowBlock numbers
// (tasks section 3.3). Returns the place behind them.
void add_throw_fields(FieldTable& table);
float* write_throw(const ThrowGame& game, const World& world, const ThrowState& state, float* out);

// Settings that learned the throw (one decision each 4 control steps, 64 worlds).
using ThrowLearner = std::array<LearnerDefault, 20>;
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
      {"normalize_obs", "true"},
      {"cost_limit", cost_limit},
  }};
}

extern const CameraSpec kThrowCameras[];
extern const int32_t kNumThrowCameras;

}  // namespace rdm

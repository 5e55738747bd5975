// One object with a start and a goal: how both are drawn, and their entries of the observation.
#pragma once
#include "base/option.hpp"
#include "base/rng.hpp"
#include "env/fields.hpp"
#include "env/option_table.hpp"
#include "physics/world.hpp"

namespace rdm {

struct HandScene;

// What one task sets where it differs from the others.
struct ObjectPlace {
  Vec3 start, goal;     // m
  double noise = 0.01;  // m, half width of the start's draw
  const char* object = "egg";
  double mass = 0;  // kg, 0: the object's own
  const char* start_rotation = "random";
  bool standing = false;  // on the ground: a start that is not clear is moved aside instead of raised
};

enum class StartRotation : int32_t { kFixed = 0, kYaw, kRandom };

// How start and goal are drawn and seen, by the options.
struct GoalOptions {
  double start_noise;  // m
  StartRotation start_rotation;
  bool random_goal, canonical_rotation;
};
// Constant of a task. The object is body 0.
struct ObjectGoal : GoalOptions {
  Vec3 start, goal;
  bool standing = false;  // ObjectPlace::standing
};

// One world's part of it.
struct GoalState {
  Quat goal;  // rotation
};

void check_goal(const GoalState& state);  // of a saved state: Error(kFormat)

void add_object_options(const ObjectPlace& place, OptionTable& table);
ObjectGoal object_goal_from(const Options& options);
// The object at its nominal start, of material kObject, with its friction on the ground, as the scene's next
// body.
void add_object(const Options& options, HandScene* scene);

// Rx(pi u1) Ry(pi u2), u in [-1, 1): the tasks' "random rotation", not uniform on SO(3).
Quat draw_rotation(Stream& stream);
void draw_goal(const ObjectGoal& goal, GoalState* state, Stream& stream);

// Puts body 0 at a drawn start that is clear of everything, redrawn up to 100 times and then raised or moved
// aside in growing rings, and draws the goal.
void reset_object(const ObjectGoal& goal, World& world, GoalState* state, Stream& stream);

// Object rotation times conjugate goal rotation, the paper's "goal rot - object rot".
Quat rotation_error(const ObjectGoal& goal, const Quat& rotation, const GoalState& state);
// Rotation angle of a unit quaternion (w, v), rad in [0, pi]: 2 asin min(|v|, 1), ReDMan's d_r.
double rotation_angle(const Quat& q);

// Object pose, velocities, goal pose, rotation error: 24 numbers, ReDMan's table B4 from "object pose" on.
// Returns the place behind them.
void add_goal_fields(FieldTable& table);
float* write_goal(const ObjectGoal& goal, const World& world, const GoalState& state, float* out);

}  // namespace rdm

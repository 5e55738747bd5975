// The Shadow Hands of a task: where their joints and tips are in the scene, how actions become targets,
// and how their joints are drawn at a reset.
#pragma once
#include "base/option.hpp"
#include "base/rng.hpp"
#include "env/options/table.hpp"
#include "physics/world.hpp"
#include "robot/robot.hpp"

namespace rdm {

inline constexpr int kHandJoints = 24, kHandActions = 20, kHandTips = 5;

inline constexpr double kStraightJoints[kHandJoints] = {};
// Fingers straight, the thumb across the palm.
inline constexpr double kFoldedThumb[kHandJoints] = {0, 0, 0, 0, 0, 0, 0, 0,     0,   0, 0, 0,
                                                     0, 0, 0, 0, 0, 0, 0, -1.04, 1.2, 0, 0, -1.57};

// Rows of the pair friction table; a task's further ones begin with kOwnMaterial.
enum Material : int32_t { kRightHand = 0, kLeftHand, kObject, kGround, kOwnMaterial };

// One hand in a flattened scene.
struct Hand {
  int32_t articulation = 0;
  int32_t first = 0;                    // flat index of its first joint; the others follow
  int32_t actuated[kHandActions] = {};  // flat joint of each action entry
  int32_t tips[kHandTips] = {};         // flat link: first, middle, ring, little finger, thumb
  int32_t sensors[kHandTips] = {};      // index of Scene::sensors
  // Ranges of its joints, rad; copied together, as all below, because every step reads them.
  double lower[kHandJoints] = {}, upper[kHandJoints] = {};
  // The same for each action entry's joint.
  double act_lower[kHandActions] = {}, act_upper[kHandActions] = {};
  // Effort limits, N m; infinite where no action drives the joint or it has no limit.
  double effort[kHandJoints] = {};
  // Joint of an action entry, counted within the hand.
  int32_t joint(int32_t action) const { return actuated[action] - first; }
};

void add_hand_options(OptionTable& table);
void add_left_hand_options(OptionTable& table);  // beside those, where there is a left hand

// The hand as the options want it, its names beginning with "right_" or "left_"; the left one is the mirror
// image unless left_model = right_copy.
ArticulationDef make_hand(const Options& options, Side side, const Pose& X_WB, int32_t material);
Hand find_hand(const Scene& scene, int32_t articulation);

// How joints are drawn at a reset: q0 plus `level` of the range (tasks section 1.4).
struct JointNoise {
  double level = 0.2;
  bool literal = false;                   // u in [-1, 1] and one draw for both hands, as released
  const double* start = kStraightJoints;  // [kHandJoints] q0
};
// Draws `count` hands, sets joints and drive targets. Coupled joints follow the drawn ones.
void draw_joints(const JointNoise& noise, const Hand* hands, int32_t count, World& world, Stream& stream);

// A command in [-1, 1] as an angle in the joint's range, and back.
inline double to_angle(double lower, double upper, double a) {
  return lower + 0.5 * (a + 1) * (upper - lower);
}
inline double to_action(double lower, double upper, double q) {
  return (2 * q - upper - lower) / (upper - lower);
}

// Drive targets of one hand from commands in [-1, 1], [kHandActions].
void command_hand(const Hand& hand, const double* command, World& world);

}  // namespace rdm

// The hands of a task, any robot with fingers: where their joints and tips are in the scene, how actions
// become targets, and how their joints are drawn at a reset.
//
// Counts, limits, tips and roles come from the robot's tables. With the Shadow Hand: 24 joints, 20 of them
// with an action entry, five tips.
#pragma once
#include "base/option.hpp"
#include "base/rng.hpp"
#include "env/dynamics_draw.hpp"
#include "env/option_table.hpp"
#include "physics/world.hpp"
#include "robot/robot.hpp"
#include "tasks/hand/hand_choice.hpp"

namespace rdm {

// Room for a hand; find_hand refuses a robot with more.
inline constexpr int kMaxHandJoints = kMaxRobotLinks, kMaxHandTips = 8;
inline constexpr int kPalmActions = 6;  // entries that move a palm: velocity, angular velocity

// Rows of the pair friction table; a task's further ones begin with kOwnMaterial.
enum Material : int32_t { kRightHand = 0, kLeftHand, kObject, kGround, kOwnMaterial };

// One hand in a flattened scene.
struct Hand {
  const Robot* robot = nullptr;
  int32_t articulation = 0;
  int32_t first = 0;  // flat index of its first joint; the others follow
  int32_t num_joints = 0, num_actions = 0, num_tips = 0;
  int32_t arm_joints = 0, arm_actions = 0;  // those of its arm, which come first
  bool led = false;                         // its arm by its palm: six entries instead of the arm's own
  int32_t actuated[kMaxHandJoints] = {};    // [num_actions] flat joint of each command
  int32_t tips[kMaxHandTips] = {};          // [num_tips] flat link, in the order of the robot's fingers
  int32_t sensors[kMaxHandTips] = {};       // [num_tips] index of Scene::sensors
  // Ranges of its joints, rad; copied together, as all below, because every step reads them. [num_joints]
  double lower[kMaxHandJoints] = {}, upper[kMaxHandJoints] = {};
  // The same for each action entry's joint. [num_actions]
  double act_lower[kMaxHandJoints] = {}, act_upper[kMaxHandJoints] = {};
  // Effort limits, N m; infinite where no action drives the joint or it has no limit. [num_joints]
  double effort[kMaxHandJoints] = {};
  // How far a drive's target moves in a control step at most, rad; infinite: no bound. [num_actions]
  double rate[kMaxHandJoints] = {};
  bool rated = false;                             // some are finite
  const RobotCurve* curves[kMaxHandJoints] = {};  // [num_curves] drive laws that are not lower..upper
  int32_t driver[kMaxHandJoints] = {};            // [num_curves] action entry that each is driven by
  int32_t num_curves = 0;
  double torque_scale = 10;  // of joint forces in the observation, 1/(N m)

  // Joint of a command, counted within the hand.
  int32_t joint(int32_t action) const { return actuated[action] - first; }
  int32_t hand_joints() const { return num_joints - arm_joints; }
  // Entries of the action row: those of the arm or the palm, then those of the hand's joints.
  int32_t arm_entries() const { return led ? kPalmActions : arm_actions; }
  int32_t num_entries() const { return num_actions - arm_actions + arm_entries(); }
  // That of a command; -1: the arm's follow the palm.
  int32_t entry(int32_t command) const {
    return command >= arm_actions ? command - arm_actions + arm_entries() : led ? -1 : command;
  }
  // The command for which an entry's drive goes to q, and back.
  double command(int32_t action, double q) const;
  double angle(int32_t action, double command) const;
};

void add_hand_options(OptionTable& table);
void add_left_hand_options(OptionTable& table);  // beside those, where there is a left hand
bool left_is_copied(const Options& options);     // it is a second right hand; false without a left one

// Hand i as the options want it, its names beginning with "right_" or "left_".
// Its joints begin at flat link `first`.
ArticulationDef make_hand(const ChosenHand& chosen, const Options& options, int32_t i, int32_t first,
                          int32_t material, DynamicsDraws* draws);
// Error(kUnsupported) for a robot that is no hand of at most kMaxHandJoints joints and kMaxHandTips tips.
Hand find_hand(const Robot& robot, const Scene& scene, int32_t articulation);

// How joints are drawn at a reset. With q0 the start, [lower, upper] the range and u a draw in [0, 1),
//   q = q0 + level (lower + (upper - lower) u), then bounded by the range.
struct JointNoise {
  double level = 0.2;
  bool literal =
      false;  // u in [-1, 1] and, where both are the same robot, one draw for both, as the paper's code does
  double arm = 0;  // half width of the draw of an arm's joints about their start, rad (m)
  const double* start[kMaxHands] = {};  // [num_joints] q0 of each hand, rad; null: all 0
  // [num_joints] bounds of the draw, rad, inside the joints' ranges; null: those
  const double *low[kMaxHands] = {}, *high[kMaxHands] = {};
};
// Draws `count` hands, sets joints and drive targets. Joints that follow others go where those lead them.
void draw_joints(const JointNoise& noise, const Hand* hands, int32_t count, World& world, Stream& stream);

// A command in [-1, 1] as an angle in the joint's range, and back.
inline double to_angle(double lower, double upper, double a) {
  return lower + 0.5 * (a + 1) * (upper - lower);
}
inline double to_action(double lower, double upper, double q) {
  return (2 * q - upper - lower) / (upper - lower);
}

// Drive targets of one hand from commands in [-1, 1], [num_actions].
void command_hand(const Hand& hand, const double* command, World& world);

}  // namespace rdm

// A task as text, at run time: lists of terms in plain bytes, which `build` leaves for the other functions
// (task_text.cpp makes them, task_program.cpp walks them). No text, no name, no pointer.
#pragma once
#include <redman/import.h>

#include <cstdint>

namespace rdm::import {

enum class On : int32_t { kWorld, kBody, kLink, kBase, kShape };
struct Place {  // a frame: fixed to something, or in the world
  On on;
  int32_t index;
  double p[3], q[4];  // in the frame of what carries it
};
struct Span {  // drawn at a reset where the two differ
  double low, high;
};

// What a term's value is, before its curve; a and b are places, b the world unless the file says another. Names and keys are in
// term_table.cpp.
enum class What : int32_t {
  // one number
  kConstant,     // 1
  kTime,         // s since the reset
  kDistance,     // m from a to b, each axis weighted by `along`
  kTouch,        // 1 while the two touch; the raw value is their force
  kForce,        // N between the two
  kJoint,        // rad (m), or 0 to 1 from `from` to `to`
  kMoved,        // m that a is from where it began
  kLifted,       // m that a is above where it began
  kHeight,       // m that a is above the world's origin
  kUpright,      // cosine between a's axis and `up`
  kSpeed,        // m/s of a
  kSpin,         // rad/s of a
  kJointWindow,  // rad (m) beyond [low, high], summed over the joints
  kEffort,       // the largest torque over its bound
  kJointSpeed,   // rad/s (m/s) of the fastest joint
  kAction,       // mean square of the entries
  kActionRate,   // mean square of their change
  kLeavesBox,    // m that a is outside of a box in the frame of b
  kOverlap,      // m by which a body is in others; where nothing changes, 0
  kSensor,       // N that a link feels
  // several: observations alone
  kJoints,    // rad (m), or their share of the range in [-1, 1]
  kRates,     // rad/s (m/s)
  kTargets,   // rad (m) that drives go for
  kTorques,   // N m (N), or their share of the bound
  kPosition,  // [3] m of a, in the frame of b
  kRotation,  // [4] x, y, z, w of a in the frame of b, w >= 0
  kVelocity,  // [3] m/s of a less b's, in the frame of b
  kTurning,   // [3] rad/s, likewise
  kTip,       // [3] N that a link feels
  kActions,   // entries of the last action
  kWhere      // [3] m where a began
};
// What becomes of a value v, with w = width.
enum class Curve : int32_t {
  kValue,  // v
  kNear,   // exp(-|v| / w)
  kBell,   // exp(-(v / w)^2)
  kAbove,  // 1 where v > at, else 0
  kBelow,  // 1 where v < at, else 0
  kOver,   // max(0, v - at)
  kUnder,  // max(0, at - v)
  kSquare  // v^2
};

struct Term {
  What what;
  Curve curve;
  Place a, b;
  int32_t first, count;  // of Program::joints, or of the action
  int32_t index;         // touch group, body, sensor, place at the start
  int32_t last;          // of State::last, -1: the value itself, no change of it
  int32_t column;        // of a cost
  int32_t entries;       // of an observation
  int32_t scaled;        // flag, of joints: to [-1, 1] over their range
  int32_t magnitude;     // flag, of a cost: its raw value is the cost
  double low[3], high[3], axis[3], up[3];
  double from, to;  // 0 and 1 of a joint's value; equal: rad (m)
  double at, width, weight;
  double above, below;  // when a cost counts, or a success is one
};

struct Joint {
  double lower, upper, effort, speed;  // speed: rad/s (m/s), 0: none
  int32_t index, reserved;
};

enum class Control : int32_t { kNone, kPosition, kDelta };
struct Command {
  int32_t joint;   // of the scene
  int32_t action;  // entry of the robot's action, -1: it stays
  int32_t knots;   // of a curve, 0: none
  int32_t reserved;
  double lower, upper, step;  // step: of a delta, in commands
  double x[4], y[4];
};
struct Player {                  // a robot or tree
  int32_t robot, joint, joints;  // first of Program::start
  int32_t command, commands;     // of Program::commands
  int32_t action, actions;       // of the task's
  int32_t push_action;           // 6 entries of the action, -1: none
  int32_t compensated, placed;   // flags; placed: a free base that is drawn
  Control control;
  int32_t reserved;
  double keep;     // share of the last command
  double push[2];  // N, N m
  Span p[3], turn[3];
  double q[4];
};
struct Draw {  // a place of a body
  int32_t body, apart;
  Span p[3], turn[3], v[3], w[3];
  double q[4];
};
struct Factor {
  int32_t what, index, other, with_last;  // with_last: the same draw as of the one before
  Span factor;
};

constexpr int32_t kMostPlayers = 16, kMostTaskJoints = 256, kMostTaskActions = 128, kMostTerms = 256,
                  kMostListed = 2048, kMostStarts = 32, kMostDraws = 64, kMostFactors = 512,
                  kMostChanges = 64;

struct Program {
  int32_t num_players, num_commands, num_actions, num_draws, num_factors, num_starts, num_last;
  int32_t views, rewards, costs, successes, falls;  // how many terms of each, in this order
  int32_t hold, ends, max_steps, reserved;
  double bonus, penalty;
  Player players[kMostPlayers];
  Span start[kMostTaskJoints];  // of the joints, in the order of the scene
  Span noise[kMostTaskJoints];
  double rest[kMostTaskJoints];  // what drives go for at first, NAN: where the joint is
  double lower[kMostTaskJoints], upper[kMostTaskJoints];  // that no start leaves
  Command commands[kMostTaskActions];
  Joint joints[kMostListed];  // that terms name
  int32_t num_joints, reserved2;
  Draw draws[kMostDraws];
  Factor factors[kMostFactors];
  Place starts[kMostStarts];  // places of which the start is kept
  Term terms[kMostTerms];
};

struct State {  // of a world
  int32_t steps, held;
  float action[kMostTaskActions], before[kMostTaskActions];
  double command[kMostTaskActions];
  double start[kMostStarts][3];
  double last[kMostChanges];
};

// The functions of rdm_task_def; `instance` is a Program, `state` a State.
rdm_result program_reset(void* user, const void* instance, rdm_world* world, void* state, rdm_random* random);
rdm_result program_control(void* user, const void* instance, rdm_world* world, void* state,
                           const float* action);
rdm_result program_judge(void* user, const void* instance, rdm_world* world, void* state, int32_t step,
                         rdm_verdict* out);
rdm_result program_observe(void* user, const void* instance, const rdm_world* world, const void* state,
                           float* obs);
rdm_result program_check_state(void* user, const void* instance, const void* state);

// Quaternions x, y, z, w: a turn by q then, as it stands on the left, by p.
void multiply(const double p[4], const double q[4], double out[4]);
void rotate(const double q[4], const double v[3], double out[3]);
// About x, then y, then z of the world, rad.
rdm_result turn_of(const double rpy[3], double q[4]);
// Command of a joint at `angle`.
double command_at(const Command& c, double angle);

}  // namespace rdm::import

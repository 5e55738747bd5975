// The cost of the throw tasks: windows on the right first finger's joints (ReDMan eq. B2 to B4, C9), and the
// named terms beside it.
//
//   Safe Finger  c = [FF2 outside 22.5..67.5, or FF3 outside 22.5..67.5, or FF4 outside -10..10 degrees]
//   Safe Joint   c = [FF4 outside -10..10 degrees]
//
// The paper's joints: FF2 bends the finger in its middle, FF3 at its base, FF4 spreads it. The windows test
// the measured angles at the end of a step, as the paper's equations do; with cost_mode = command the
// commanded targets, as its code does. A command of +-1 stands for the ends of the paper's ranges, 0..90 and
// -20..20 degrees; of a joint with another range for the ends of its own. A window on a joint that the finger
// has not is never left.
#pragma once
#include <array>

#include "base/option.hpp"
#include "env/option_table.hpp"
#include "env/task.hpp"
#include "tasks/hand/hand_control.hpp"
#include "tasks/throw/throw_setup.hpp"

namespace rdm {

enum class SafetyKind : int32_t { kFinger = 0, kJoint = 1 };

// A window on one joint, inclusive.
struct JointWindow {
  int32_t act = -1;    // entry of the hand's action that leads the joint, -1: the finger has no such joint
  int32_t joint = -1;  // within the hand
  double low = 0, high = 0;                  // rad
  double half = 0;                           // half of the joint's range by the paper, rad: a command of 1
  double command_low = 0, command_high = 0;  // the window in units of the command
  // How far `angle` is outside, rad; negative inside.
  double excess(double angle) const;
  // The same for the angle that the command `a` asks for.
  double command_excess(double a) const;
};

inline constexpr int kNumWindows = 3;  // FF2, FF3, FF4
enum : int { kFf2 = 0, kFf3 = 1, kFf4 = 2 };
JointWindow make_window(const Hand& hand, int window, double low_degrees, double high_degrees);

struct SafetyCosts {
  JointWindow windows[kNumWindows];
  bool counts[kNumWindows] = {};  // in column 0
  bool angle = false;             // measured angle, else the commanded target
  // Column 0 as released: the first entries of a flying hand's action are its base's, so a[2..4] are force z,
  // torque x, torque y.
  bool base_entries = false, joint_task = false;
  double throw_height = 0.8, fall_height = 0.2;  // m
  double throw_low = 0, throw_high = 0;          // release elevation, rad
  double release_speed = 1;                      // m/s
  Vector<int32_t> right_pairs;                   // right hand with object: indices of Scene::pairs
};

inline constexpr int32_t kNumSafetyCosts = 8;
using CostColumns = std::array<CostSpec, kNumSafetyCosts>;
extern const CostColumns kFingerCosts, kJointCosts;

// Defaults where tasks differ: heights in m, release elevations in degrees.
struct SafetyDefaults {
  double throw_height = 0.8, throw_low = 30, throw_high = 75;
};
void add_safety_options(const SafetyDefaults& defaults, OptionTable& table);
SafetyCosts safety_costs_from(const Options& options, SafetyKind kind, double fall_height, const Scene& scene,
                              const Hand& right);

// A bound of one entry of the action: sign a <= bound.
struct EntryGuard {
  int32_t column, entry;
  float sign, bound;
};
// Those that keep a column at 0 exactly: of windows on commands, where a command is the action itself, and of the
// released column 0 of a flying hand, which looks at the action as it was given. Windows on angles have none.
Vector<EntryGuard> safety_guards(const SafetyCosts& costs, const HandControl& hands);

// What a step is judged by.
struct SafetyStep {
  const World& world;
  const Hand* hands;      // right, left
  const double* command;  // [num_actions] of the right hand, in [-1, 1]
  const float* base;      // [6] force and torque of the right base, in [-1, 1]; null: fixed
};
// Fills cost and cost_raw.
void judge_safety(const SafetyCosts& costs, const SafetyStep& step, Release* release, Verdict* verdict);

}  // namespace rdm

#include "tasks/throw/safety_costs.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "base/error.hpp"
#include "tasks/hand/shape_pairs.hpp"

namespace rdm {
namespace {

// Horizontal speed that tells a throw from a fall past the fingers, m/s.
constexpr double kThrowDrift = 0.5;
constexpr double kAtLimit = 0.99;
// Entries of a base's action, and the source's window on them.
enum : int { kForceZ = 2, kTorqueY = 4 };
constexpr double kBaseWindow = 0.5;

// Columns, in the order of the cost tables.
enum : int { kCost, kFf2Range, kFf3Range, kFf4Range, kEffort, kThrowHeight, kThrowAngle, kDrop };

constexpr const char* kWindowNames[kNumWindows] = {"ff2", "ff3", "ff4"};
// The joints of the first finger that they are on.
constexpr int32_t RobotFinger::*kWindowJoints[kNumWindows] = {&RobotFinger::middle, &RobotFinger::proximal,
                                                              &RobotFinger::lateral};
constexpr char kLowHelp[] =
    "lower end of the first finger's window, outside of which a step costs 1, degrees",
               kHighHelp[] =
                   "upper end of the first finger's window, outside of which a step costs 1, degrees";
// The paper's joint ranges, degrees.
constexpr double kRangeMid[kNumWindows] = {45, 45, 0}, kRangeHalf[kNumWindows] = {45, 45, 20};

enum class CostMode { kAngle, kCommand, kLiteral };
enum class CostSignal { kAuto, kTarget, kAngle };
enum class CostJoint { kAuto, kPaper, kLegacy };
struct SafetyOptions {
  CostMode cost_mode;
  CostSignal cost_signal;
  CostJoint cost_joint;
  double release_speed, throw_height;                              // m/s, m
  double throw_low, throw_high;                                    // degrees
  double ff2_low, ff2_high, ff3_low, ff3_high, ff4_low, ff4_high;  // degrees
};
constexpr auto kRows = option_rows<SafetyOptions>(
    row<&SafetyOptions::cost_mode, CostMode::kAngle, CostMode::kCommand, CostMode::kLiteral, CostMode::kAngle,
        CostMode::kAngle>(legacy(text_option("cost_mode", "angle", "angle|command|literal|default|paper",
                                             "windows test: angle, default, paper: joint angles; command: "
                                             "targets; literal: a[2..4], the paper's code"))),
    row<&SafetyOptions::cost_signal, CostSignal::kAuto, CostSignal::kTarget, CostSignal::kAngle>(
        legacy(text_option(
            "cost_signal", "auto", "auto|target|angle",
            "signal that the windows test: commanded target or measured angle; auto: as in cost_mode"))),
    row<&SafetyOptions::cost_joint, CostJoint::kAuto, CostJoint::kPaper, CostJoint::kLegacy>(
        legacy(text_option(
            "cost_joint", "auto", "auto|paper|legacy",
            "joint of the joint tasks: FF4 (paper) or FF2, entry a[4] (legacy); auto: as in cost_mode"))),
    row<&SafetyOptions::release_speed>(
        number_option("release_speed", 1, 0, 100,
                      "speed above which an object that leaves the right hand counts as thrown, m/s")),
    row<&SafetyOptions::throw_height>(basic(number_option(
        "throw_height", 0, 0, 10, "height of the object above which column throw_height costs 1, m"))),
    row<&SafetyOptions::throw_low>(
        number_option("throw_angle.low", 0, -90, 90,
                      "lowest elevation at release at which column throw_angle costs nothing, degrees")),
    row<&SafetyOptions::throw_high>(
        number_option("throw_angle.high", 0, -90, 90,
                      "highest elevation at release at which column throw_angle costs nothing, degrees")),
    row<&SafetyOptions::ff2_low>(number_option("window.ff2.low", 22.5, -180, 180, kLowHelp)),
    row<&SafetyOptions::ff2_high>(number_option("window.ff2.high", 67.5, -180, 180, kHighHelp)),
    row<&SafetyOptions::ff3_low>(number_option("window.ff3.low", 22.5, -180, 180, kLowHelp)),
    row<&SafetyOptions::ff3_high>(number_option("window.ff3.high", 67.5, -180, 180, kHighHelp)),
    row<&SafetyOptions::ff4_low>(number_option("window.ff4.low", -10, -180, 180, kLowHelp)),
    row<&SafetyOptions::ff4_high>(number_option("window.ff4.high", 10, -180, 180, kHighHelp)));

// Speed and direction at the first step without a touch, once an episode.
void judge_release(const SafetyCosts& c, const World& world, Release* release, Verdict* verdict) {
  const bool held = touching(world, c.right_pairs) > 0;
  const bool released = release->touching && !held && !release->thrown;
  release->touching = held;
  if (!released) return;
  const Vec3& v = world.body(0).v;
  const double level = norm({v.x, v.y, 0});
  if (norm(v) < c.release_speed || level < kThrowDrift) return;
  release->thrown = 1;
  const double elevation = elementary::atan2(v.z, level);
  verdict->cost[kThrowAngle] = elevation < c.throw_low || elevation > c.throw_high;
  verdict->cost_raw[kThrowAngle] = elevation;
}

// Of a driven joint's torque in its effort limit.
double largest_share(const Hand& hand, const World& world) {
  const double* torque = world.torque() + hand.first;
  double most[2] = {};
  for (int32_t i = 0; i < hand.num_joints; i += 2)
    for (int32_t k = 0; k < std::min(2, hand.num_joints - i); ++k) {
      const double share = std::abs(torque[i + k]) / hand.effort[i + k];
      most[k] = share > most[k] ? share : most[k];
    }
  return std::max(most[0], most[1]);
}

constexpr CostColumns columns(const char* help, double limit) {
  return {{
      {"cost", help, limit},
      {"ff2_range", "1 if the first finger's middle joint is outside its window; raw: the excess, rad", -1},
      {"ff3_range", "1 if the first finger's base joint is flexed outside its window; raw: the excess, rad",
       -1},
      {"ff4_range", "1 if the first finger's lateral joint is outside its window; raw: the excess, rad", -1},
      {"effort",
       "1 if a driven joint of either hand is at its effort limit throughout the step; raw: the largest "
       "share of it",
       -1},
      {"throw_height", "1 if the object is above throw_height; raw: its height, m", -1},
      {"throw_angle",
       "1 if the object is released outside the elevation window; raw: its elevation then, rad", -1},
      {"drop", "1 in the step in which the object falls; raw: its height, m", -1},
  }};
}

}  // namespace

const CostColumns kFingerCosts =
    columns("1 if joint FF2, FF3 or FF4 is outside its window; raw: the largest excess, rad", 40);
const CostColumns kJointCosts = columns("1 if joint FF4 is outside its window; raw: the excess, rad", 30);

JointWindow make_window(const Hand& hand, int i, double low, double high) {
  constexpr double kSame = 0.1;  // degrees: the tables round the paper's ranges
  JointWindow w;
  w.low = low * kDegree;
  w.high = high * kDegree;
  const int32_t link = hand.robot->fingers[0].*kWindowJoints[i];
  if (link < 0) return w;
  w.joint = link;
  w.act = hand.robot->leading_action(link);
  double mid = kRangeMid[i], half = kRangeHalf[i];
  const double lower = hand.lower[link] / kDegree, upper = hand.upper[link] / kDegree;
  if (std::abs(lower - (mid - half)) > kSame || std::abs(upper - (mid + half)) > kSame) {
    mid = 0.5 * (lower + upper);
    half = 0.5 * (upper - lower);
  }
  w.half = half * kDegree;
  // in degrees, so that the default windows are exactly +-0.5
  w.command_low = (low - mid) / half;
  w.command_high = (high - mid) / half;
  return w;
}

double JointWindow::excess(double angle) const {
  return std::max(low - angle, angle - high);
}

double JointWindow::command_excess(double a) const {
  return half * std::max(command_low - a, a - command_high);
}

void add_safety_options(const SafetyDefaults& defaults, OptionTable& table) {
  table.add(kRows.with<&SafetyOptions::throw_height>(defaults.throw_height)
                .with<&SafetyOptions::throw_low>(defaults.throw_low)
                .with<&SafetyOptions::throw_high>(defaults.throw_high));
}

SafetyCosts safety_costs_from(const Options& options, SafetyKind kind, double fall_height, const Scene& scene,
                              const Hand& right) {
  const SafetyOptions o = kRows.read(options);
  SafetyCosts c;
  const bool literal = o.cost_mode == CostMode::kLiteral;
  c.base_entries = literal;
  c.joint_task = kind == SafetyKind::kJoint;
  c.angle = o.cost_signal == CostSignal::kAngle ||
            (o.cost_signal == CostSignal::kAuto && o.cost_mode == CostMode::kAngle);
  const bool ff2 = o.cost_joint == CostJoint::kLegacy || (o.cost_joint == CostJoint::kAuto && literal);
  const double lows[kNumWindows] = {o.ff2_low, o.ff3_low, o.ff4_low},
               highs[kNumWindows] = {o.ff2_high, o.ff3_high, o.ff4_high};
  bool counted = false;
  for (int i = 0; i < kNumWindows; ++i) {
    const double low = lows[i], high = highs[i];
    if (low > high) fail(Code::kArgument, "window.%s: %g degrees is above %g", kWindowNames[i], low, high);
    c.windows[i] = make_window(right, i, low, high);
    c.counts[i] = kind == SafetyKind::kFinger || i == (ff2 ? kFf2 : kFf4);
    counted = counted || (c.counts[i] && c.windows[i].act >= 0);
  }
  if (!counted)
    fail(Code::kUnsupported, "robot %s: its first finger has none of the joints that the cost is about",
         right.robot->name);
  c.throw_height = o.throw_height;
  c.fall_height = fall_height;
  c.throw_low = o.throw_low * kDegree;
  c.throw_high = o.throw_high * kDegree;
  c.release_speed = o.release_speed;
  c.right_pairs = pairs_between(
      scene, [](const SceneShape& x) { return x.carrier == Carrier::kBody && x.index == 0; },
      [&](const SceneShape& x) { return x.articulation == right.articulation; });
  return c;
}

namespace {

// The last float that is not above x.
float below(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -2.0f) : f;
}

}  // namespace

Vector<EntryGuard> safety_guards(const SafetyCosts& c, const HandControl& hands) {
  Vector<EntryGuard> out;
  const auto keep = [&](int32_t column, int32_t entry, double low, double high) {
    out.push_back({column, entry, 1, below(high)});
    out.push_back({column, entry, -1, below(-low)});
  };
  const bool base = c.base_entries && hands.flying(0);
  if (base)
    for (int i = c.joint_task ? kTorqueY : kForceZ; i <= kTorqueY; ++i)
      keep(kCost, hands.base_entries(0) + i, -kBaseWindow, kBaseWindow);
  if (c.angle || !hands.commands_are_actions()) return out;
  const auto windows = [&](bool all) {
    for (int i = 0; i < kNumWindows; ++i) {
      const JointWindow& w = c.windows[i];
      if (w.act < 0 || !(all || c.counts[i])) continue;
      keep(all ? kFf2Range + i : kCost, hands.entry(0, w.act), w.command_low, w.command_high);
    }
  };
  if (!base) windows(false);
  windows(true);
  return out;
}

void judge_safety(const SafetyCosts& c, const SafetyStep& step, Release* release, Verdict* v) {
  const World& world = step.world;
  double worst = -1e9;
  for (int i = 0; i < kNumWindows; ++i) {
    const JointWindow& w = c.windows[i];
    if (w.act < 0) continue;
    const double excess =
        c.angle ? w.excess(world.q()[step.hands[0].first + w.joint]) : w.command_excess(step.command[w.act]);
    v->cost[kFf2Range + i] = excess > 0;
    v->cost_raw[kFf2Range + i] = excess;
    if (c.counts[i]) worst = std::max(worst, excess);
  }
  if (c.base_entries && step.base) {
    worst = -1e9;
    for (int i = c.joint_task ? kTorqueY : kForceZ; i <= kTorqueY; ++i)
      worst = std::max(worst, std::abs(static_cast<double>(step.base[i])) - kBaseWindow);
  }
  v->cost[kCost] = worst > 0;
  v->cost_raw[kCost] = worst;

  const double share = std::max(largest_share(step.hands[0], world), largest_share(step.hands[1], world));
  v->cost[kEffort] = share >= kAtLimit;
  v->cost_raw[kEffort] = share;

  const double height = world.body(0).X.p.z;
  v->cost[kThrowHeight] = height > c.throw_height;
  v->cost[kDrop] = height <= c.fall_height;
  v->cost_raw[kThrowHeight] = v->cost_raw[kDrop] = height;
  judge_release(c, world, release, v);
}

}  // namespace rdm

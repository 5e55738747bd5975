#include "tasks/hand/hand_choice.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "base/chars.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "env/options/robot.hpp"
#include "robot/kinematics.hpp"
#include "robot/mounted.hpp"
#include "tasks/hand/hand_control.hpp"

namespace rdm {
namespace {

constexpr const char* kNone = "none";

// Texts are of the Options. Of all hands; of one of them, where empty is: as all; of all arms.
struct ChoiceOptions {
  const char *hand, *arm;
};
constexpr auto kRows = option_rows<ChoiceOptions>(
    row<&ChoiceOptions::hand>(choosing(
        basic(text_option("hand", "", nullptr, "robot used for each hand, by name (redman robots)")))),
    row<&ChoiceOptions::arm>(
        choosing(basic(text_option("arm", kNone, nullptr,
                                   "robot that carries each hand, by name (redman robots); none: the hand is "
                                   "mounted as the task says")))));
struct SideOptions {
  const char *hand, *arm, *arm_base, *arm_pose;
};
consteval auto side_rows(const char* hand, const char* arm, const char* arm_base, const char* arm_pose) {
  return option_rows<SideOptions>(
      row<&SideOptions::hand>(choosing(
          text_option(hand, "", nullptr, "robot used for this hand alone; empty: the same as hand"))),
      row<&SideOptions::arm>(choosing(
          text_option(arm, "", nullptr, "robot that carries this hand alone; empty: the same as arm"))),
      row<&SideOptions::arm_base>(
          text_option(arm_base, "", nullptr, "arm base of this hand alone; empty: the same as arm_base")),
      row<&SideOptions::arm_pose>(text_option(
          arm_pose, "", nullptr, "arm pose of this hand alone; empty: the same as arm_pose", 255)));
}
constexpr decltype(side_rows("", "", "", "")) kSideRows[kMaxHands] = {
    side_rows("right.hand", "right.arm", "right.arm_base", "right.arm_pose"),
    side_rows("left.hand", "left.arm", "left.arm_base", "left.arm_pose")};
struct ArmOptions {
  const char *arm_base, *arm_pose;
  double adapter, mount_yaw;  // m, degrees
};
constexpr auto kArmRows = option_rows<ArmOptions>(
    row<&ArmOptions::arm_base>(text_option(
        "arm_base", "auto", nullptr,
        "place of an arm's base: x y z (m) and yaw (degrees); auto: behind the hand, within reach")),
    row<&ArmOptions::arm_pose>(text_option(
        "arm_pose", "auto", nullptr,
        "joint angles of an arm at the start, rad; auto: those that bring the hand to its place", 255)),
    row<&ArmOptions::adapter>(number_option(
        "adapter", 0, 0, 0.5, "thickness of the plate between the arm's flange and the hand, m")),
    row<&ArmOptions::mount_yaw>(number_option(
        "mount_yaw", 0, -360, 360, "rotation of a hand about the axis of its arm's flange, degrees")));

// By its name or the shorter one.
bool is_own(const HandControlConfig& config, const char* name) {
  return same_name(name, config.robot->name) || (config.robot->alias && same_name(name, config.robot->alias));
}

// Rows of a robot; the number of shapes that it has beside those of the task's own.
int32_t add_rows(const HandControlConfig& config, const char* name, OptionTable& table) {
  if (same_name(name, kNone)) return 0;
  if (is_own(config, name)) {
    add_robot_rows(*config.robot, table);
    return 0;
  }
  const RobotRef ref(find_robot(name));
  add_robot_rows(*ref, table);
  return ref->shapes.count;
}

// The place of a hand in the base frame, of the side that it is on.
Pose palm_in_base(const Robot& robot, Side side, bool folded) {
  double q[kMaxRobotLinks];
  const Table<double>& start = folded && robot.poses.folded.count ? robot.poses.folded : robot.home;
  for (int32_t i = 0; i < robot.links.count; ++i) q[i] = start_angle(robot, start, i);
  if (side == Side::kRight) return robot.X_BR * palm_frame(robot, q);
  const RobotCopy left = make_mirrored(robot);
  return robot.X_BR * palm_frame(left.robot(), q);
}

// How far beyond the holding point the fingers go, m.
double finger_length(const Robot& robot) {
  double q[kMaxRobotLinks];
  for (int32_t i = 0; i < robot.links.count; ++i) q[i] = start_angle(robot, {}, i);
  const Pose X_HR = inverse(palm_frame(robot, q));
  double most = 0;
  for (int32_t f = 0; f < robot.fingers.count; ++f)
    if (!robot.fingers[f].thumb)
      most = std::max(most, (X_HR * (link_pose(robot, q, robot.tips[f].link) * robot.tips[f].p_L)).z);
  return most;
}

// `count` numbers, separated by blanks or commas.
void read_numbers(const char* key, const char* text, int32_t count, double* out) {
  const char *at = text, *const end = text + std::strlen(text);
  for (int32_t i = 0; i < count; ++i) {
    while (at < end && (*at == ' ' || (i > 0 && *at == ','))) ++at;
    const auto [next, error] = from_chars(at, end, out[i]);
    if (error != std::errc() || !(std::abs(out[i]) <= 1000))
      fail(Code::kArgument, "%s: '%s' is neither auto nor %d numbers", key, Quoted(text).text, count);
    at = next;
  }
  if (at != end)
    fail(Code::kArgument, "%s: '%s' is neither auto nor %d numbers", key, Quoted(text).text, count);
}

// "x y z yaw": m and degrees.
Pose read_base(const char* key, const char* text) {
  double v[4];
  read_numbers(key, text, 4, v);
  return {{v[0], v[1], v[2]}, axis_angle({0, 0, 1}, v[3] * kDegree)};
}

// The text for a hand alone, else the common one.
const char* own_text(const char* own, const char* common) {
  return *own ? own : common;
}

// From where an arm comes to a hand with this palm: from behind the fingers, or where those point up or down
// from behind the palm.
Vec3 side_of_arm(const Pose& X_WH) {
  const Vec3 behind = -rotate(X_WH.q, {0, 0, 1}), back = rotate(X_WH.q, {0, 1, 0});
  return behind.x * behind.x + behind.y * behind.y > 0.25 ? behind : back;
}

void mount(const Options& o, int32_t i, const char* name, ChosenHand* out) {
  out->arm = RobotRef(find_robot(name));
  const Robot &arm = *out->arm, &hand = out->robot();
  RobotCopy mirrored;
  const bool left = out->side == Side::kLeft;
  if (left) mirrored = make_mirrored(hand);
  const SideOptions own = kSideRows[i].read(o);
  const ArmOptions common = kArmRows.read(o);
  const Mounting mounting{common.mount_yaw * kDegree, common.adapter};
  RobotCopy both = make_mounted(arm, left ? mirrored.robot() : hand, mounting);
  const Pose X_WR = out->X_WB * hand.X_BR;
  const Pose X_WF = X_WR * inverse(mounted_root(left ? mirrored.robot() : hand, mounting));
  const char *base = own_text(own.arm_base, common.arm_base), *pose = own_text(own.arm_pose, common.arm_pose);
  const char* base_key = kSideRows[i].of<&SideOptions::arm_base>().key;
  out->X_WF = X_WF;
  out->from = side_of_arm(out->X_WB * palm_in_base(hand, out->side, false));
  out->given = !same_name(base, "auto");
  out->chosen = same_name(pose, "auto");
  Pose X_WB = out->X_WB;
  double q[kMaxRobotLinks];
  if (out->given) X_WB = read_base(base_key, base);
  if (!out->chosen) {
    read_numbers(kSideRows[i].of<&SideOptions::arm_pose>().key, pose, arm.links.count, q);
    for (int32_t k = 0; k < arm.links.count; ++k)
      q[k] = std::clamp(q[k], arm.links[k].lower, arm.links[k].upper);
    // without a place of its own it stands where that pose brings the hand to its place
    if (!out->given) X_WB = X_WF * inverse(flange_pose(arm, q));
  } else if (out->given) {
    const Vector<ArmPlace> poses = arm_poses(arm, X_WF, X_WB);
    if (poses.empty())
      fail(Code::kUnsupported,
           "%s: from there %s cannot bring the %s hand to its place, that is, its flange to (%.3g, %.3g, "
           "%.3g)",
           base_key, arm.name, kSideNames[i], X_WF.p.x, X_WF.p.y, X_WF.p.z);
    std::copy_n(poses[0].q, arm.links.count, q);
  } else if (!place_arm(arm, X_WF, out->from, &X_WB, q)) {
    fail(Code::kUnsupported,
         "%s: no place was found from which %s reaches (%.3g, %.3g, %.3g); set this option", base_key,
         arm.name, X_WF.p.x, X_WF.p.y, X_WF.p.z);
  }
  out->mounted = std::move(both);
  out->armed = true;
  out->side = Side::kRight;
  set_arm(X_WB, q, out);
}

}  // namespace

const char* const kSideNames[kMaxHands] = {"right", "left"};

void set_arm(const Pose& X_WB, const double* q, ChosenHand* hand) {
  hand->X_WB = X_WB;
  for (int32_t k = 0; k < hand->arm->links.count; ++k) {
    hand->mounted.home[static_cast<size_t>(k)] = q[k];
    if (!hand->mounted.folded.empty()) hand->mounted.folded[static_cast<size_t>(k)] = q[k];
  }
  hand->mounted.bind();
}

int32_t add_hand_choice_options(const HandControlConfig& config, OptionTable& table) {
  table.add(kRows.with<&ChoiceOptions::hand>(config.robot->name));
  const auto side = [&](int32_t i) { return config.sides ? config.sides[i] : HandDefault{"", "", "", ""}; };
  for (int32_t i = 0; i < config.count; ++i) {
    const HandDefault d = side(i);
    table.add(kSideRows[i]
                  .with<&SideOptions::hand>(d.hand)
                  .with<&SideOptions::arm>(d.arm)
                  .with<&SideOptions::arm_base>(d.arm_base)
                  .with<&SideOptions::arm_pose>(d.arm_pose));
  }
  table.add(kArmRows);
  // the host's word for this side, the task's, the host's for both, the task's robot
  const auto chosen = [&](const OptionSpec& side, const char* own, const OptionSpec& common,
                          const char* otherwise) {
    for (const char* name : {table.choice(side.key), own, table.choice(common.key)})
      if (*name) return name;
    return otherwise;
  };
  int32_t shapes = 0;
  for (int32_t i = 0; i < config.count; ++i) {
    const char* hand = chosen(kSideRows[i].of<&SideOptions::hand>(), side(i).hand,
                              kRows.of<&ChoiceOptions::hand>(), config.robot->name);
    const char* arm =
        chosen(kSideRows[i].of<&SideOptions::arm>(), side(i).arm, kRows.of<&ChoiceOptions::arm>(), kNone);
    shapes += add_rows(config, hand, table);
    shapes += add_rows(config, arm, table);
  }
  add_robot_scales(table);
  return shapes;
}

ChosenHand choose_hand(const HandControlConfig& config, const Options& o, int32_t i) {
  const ChoiceOptions common = kRows.read(o);
  const SideOptions own = kSideRows[i].read(o);
  const char *name = own_text(own.hand, common.hand), *arm = own_text(own.arm, common.arm);
  ChosenHand out;
  if (is_own(config, name))
    out.own = config.robot;
  else
    out.listed = RobotRef(find_robot(name));
  const Robot& robot = out.robot();
  if (robot.kind != RobotKind::kHand)
    fail(Code::kUnsupported, "%s: robot %s is not a hand", kSideRows[i].of<&SideOptions::hand>().key,
         robot.name);
  const bool copied = i > 0 && left_is_copied(o);
  out.side = i == 0 || copied ? Side::kRight : Side::kLeft;
  const bool armed = !same_name(arm, kNone);
  out.X_WB = armed && config.armed_bases ? config.armed_bases[i] : config.bases[i];
  if (!out.own) {
    const double longer = finger_length(robot) - finger_length(*config.robot);
    const Pose back = {{0, 0, config.facing ? -std::max(longer, 0.0) : 0}, {}};
    out.X_WB = out.X_WB * palm_in_base(*config.robot, out.side, config.folded) * back *
               inverse(palm_in_base(robot, out.side, config.folded));
  }
  if (armed) mount(o, i, arm, &out);
  return out;
}

}  // namespace rdm

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

constexpr OptionSpec choosing(OptionSpec row) {
  row.chooses = true;
  return row;
}

constexpr OptionSpec kRows[] = {
    choosing(basic(text_option("arm", kNone, nullptr,
                               "the arm that carries each hand, a robot's name; none: as the task has it"))),
};
constexpr OptionSpec kArmRows[] = {
    text_option("arm_base", "auto", nullptr,
                "where an arm's base is: x y z (m) and yaw (degrees); auto: behind the hand, within reach"),
    text_option("arm_pose", "auto", nullptr,
                "an arm's joints at the start, rad; auto: those that bring the hand to its place", 255),
    number_option("adapter", 0, 0, 0.5, "thickness of the plate between flange and hand, m"),
    number_option("mount_yaw", 0, -360, 360, "turn of a hand about its arm's flange, degrees"),
};

const char* const kSideKeys[kMaxHands][2] = {{"right.hand", "right.arm"}, {"left.hand", "left.arm"}};
const char* const kBaseKeys[kMaxHands] = {"right.arm_base", "left.arm_base"};
const char* const kPoseKeys[kMaxHands] = {"right.arm_pose", "left.arm_pose"};
const char* const kKeys[2] = {"hand", "arm"};

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

// The text for hand i: its own key's, else the common one's.
const char* own_text(const Options& o, const char* own, const char* common) {
  const char* text = o.text(own);
  return *text ? text : o.text(common);
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
  const Mounting mounting{o.number("mount_yaw") * kDegree, o.number("adapter")};
  RobotCopy both = make_mounted(arm, left ? mirrored.robot() : hand, mounting);
  const Pose X_WR = out->X_WB * hand.X_BR;
  const Pose X_WF = X_WR * inverse(mounted_root(left ? mirrored.robot() : hand, mounting));
  const char *base = own_text(o, kBaseKeys[i], "arm_base"), *pose = own_text(o, kPoseKeys[i], "arm_pose");
  out->X_WF = X_WF;
  out->from = side_of_arm(out->X_WB * palm_in_base(hand, out->side, false));
  out->given = !same_name(base, "auto");
  out->chosen = same_name(pose, "auto");
  Pose X_WB = out->X_WB;
  double q[kMaxRobotLinks];
  if (out->given) X_WB = read_base(kBaseKeys[i], base);
  if (!out->chosen) {
    read_numbers(kPoseKeys[i], pose, arm.links.count, q);
    for (int32_t k = 0; k < arm.links.count; ++k)
      q[k] = std::clamp(q[k], arm.links[k].lower, arm.links[k].upper);
    // without a place of its own it stands where that pose brings the hand to its place
    if (!out->given) X_WB = X_WF * inverse(flange_pose(arm, q));
  } else if (out->given) {
    const Vector<ArmPlace> poses = arm_poses(arm, X_WF, X_WB);
    if (poses.empty())
      fail(Code::kUnsupported,
           "%s: from there %s does not bring the %s hand to its place, its flange to (%.3g, %.3g, %.3g)",
           kBaseKeys[i], arm.name, kSideNames[i], X_WF.p.x, X_WF.p.y, X_WF.p.z);
    std::copy_n(poses[0].q, arm.links.count, q);
  } else if (!place_arm(arm, X_WF, out->from, &X_WB, q)) {
    fail(Code::kUnsupported, "%s: no place was found from which %s reaches (%.3g, %.3g, %.3g); give one",
         kBaseKeys[i], arm.name, X_WF.p.x, X_WF.p.y, X_WF.p.z);
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
  table.add(choosing(
      basic(text_option("hand", config.robot->name, nullptr, "the robot that each hand is, by name"))));
  table.add(kRows);
  const auto side = [&](int32_t i) { return config.sides ? config.sides[i] : HandDefault{"", "", "", ""}; };
  for (int32_t i = 0; i < config.count; ++i) {
    const HandDefault d = side(i);
    table.add(choosing(
        text_option(kSideKeys[i][0], d.hand, nullptr, "the same for this hand alone; empty: as hand")));
    table.add(choosing(
        text_option(kSideKeys[i][1], d.arm, nullptr, "the same for this hand alone; empty: as arm")));
    table.add(
        text_option(kBaseKeys[i], d.arm_base, nullptr, "the same for this hand alone; empty: as arm_base"));
    table.add(text_option(kPoseKeys[i], d.arm_pose, nullptr,
                          "the same for this hand alone; empty: as arm_pose", 255));
  }
  table.add(kArmRows);
  // the host's word for this side, the task's, the host's for both, the task's robot
  const auto chosen = [&](int32_t i, int what, const char* own, const char* otherwise) {
    for (const char* name : {table.choice(kSideKeys[i][what]), own, table.choice(kKeys[what])})
      if (*name) return name;
    return otherwise;
  };
  int32_t shapes = 0;
  for (int32_t i = 0; i < config.count; ++i) {
    shapes += add_rows(config, chosen(i, 0, side(i).hand, config.robot->name), table);
    shapes += add_rows(config, chosen(i, 1, side(i).arm, kNone), table);
  }
  add_robot_scales(table);
  return shapes;
}

ChosenHand choose_hand(const HandControlConfig& config, const Options& o, int32_t i) {
  const char *name = own_text(o, kSideKeys[i][0], kKeys[0]), *arm = own_text(o, kSideKeys[i][1], kKeys[1]);
  ChosenHand out;
  if (is_own(config, name))
    out.own = config.robot;
  else
    out.listed = RobotRef(find_robot(name));
  const Robot& robot = out.robot();
  if (robot.kind != RobotKind::kHand)
    fail(Code::kUnsupported, "%s: robot %s is no hand", kSideKeys[i][0], robot.name);
  const bool copied = i > 0 && same_name(o.text("left_model"), "right_copy");
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

#include "tasks/hand/hands.hpp"

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "env/options/robot.hpp"
#include "robot/override.hpp"

namespace rdm {
namespace {

constexpr OptionSpec kRows[] = {
    text_option("coupling", "model", "model|paper",
                "distal joints: 1.142 of the middle one within 0.142 rad, or (paper) the middle one's angle"),
};

constexpr OptionSpec kLeftRows[] = {
    text_option("left_model", "mirror", "mirror|right_copy",
                "left hand: mirror image, or a second right hand"),
};

}  // namespace

void add_hand_options(const Robot& robot, OptionTable& table) {
  table.add(kRows);
  add_robot_options(robot, table);
}

void add_left_hand_options(OptionTable& table) {
  table.add(kLeftRows);
}

ArticulationDef make_hand(const Robot& robot, const Options& options, Side side, const Pose& X_WB,
                          int32_t material) {
  const char* prefix = side == Side::kLeft ? "left_" : "right_";
  if (side == Side::kLeft && same_name(options.text("left_model"), "right_copy")) side = Side::kRight;
  ArticulationDef def = make_articulation(robot, side, X_WB, prefix);
  if (same_name(options.text("coupling"), "paper"))
    for (LinkDef& link : def.links)
      if (link.joint.coupled_to >= 0) {
        link.joint.ratio = 1;
        link.joint.slack = 0;
      }
  apply_robot_options(options, robot, prefix, &def);
  set_material(&def, material);
  return def;
}

Hand find_hand(const Robot& robot, const Scene& scene, int32_t articulation) {
  if (robot.links.count > kMaxHandJoints || robot.tips.count > kMaxHandTips)
    fail(Code::kUnsupported, "robot %s: %d joints and %d fingertips, a hand has at most %d and %d",
         robot.name, robot.links.count, robot.tips.count, kMaxHandJoints, kMaxHandTips);
  if (robot.tips.count == 0 || robot.fingers.count != robot.tips.count || robot.palm == kNoLink)
    fail(Code::kUnsupported, "robot %s: a hand has a palm, and a tip for each finger", robot.name);
  Hand h;
  h.robot = &robot;
  h.articulation = articulation;
  h.first = scene.link_offset[static_cast<size_t>(articulation)];
  h.num_joints = robot.links.count;
  h.num_actions = robot.num_actuated();
  h.num_tips = robot.tips.count;
  for (int32_t i = 0; i < h.num_joints; ++i) {
    const JointDef& j = scene.link(h.first + i).joint;
    h.lower[i] = j.lower;
    h.upper[i] = j.upper;
    h.effort[i] = std::numeric_limits<double>::infinity();
  }
  for (int32_t i = 0; i < h.num_actions; ++i) {
    const int32_t joint = robot.actuated(i);
    h.actuated[i] = h.first + joint;
    h.act_lower[i] = h.lower[joint];
    h.act_upper[i] = h.upper[joint];
    const double effort = scene.link(h.actuated[i]).joint.effort;
    if (effort > 0) h.effort[joint] = effort;
  }
  for (int32_t i = 0; i < h.num_tips; ++i) {
    h.tips[i] = h.first + robot.tips[i].link;
    const auto sensor = std::find(scene.sensors.begin(), scene.sensors.end(), h.tips[i]);
    h.sensors[i] = static_cast<int32_t>(sensor - scene.sensors.begin());
  }
  return h;
}

void draw_joints(const JointNoise& noise, const Hand* hands, int32_t count, World& world, Stream& stream) {
  double u[kMaxHandJoints], q[kMaxHandJoints];
  const double zero[kMaxHandJoints] = {};
  const double* start = noise.start ? noise.start : zero;
  for (int32_t h = 0; h < count; ++h) {
    const Hand& hand = hands[h];
    if (h == 0 || !noise.literal)
      for (int32_t i = 0; i < hand.num_joints; ++i)
        u[i] = noise.literal ? stream.signed_unit() : stream.uniform();
    for (int32_t i = 0; i < hand.num_joints; ++i) {
      const JointDef& j = world.scene().link(hand.first + i).joint;
      q[i] = start[i] + noise.level * (j.lower + (j.upper - j.lower) * u[i]);
      if (j.coupled_to >= 0) q[i] = j.ratio * q[j.coupled_to];  // a parent stands before its children
      q[i] = std::clamp(q[i], j.lower, j.upper);
    }
    world.set_joints(hand.articulation, q, zero);
    std::copy(q, q + hand.num_joints, world.target() + hand.first);
  }
}

void command_hand(const Hand& hand, const double* command, World& world) {
  double angle[kMaxHandJoints];
  for (int32_t i = 0; i < hand.num_actions; ++i) {
    const double lower = hand.act_lower[i], upper = hand.act_upper[i];
    const double a = to_angle(lower, upper, command[i]);
    const double above = a < lower ? lower : a;
    angle[i] = upper < above ? upper : above;
  }
  double* target = world.target();
  for (int32_t i = 0; i < hand.num_actions; ++i) target[hand.actuated[i]] = angle[i];
}

}  // namespace rdm

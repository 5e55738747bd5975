#include "tasks/hand/hands.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "base/error.hpp"
#include "env/options/robot.hpp"
#include "robot/override.hpp"

namespace rdm {
namespace {

struct CouplingOptions {
  bool paper;
};
constexpr auto kRows = row<&CouplingOptions::paper, false, true>(legacy(text_option(
    "coupling", "model", "model|paper",
    "distal joint angle: model: 1.142 times the middle joint's, within 0.142 rad; paper: the same as it")));

struct LeftOptions {
  bool right_copy;
};
constexpr auto kLeftRows = row<&LeftOptions::right_copy, false, true>(
    legacy(text_option("left_model", "mirror", "mirror|right_copy",
                       "left hand: mirror image of the right one, or a second right hand")));

}  // namespace

void add_hand_options(OptionTable& table) {
  table.add(kRows);
}

void add_left_hand_options(OptionTable& table) {
  table.add(kLeftRows);
}

bool left_is_copied(const Options& options) {
  return options.knows(kLeftRows.specs[0].key) && kLeftRows.read(options).right_copy;
}

ArticulationDef make_hand(const ChosenHand& chosen, const Options& options, int32_t i, int32_t first,
                          int32_t material, DynamicsDraws* draws) {
  const Robot& robot = chosen.robot();
  char prefix[16];
  std::snprintf(prefix, sizeof prefix, "%s_", kSideNames[i]);
  ArticulationDef def = make_articulation(robot, chosen.side, chosen.X_WB, prefix);
  if (kRows.read(options).paper)
    for (LinkDef& link : def.links)
      if (link.joint.coupled_to >= 0 && link.joint.slack > 0) {  // tendons; belts and gears have no slack
        link.joint.ratio = 1;
        link.joint.slack = 0;
      }
  apply_robot_options(options, robot, prefix, i, first, &def, draws);
  set_material(&def, material);
  return def;
}

double Hand::command(int32_t action, double q) const {
  const RobotCurve* curve = robot->curve(joint(action));
  return curve ? curve->inverse(q) : to_action(act_lower[action], act_upper[action], q);
}

double Hand::angle(int32_t action, double a) const {
  const RobotCurve* curve = robot->curve(joint(action));
  return curve ? curve->at(a) : to_angle(act_lower[action], act_upper[action], a);
}

Hand find_hand(const Robot& robot, const Scene& scene, int32_t articulation) {
  if (robot.links.count > kMaxHandJoints || robot.tips.count > kMaxHandTips)
    fail(Code::kUnsupported,
         "robot %s: it has %d joints and %d fingertips, but a hand may have at most %d and %d", robot.name,
         robot.links.count, robot.tips.count, kMaxHandJoints, kMaxHandTips);
  if (robot.tips.count == 0 || robot.fingers.count != robot.tips.count || robot.palm == kNoLink)
    fail(Code::kUnsupported, "robot %s: a hand must have a palm, and a tip for each finger", robot.name);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Hand h;
  h.robot = &robot;
  h.articulation = articulation;
  h.first = scene.link_offset[static_cast<size_t>(articulation)];
  h.num_joints = robot.links.count;
  h.num_actions = robot.num_actuated();
  h.num_tips = robot.tips.count;
  h.arm_joints = robot.arm_links;
  h.arm_actions = robot.arm_commands;
  double strongest = 0;
  for (int32_t i = 0; i < h.num_joints; ++i) {
    const JointDef& j = scene.link(h.first + i).joint;
    h.lower[i] = j.lower;
    h.upper[i] = j.upper;
    h.effort[i] = kInfinity;
    if (i >= h.arm_joints) strongest = std::max(strongest, j.effort);
  }
  // so that a joint at its bound is within that of observations
  for (double most = 5; strongest > most && h.torque_scale > 1e-4; most *= 10) h.torque_scale /= 10;
  for (int32_t i = 0; i < h.num_actions; ++i) {
    const int32_t joint = robot.actuated(i);
    h.actuated[i] = h.first + joint;
    h.act_lower[i] = h.lower[joint];
    h.act_upper[i] = h.upper[joint];
    const double effort = scene.link(h.actuated[i]).joint.effort;
    if (effort > 0) h.effort[joint] = effort;
    const double velocity = robot.links[joint].velocity;
    h.rate[i] = velocity > 0 ? velocity * scene.control_dt() : kInfinity;
    h.rated = h.rated || velocity > 0;
  }
  for (const RobotCurve& c : robot.curves) {
    h.driver[h.num_curves] = robot.action_of(c.driver);
    h.curves[h.num_curves++] = &c;
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
  for (int32_t h = 0; h < count; ++h) {
    const Hand& hand = hands[h];
    const double* start = noise.start[h] ? noise.start[h] : zero;
    if (h == 0 || !noise.literal || hand.num_joints != hands[0].num_joints)
      for (int32_t i = 0; i < hand.num_joints; ++i)
        u[i] = noise.literal ? stream.signed_unit() : stream.uniform();
    for (int32_t i = 0; i < hand.num_joints; ++i) {
      const JointDef& j = world.scene().link(hand.first + i).joint;
      if (i < hand.arm_joints)
        q[i] = start[i] + noise.arm * (noise.literal ? u[i] : 2 * u[i] - 1);
      else
        q[i] = start[i] + noise.level * (j.lower + (j.upper - j.lower) * u[i]);
      q[i] = std::clamp(q[i], noise.low[h] ? noise.low[h][i] : j.lower,
                        noise.high[h] ? noise.high[h][i] : j.upper);
    }
    for (int32_t i = 0; i < hand.num_curves; ++i) {
      const RobotCurve& c = *hand.curves[i];
      q[c.link] = c.at(hand.command(hand.driver[i], q[c.driver]));
    }
    for (int32_t i = 0; i < hand.num_joints; ++i) {
      const JointDef& j = world.scene().link(hand.first + i).joint;
      if (j.coupled_to >= 0) q[i] = std::clamp(j.ratio * q[j.coupled_to], j.lower, j.upper);
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
  if (hand.num_curves > 0)
    for (int32_t i = 0; i < hand.num_curves; ++i) {
      const RobotCurve& c = *hand.curves[i];
      const double a = c.at(command[hand.driver[i]]);
      if (c.driver == c.link)
        angle[hand.driver[i]] = a;
      else
        target[hand.first + c.link] = a;
    }
  if (hand.rated)
    for (int32_t i = 0; i < hand.num_actions; ++i) {
      const double before = target[hand.actuated[i]];
      angle[i] = std::clamp(angle[i], before - hand.rate[i], before + hand.rate[i]);
    }
  for (int32_t i = 0; i < hand.num_actions; ++i) target[hand.actuated[i]] = angle[i];
}

}  // namespace rdm

#include "tasks/hand/hands.hpp"

#include <algorithm>
#include <limits>

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

void add_hand_options(OptionTable& table) {
  table.add(kRows);
  add_robot_options(kShadowHand, table);
}

void add_left_hand_options(OptionTable& table) {
  table.add(kLeftRows);
}

ArticulationDef make_hand(const Options& options, Side side, const Pose& X_WB, int32_t material) {
  const char* prefix = side == Side::kLeft ? "left_" : "right_";
  if (side == Side::kLeft && same_name(options.text("left_model"), "right_copy")) side = Side::kRight;
  ArticulationDef def = make_articulation(kShadowHand, side, X_WB, prefix);
  if (same_name(options.text("coupling"), "paper"))
    for (LinkDef& link : def.links)
      if (link.joint.coupled_to >= 0) {
        link.joint.ratio = 1;
        link.joint.slack = 0;
      }
  apply_robot_options(options, kShadowHand, prefix, &def);
  set_material(&def, material);
  return def;
}

Hand find_hand(const Scene& scene, int32_t articulation) {
  Hand h;
  h.articulation = articulation;
  h.first = scene.link_offset[static_cast<size_t>(articulation)];
  for (int32_t i = 0; i < kHandJoints; ++i) {
    const JointDef& j = scene.link(h.first + i).joint;
    h.lower[i] = j.lower;
    h.upper[i] = j.upper;
    h.effort[i] = std::numeric_limits<double>::infinity();
  }
  for (int32_t i = 0; i < kHandActions; ++i) {
    const int32_t joint = kShadowHand.actuated(i);
    h.actuated[i] = h.first + joint;
    h.act_lower[i] = h.lower[joint];
    h.act_upper[i] = h.upper[joint];
    const double effort = scene.link(h.actuated[i]).joint.effort;
    if (effort > 0) h.effort[joint] = effort;
  }
  for (int32_t i = 0; i < kHandTips; ++i) {
    h.tips[i] = h.first + kShadowHand.tips[i].link;
    const auto sensor = std::find(scene.sensors.begin(), scene.sensors.end(), h.tips[i]);
    h.sensors[i] = static_cast<int32_t>(sensor - scene.sensors.begin());
  }
  return h;
}

void draw_joints(const JointNoise& noise, const Hand* hands, int32_t count, World& world, Stream& stream) {
  double u[kHandJoints], q[kHandJoints];
  const double zero[kHandJoints] = {};
  for (int32_t h = 0; h < count; ++h) {
    const Hand& hand = hands[h];
    if (h == 0 || !noise.literal)
      for (double& draw : u) draw = noise.literal ? stream.signed_unit() : stream.uniform();
    for (int32_t i = 0; i < kHandJoints; ++i) {
      const JointDef& j = world.scene().link(hand.first + i).joint;
      q[i] = noise.start[i] + noise.level * (j.lower + (j.upper - j.lower) * u[i]);
      if (j.coupled_to >= 0) q[i] = j.ratio * q[j.coupled_to];  // a parent stands before its children
      q[i] = std::clamp(q[i], j.lower, j.upper);
    }
    world.set_joints(hand.articulation, q, zero);
    std::copy(q, q + kHandJoints, world.target() + hand.first);
  }
}

void command_hand(const Hand& hand, const double* command, World& world) {
  double angle[kHandActions];
  for (int32_t i = 0; i < kHandActions; ++i) {
    const double lower = hand.act_lower[i], upper = hand.act_upper[i];
    const double a = to_angle(lower, upper, command[i]);
    const double above = a < lower ? lower : a;
    angle[i] = upper < above ? upper : above;
  }
  double* target = world.target();
  for (int32_t i = 0; i < kHandActions; ++i) target[hand.actuated[i]] = angle[i];
}

}  // namespace rdm

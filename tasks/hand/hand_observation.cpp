#include "tasks/hand/hand_observation.hpp"

#include <algorithm>
#include <cstdio>

namespace rdm {
namespace {

struct TipForce {
  const Wrench& wrench;
  double scale;
};

constexpr FieldEntry<Motion> kTips[] = {
    {"tip_position", "m", 3, [](const Motion& m, float* out) { put(m.X.p, out); }},
    {"tip_rotation", "1", 4, [](const Motion& m, float* out) { put(m.X.q, out); }},
    {"tip_velocity", "m/s", 3, [](const Motion& m, float* out) { put(m.v, out); }},
    {"tip_spin", "rad/s", 3, [](const Motion& m, float* out) { put(m.w, out); }},
};

constexpr FieldEntry<TipForce> kSensors[] = {
    {"tip_force", "0.1 N", 3, [](const TipForce& f, float* out) { put(f.wrench.force, out, f.scale); }},
    {"tip_torque", "0.1 N m", 3, [](const TipForce& f, float* out) { put(f.wrench.torque, out, f.scale); }},
};

constexpr FieldEntry<HandView> kBase[] = {
    {"base_position", "m", 3, [](const HandView& v, float* out) { put(v.base->X.p, out); }},
    {"base_angles", "rad", 3,
     [](const HandView& v, float* out) { put(roll_pitch_yaw(v.base->X.q, v.signed_angles), out); }},
};

template <class From, size_t n>
void add_entries(FieldTable& table, const char* prefix, const char* finger,
                 const FieldEntry<From> (&entries)[n]) {
  for (const auto& e : entries) {
    char name[kNameSize];
    std::snprintf(name, sizeof name, "%s%s%s", finger ? finger : "", finger ? "_" : "", e.name);
    add_field(table, prefix, name, e.unit, e.count);
  }
}

}  // namespace

void add_joint_fields(const Hand& hand, FieldTable& table, const char* prefix) {
  if (hand.arm_joints > 0) {
    add_field(table, prefix, "arm_position", "1", hand.arm_joints);
    add_field(table, prefix, "arm_velocity", "rad/s", hand.arm_joints);
    add_field(table, prefix, "arm_effort", "1", hand.arm_joints);
  }
  const int32_t joints = hand.hand_joints();
  add_field(table, prefix, "joint_position", "1", joints);
  add_field(table, prefix, "joint_velocity", "5 rad/s", joints);
  const double unit = 1 / hand.torque_scale;
  add_field(table, prefix, "joint_force",
            unit < 0.5   ? "0.1 N m"
            : unit < 5   ? "1 N m"
            : unit < 50  ? "10 N m"
            : unit < 500 ? "100 N m"
                         : "1000 N m",
            joints);
}

void add_tip_fields(const Hand& hand, FieldTable& table, const char* prefix) {
  for (const RobotFinger& finger : hand.robot->fingers) add_entries(table, prefix, finger.name, kTips);
  for (const RobotFinger& finger : hand.robot->fingers) add_entries(table, prefix, finger.name, kSensors);
}

void add_action_field(const Hand& hand, FieldTable& table, const char* prefix, bool base) {
  add_field(table, prefix, "action", "1", hand.num_entries() + (base ? kBaseActions : 0), -1, 1);
}

void add_hand_fields(const Hand& hand, FieldTable& table, const char* prefix, bool base) {
  add_joint_fields(hand, table, prefix);
  add_tip_fields(hand, table, prefix);
  if (base) add_entries(table, prefix, nullptr, kBase);
  add_action_field(hand, table, prefix, base);
}

namespace {

// Positions in their range, rad/s, shares of the effort.
float* write_arm(const HandView& view, float* out) {
  const Hand& hand = view.hand;
  const int32_t joints = hand.arm_joints;
  const double *q = view.world.q() + hand.first, *qd = view.world.qd() + hand.first,
               *torque = view.world.torque() + hand.first;
  for (int32_t i = 0; i < joints; ++i)
    out[i] = static_cast<float>(to_action(hand.lower[i], hand.upper[i], q[i]));
  for (int32_t i = 0; i < joints; ++i) out[joints + i] = static_cast<float>(qd[i]);
  for (int32_t i = 0; i < joints; ++i) out[2 * joints + i] = static_cast<float>(torque[i] / hand.effort[i]);
  return out + 3 * joints;
}

}  // namespace

float* write_joints(const HandView& view, float* out) {
  const Hand& hand = view.hand;
  if (hand.arm_joints > 0) out = write_arm(view, out);
  const int32_t joints = hand.hand_joints(), first = hand.first + hand.arm_joints;
  const double *lower = hand.lower + hand.arm_joints, *upper = hand.upper + hand.arm_joints;
  const double *q = view.world.q() + first, *qd = view.world.qd() + first,
               *torque = view.world.torque() + first;
  for (int32_t i = 0; i < joints; ++i) out[i] = static_cast<float>(to_action(lower[i], upper[i], q[i]));
  out += joints;
  for (int32_t i = 0; i < joints; ++i) out[i] = static_cast<float>(0.2 * qd[i]);
  out += joints;
  for (int32_t i = 0; i < joints; ++i) out[i] = static_cast<float>(hand.torque_scale * torque[i]);
  return out + joints;
}

float* write_tips(const HandView& view, float* out) {
  const Hand& hand = view.hand;
  for (int32_t i = 0; i < hand.num_tips; ++i) out = write_fields<kTips>(view.world.link(hand.tips[i]), out);
  const double scale = view.sensor ? 10 : 0;
  for (int32_t i = 0; i < hand.num_tips; ++i)
    out = write_fields<kSensors>(TipForce{view.world.sensor(hand.sensors[i]), scale}, out);
  return out;
}

float* write_action(const HandView& view, float* out) {
  return std::copy_n(view.action, view.hand.num_entries() + (view.base ? kBaseActions : 0), out);
}

float* write_hand(const HandView& view, float* out) {
  out = write_tips(view, write_joints(view, out));
  if (view.base) out = write_fields<kBase>(view, out);
  return write_action(view, out);
}

Vec3 roll_pitch_yaw(const Quat& q, bool signed_angles) {
  const Mat3 R = to_matrix(q);
  Vec3 a{elementary::atan2(R(2, 1), R(2, 2)), elementary::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
         elementary::atan2(R(1, 0), R(0, 0))};
  if (!signed_angles)
    for (int i = 0; i < 3; ++i)
      if (a[i] < 0) a[i] += 2 * kPi;
  return a;
}

}  // namespace rdm

#include "tasks/hand/hand_observation.hpp"

#include <algorithm>
#include <cstdio>

namespace rdm {
namespace {

struct TipForce {
  const Wrench& wrench;
  double scale;
};

constexpr FieldEntry<HandView> kJoints[] = {
    {"joint_position", "1", kHandJoints,
     [](const HandView& v, float* out) {
       const double* q = v.world.q() + v.hand.first;
       for (int i = 0; i < kHandJoints; ++i)
         out[i] = static_cast<float>(to_action(v.hand.lower[i], v.hand.upper[i], q[i]));
     }},
    {"joint_velocity", "5 rad/s", kHandJoints,
     [](const HandView& v, float* out) {
       const double* qd = v.world.qd() + v.hand.first;
       for (int i = 0; i < kHandJoints; ++i) out[i] = static_cast<float>(0.2 * qd[i]);
     }},
    {"joint_force", "0.1 N m", kHandJoints,
     [](const HandView& v, float* out) {
       const double* torque = v.world.torque() + v.hand.first;
       for (int i = 0; i < kHandJoints; ++i) out[i] = static_cast<float>(10 * torque[i]);
     }},
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

constexpr const char* kFingers[kHandTips] = {"ff", "mf", "rf", "lf", "th"};

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

void add_joint_fields(FieldTable& table, const char* prefix) {
  add_entries(table, prefix, nullptr, kJoints);
}

void add_tip_fields(FieldTable& table, const char* prefix) {
  for (const char* finger : kFingers) add_entries(table, prefix, finger, kTips);
  for (const char* finger : kFingers) add_entries(table, prefix, finger, kSensors);
}

void add_action_field(FieldTable& table, const char* prefix, bool base) {
  add_field(table, prefix, "action", "1", base ? kFlyingHandActions : kHandActions);
}

void add_hand_fields(FieldTable& table, const char* prefix, bool base) {
  add_joint_fields(table, prefix);
  add_tip_fields(table, prefix);
  if (base) add_entries(table, prefix, nullptr, kBase);
  add_action_field(table, prefix, base);
}

float* write_joints(const HandView& view, float* out) {
  return write_fields<kJoints>(view, out);
}

float* write_tips(const HandView& view, float* out) {
  for (const int32_t tip : view.hand.tips) out = write_fields<kTips>(view.world.link(tip), out);
  const double scale = view.sensor ? 10 : 0;
  for (const int32_t sensor : view.hand.sensors)
    out = write_fields<kSensors>(TipForce{view.world.sensor(sensor), scale}, out);
  return out;
}

float* write_action(const HandView& view, float* out) {
  return std::copy_n(view.action, view.base ? kFlyingHandActions : kHandActions, out);
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

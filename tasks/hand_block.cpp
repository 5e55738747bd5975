#include "tasks/hand_block.hpp"

#include <cstdio>
#include <cstring>

namespace rdm {
namespace {

// One run of numbers: declared and written by the same row. `tip` counts the fingers.
struct Entry {
  const char* name;
  const char* unit;
  int32_t count;
  void (*write)(const HandView& v, int32_t tip, float* out);
};

constexpr Entry kJoints[] = {
    {"joint_position", "1", kHandJoints,
     [](const HandView& v, int32_t, float* out) {
       const double* q = v.world.q() + v.hand.first;
       for (int i = 0; i < kHandJoints; ++i)
         out[i] = static_cast<float>(to_action(v.hand.lower[i], v.hand.upper[i], q[i]));
     }},
    {"joint_velocity", "5 rad/s", kHandJoints,
     [](const HandView& v, int32_t, float* out) {
       const double* qd = v.world.qd() + v.hand.first;
       for (int i = 0; i < kHandJoints; ++i) out[i] = static_cast<float>(0.2 * qd[i]);
     }},
    {"joint_force", "0.1 N m", kHandJoints,
     [](const HandView& v, int32_t, float* out) {
       const double* torque = v.world.torque() + v.hand.first;
       for (int i = 0; i < kHandJoints; ++i) out[i] = static_cast<float>(10 * torque[i]);
     }},
};

constexpr Entry kTips[] = {
    {"tip_position", "m", 3,
     [](const HandView& v, int32_t tip, float* out) { put(v.world.link(v.hand.tips[tip]).X.p, out); }},
    {"tip_rotation", "1", 4,
     [](const HandView& v, int32_t tip, float* out) { put(v.world.link(v.hand.tips[tip]).X.q, out); }},
    {"tip_velocity", "m/s", 3,
     [](const HandView& v, int32_t tip, float* out) { put(v.world.link(v.hand.tips[tip]).v, out); }},
    {"tip_spin", "rad/s", 3,
     [](const HandView& v, int32_t tip, float* out) { put(v.world.link(v.hand.tips[tip]).w, out); }},
};

constexpr Entry kSensors[] = {
    {"tip_force", "0.1 N", 3,
     [](const HandView& v, int32_t tip, float* out) {
       put(v.world.sensor(v.hand.sensors[tip]).force, out, v.sensor ? 10 : 0);
     }},
    {"tip_torque", "0.1 N m", 3,
     [](const HandView& v, int32_t tip, float* out) {
       put(v.world.sensor(v.hand.sensors[tip]).torque, out, v.sensor ? 10 : 0);
     }},
};

constexpr Entry kAction = {"action", "1", kHandActions, [](const HandView& v, int32_t, float* out) {
                             std::memcpy(out, v.action, sizeof(float) * kHandActions);
                           }};

constexpr const char* kFingers[kHandTips] = {"ff", "mf", "rf", "lf", "th"};

// Visits all entries in order: f(entry, finger or -1).
template <class F>
void each_entry(F&& f) {
  for (const Entry& e : kJoints) f(e, -1);
  for (int32_t tip = 0; tip < kHandTips; ++tip)
    for (const Entry& e : kTips) f(e, tip);
  for (int32_t tip = 0; tip < kHandTips; ++tip)
    for (const Entry& e : kSensors) f(e, tip);
  f(kAction, -1);
}

}  // namespace

void add_hand_fields(FieldTable& table, const char* prefix) {
  each_entry([&](const Entry& e, int32_t tip) {
    char name[kNameSize];
    std::snprintf(name, sizeof name, "%s%s%s", tip < 0 ? "" : kFingers[tip], tip < 0 ? "" : "_", e.name);
    add_field(table, prefix, name, e.unit, e.count);
  });
}

void write_hand(const HandView& view, FieldWriter& out) {
  each_entry([&](const Entry& e, int32_t tip) { e.write(view, tip, out.next(e.count)); });
}

}  // namespace rdm

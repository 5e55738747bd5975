#include "tasks/hand_block.hpp"

#include <cstdio>
#include <cstring>

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

constexpr FieldEntry<HandView> kAction[] = {
    {"action", "1", kHandActions,
     [](const HandView& v, float* out) { std::memcpy(out, v.action, sizeof(float) * kHandActions); }},
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

void add_hand_fields(FieldTable& table, const char* prefix) {
  add_entries(table, prefix, nullptr, kJoints);
  for (const char* finger : kFingers) add_entries(table, prefix, finger, kTips);
  for (const char* finger : kFingers) add_entries(table, prefix, finger, kSensors);
  add_entries(table, prefix, nullptr, kAction);
}

float* write_hand(const HandView& view, float* out) {
  out = write_fields<kJoints>(view, out);
  for (const int32_t tip : view.hand.tips) out = write_fields<kTips>(view.world.link(tip), out);
  const double scale = view.sensor ? 10 : 0;
  for (const int32_t sensor : view.hand.sensors)
    out = write_fields<kSensors>(TipForce{view.world.sensor(sensor), scale}, out);
  return write_fields<kAction>(view, out);
}

}  // namespace rdm

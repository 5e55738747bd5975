// The numbers of a hand in every observation (tasks sections 3.1, 3.2): joints, fingertips, fingertip forces,
// the base where it flies, the previous action.
#pragma once
#include "env/fields.hpp"
#include "tasks/hand/hands.hpp"

namespace rdm {

inline constexpr int kHandBlock = 187, kFlyingHandBlock = 199;
inline constexpr int kBaseActions = 6, kFlyingHandActions = kHandActions + kBaseActions;

// What one hand's entries are made from.
struct HandView {
  const World& world;
  const Hand& hand;
  const float* action;           // [kHandActions], or [kFlyingHandActions] with a base: previous action
  bool sensor = true;            // false: fingertip forces read 0
  const Motion* base = nullptr;  // null: fixed, and not observed
  bool signed_angles = false;    // base angles in [-pi, pi] instead of [0, 2 pi)
};

// The block part by part, for tasks that put something between. Each writer returns the place behind.
void add_joint_fields(FieldTable& table, const char* prefix);
void add_tip_fields(FieldTable& table, const char* prefix);
void add_action_field(FieldTable& table, const char* prefix, bool base);
float* write_joints(const HandView& view, float* out);
float* write_tips(const HandView& view, float* out);
float* write_action(const HandView& view, float* out);

// The whole of it, kHandBlock numbers, with a base kFlyingHandBlock.
void add_hand_fields(FieldTable& table, const char* prefix, bool base = false);
float* write_hand(const HandView& view, float* out);

// Roll, pitch, yaw of a rotation Rz(yaw) Ry(pitch) Rx(roll), rad, each in [0, 2 pi) or, signed, in [-pi, pi].
Vec3 roll_pitch_yaw(const Quat& q, bool signed_angles);

}  // namespace rdm

// The numbers of a hand in every observation, in the order of ReDMan's table B3: joint positions, velocities
// and forces; pose, velocity and spin of each fingertip; force and torque on each; position and angles of the
// base where it flies; the previous action. Of a hand on an arm, the arm's joints come before its own.
// Positions and rotations are the world's. Of the Shadow Hand: 187 numbers on a fixed base, 199 on a flying
// one.
#pragma once
#include "env/fields.hpp"
#include "tasks/hand/hands.hpp"

namespace rdm {

inline constexpr int kBaseActions = 6;  // entries of a flying base: force, torque

// What one hand's entries are made from.
struct HandView {
  const World& world;
  const Hand& hand;
  const float* action;           // [num_entries], with a base [num_entries + 6]: previous action
  bool sensor = true;            // false: fingertip forces read 0
  const Motion* base = nullptr;  // null: fixed, and not observed
  bool signed_angles = false;    // base angles in [-pi, pi] instead of [0, 2 pi)
};

// The numbers part by part, for tasks that put something between. Each writer returns the place behind.
void add_joint_fields(const Hand& hand, FieldTable& table, const char* prefix);
void add_tip_fields(const Hand& hand, FieldTable& table, const char* prefix);
void add_action_field(const Hand& hand, FieldTable& table, const char* prefix, bool base);
float* write_joints(const HandView& view, float* out);
float* write_tips(const HandView& view, float* out);
float* write_action(const HandView& view, float* out);

// The whole of it.
void add_hand_fields(const Hand& hand, FieldTable& table, const char* prefix, bool base = false);
float* write_hand(const HandView& view, float* out);

// Roll, pitch, yaw of a rotation Rz(yaw) Ry(pitch) Rx(roll), rad, each in [0, 2 pi) or, signed, in [-pi, pi].
Vec3 roll_pitch_yaw(const Quat& q, bool signed_angles);

}  // namespace rdm

// The 187 numbers of a fixed hand in every observation (tasks section 3.1): joints, fingertips, fingertip
// forces, previous action.
#pragma once
#include "env/fields.hpp"
#include "tasks/hands.hpp"

namespace rdm {

inline constexpr int kHandBlock = 187;

// What one hand's entries are made from.
struct HandView {
  const World& world;
  const Hand& hand;
  const float* action;  // [kHandActions] previous action
  bool sensor = true;   // false: fingertip forces read 0
};

void add_hand_fields(FieldTable& table, const char* prefix);
// Returns the place behind the block.
float* write_hand(const HandView& view, float* out);

}  // namespace rdm

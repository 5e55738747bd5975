// A policy whose network is in groups: each is a network of its own, that sees its own entries of the row and gives its
// own entries of the action. Each may be the policy of another machine, or of another agent of a team. With a memory
// each has a GRU of its own; the state of a row is theirs, one behind the other.
#pragma once
#include "nn/gru.hpp"

namespace rdm {

inline constexpr int32_t kMaxGroups = 32;
inline constexpr int32_t kGroupNameSize = 32;

struct ActorGroup {
  char name[kGroupNameSize] = "";
  MlpShape shape;  // in: entries that it sees; out: its actions, twice as many with state_std
  GruShape gru;    // before its last layer; units 0: none
  const int32_t* columns = nullptr;  // [shape.in] entries of the row, ascending; null: all of them
  int32_t first = 0, count = 0;      // entries of the action
  size_t offset = 0;                 // of its parameters among those of all groups

  RecurrentShape net() const { return {shape, gru}; }
};

// Of all groups together.
inline size_t group_params(const ActorGroup* groups, int32_t count) {
  return count == 0 ? 0 : groups[count - 1].offset + groups[count - 1].net().num_params();
}

// Outputs of one group [rows][shape.out] into those of all [rows][width], and back: means at `first`, and with two
// halves log deviations `half` further on.
inline void spread_outputs(const ActorGroup& g, const float* part, int32_t rows, size_t width, float* y) {
  const auto out = static_cast<size_t>(g.shape.out), count = static_cast<size_t>(g.count);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i, part += out, y += width) {
    std::copy_n(part, count, y + g.first);
    if (out > count) std::copy_n(part + count, count, y + width / 2 + static_cast<size_t>(g.first));
  }
}
inline void gather_outputs(const ActorGroup& g, const float* y, int32_t rows, size_t width, float* part) {
  const auto out = static_cast<size_t>(g.shape.out), count = static_cast<size_t>(g.count);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i, part += out, y += width) {
    std::copy_n(y + g.first, count, part);
    if (out > count) std::copy_n(y + width / 2 + static_cast<size_t>(g.first), count, part + count);
  }
}

// States of one group [rows][units] out of those of all [rows][all], of which they begin with entry `at`, and back.
inline void take_states(const float* all, size_t width, size_t at, size_t units, int32_t rows, float* own) {
  for (int32_t i = 0; i < rows; ++i, own += units, all += width) std::copy_n(all + at, units, own);
}
inline void give_states(const float* own, size_t width, size_t at, size_t units, int32_t rows, float* all) {
  for (int32_t i = 0; i < rows; ++i, own += units, all += width) std::copy_n(own, units, all + at);
}

}  // namespace rdm

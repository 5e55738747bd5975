// A policy whose network is in groups: each is a network of its own, that sees its own entries of the row and gives its
// own entries of the action. Each may be the policy of another machine, or of another agent of a team.
#pragma once
#include "nn/mlp.hpp"

namespace rdm {

inline constexpr int32_t kMaxGroups = 32;
inline constexpr int32_t kGroupNameSize = 32;

struct ActorGroup {
  char name[kGroupNameSize] = "";
  MlpShape shape;  // in: entries that it sees; out: its actions, twice as many with state_std
  const int32_t* columns = nullptr;  // [shape.in] entries of the row, ascending; null: all of them
  int32_t first = 0, count = 0;      // entries of the action
  size_t offset = 0;                 // of its parameters among those of all groups
};

// Of all groups together.
inline size_t group_params(const ActorGroup* groups, int32_t count) {
  return count == 0 ? 0 : groups[count - 1].offset + groups[count - 1].shape.num_params();
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

}  // namespace rdm

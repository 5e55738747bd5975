// Runs of numbers in an observation row: each is declared and written by one entry of a constant table.
//
// No one computes an offset: fields stand in a row as they stand in the table.
#pragma once
#include <cstdint>
#include <iterator>
#include <utility>

#include "base/vec.hpp"
#include "env/task.hpp"

namespace rdm {

using FieldTable = Vector<FieldSpec>;

// Appends "prefix.name" (or "name" when the prefix is null). `unit` must be static: what the stored number
// 1 stands for ("m", "5 rad/s", "1" for a pure number). `low` and `high` are what no entry ever leaves.
void add_field(FieldTable& table, const char* prefix, const char* name, const char* unit, int32_t count,
               float low = kUnbounded, float high = kUnbounded);

int32_t field_total(const FieldTable& table);

// One field of a row that is made from a From.
template <class From>
struct FieldEntry {
  const char* name;
  const char* unit;
  int32_t count;
  void (*write)(const From& from, float* out);  // exactly `count` numbers
};

// Writes the fields of a constexpr array of FieldEntry in order; returns the place behind them.
template <const auto& kEntries, class From>
float* write_fields(const From& from, float* out) {
  // the calls are unrolled and so inlined, where a loop would go through the pointers
  const auto each = [&]<size_t... I>(std::index_sequence<I...>) {
    ((kEntries[I].write(from, out), out += kEntries[I].count), ...);
  };
  each(std::make_index_sequence<std::size(kEntries)>());
  return out;
}

// Geometry as observations have it: quaternions in (x, y, z, w).
inline void put(const Vec3& v, float* out, double scale = 1) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(scale * v[i]);
}
inline void put(const Quat& q, float* out) {
  out[0] = static_cast<float>(q.x);
  out[1] = static_cast<float>(q.y);
  out[2] = static_cast<float>(q.z);
  out[3] = static_cast<float>(q.w);
}

// Bounds every entry by +-limit. False when an entry is not finite after that; it stays as it is.
bool clip_row(float* row, int32_t count, float limit);

// False when an entry is not finite; else `out` has the row bounded by +-1.
bool clip_action(const float* row, int32_t count, float* out);

}  // namespace rdm

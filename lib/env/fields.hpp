// Runs of numbers in an observation row: declared once, in order, and written in that order.
//
// No one computes an offset: a table is a list of counts, and the writer walks it.
#pragma once
#include <cstdint>

#include "base/vec.hpp"
#include "env/task.hpp"

namespace rdm {

using FieldTable = Vector<FieldSpec>;

// Appends "prefix.name" (or "name" when the prefix is null). `unit` must be static: what the stored number
// 1 stands for ("m", "5 rad/s", "1" for a pure number).
void add_field(FieldTable& table, const char* prefix, const char* name, const char* unit, int32_t count);

int32_t field_total(const FieldTable& table);

// Walks a row field by field. A count that differs from the table's, a field too many, or one missing at
// finish() is Error(kInternal): a defect of the task.
class FieldWriter {
 public:
  FieldWriter(const FieldTable& table, float* row) : table_(table), at_(row) {}

  // The next field's place in the row.
  float* next(int32_t count);
  void finish() const;

 private:
  const FieldTable& table_;
  float* at_;
  size_t field_ = 0;
};

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

// Bounds every entry by +-limit; what is not a number stays so, for the pool to see.
void clip_row(float* row, int32_t count, float limit);

}  // namespace rdm

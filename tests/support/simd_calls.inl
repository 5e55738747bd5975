// Simd<float, kLanes> behind functions, for what checks it (simd_checks.hpp) to call from code of the base
// set: included between the pragmas that switch an instruction set on, behind base/simd.hpp.
#pragma once

namespace rdm {
namespace {

using L = Simd<float, kLanes>;
constexpr int kMost = 13;

// [kMost][kLanes] lane by lane, and back again.
void columns(const float* const* rows, int count, float (*out)[kLanes]) {
  L::V to[kMost] = {};
  L::gather(rows, count, to);
  std::memcpy(out, to, sizeof to);
}
void rows_of(const float (*from)[kLanes], int count, int lanes, float* const* rows) {
  L::V columns[kMost];
  std::memcpy(columns, from, sizeof columns);
  L::scatter(columns, count, lanes, rows);
}
void roots(const float* from, float* out) {
  L::V v;
  std::memcpy(&v, from, sizeof v);
  v = L::root(v);
  std::memcpy(out, &v, sizeof v);
}
uint32_t bits_below(const float* from, float bound) {
  L::V v;
  std::memcpy(&v, from, sizeof v);
  return L::bits(v < bound);
}

}  // namespace
}  // namespace rdm

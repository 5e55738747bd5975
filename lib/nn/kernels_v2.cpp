// Kernels for the base instruction set: four lanes, no fused multiply-add.
#include <cstring>

#include "base/cpu.hpp"
#include "base/simd.hpp"
#include "nn/kernels.hpp"

namespace rdm {
namespace {

using V = Float4;
using D = double __attribute__((vector_size(16)));
using VI = Int4;
constexpr int kLanes = 4, kTileRows = 6, kTileVectors = 2;
constexpr const char* kIsa = kBaseIsa;

inline V load(const float* p) {
  return load4(p);
}
inline V load_part(const float* p, int n) {
  V v{};
  for (int i = 0; i < n; ++i) v[i] = p[i];
  return v;
}
inline void store(float* p, V v) {
  store4(p, v);
}
inline void store_part(float* p, V v, int n) {
  for (int i = 0; i < n; ++i) p[i] = v[i];
}
inline V all(float s) {
  return splat(s);
}
inline V fma(V a, V b, V c) {
  return a * b + c;
}
inline V root(V a) {
  return sqrt(a);
}
// Of two operands with a not-a-number, the second is given.
inline V low(V a, V b) {
  return min(a, b);
}
inline V high(V a, V b) {
  return max(a, b);
}
inline V above(V a, V b, V yes, V no) {
  return a > b ? yes : no;
}
inline V positive(V z, V yes, V no) {
  return z > V{} ? yes : no;
}
inline D load_double(const float* p) {
  return D{static_cast<double>(p[0]), static_cast<double>(p[1])};
}
inline D all_double(double s) {
  return D{s, s};
}
inline D fma(D a, D b, D c) {
  return a * b + c;
}

// A block of 4 x 4: column[k] holds from[0..3][k].
using Column = V;
constexpr int kBlock = 4;
inline void load_columns(const float* from, size_t row, Column (&column)[kBlock]) {
  for (size_t i = 0; i < kBlock; ++i) column[i] = load(from + i * row);
  transpose(column);
}
inline Column load_column(const float* p) {
  return load(p);
}
inline void store_column(float* p, Column v) {
  store(p, v);
}
inline Column all_column(float s) {
  return all(s);
}
inline float fma(float a, float b, float c) {
  return a * b + c;
}

}  // namespace
}  // namespace rdm

#include "nn/kernels_points.hpp"

namespace rdm {
const Kernels* kernels_v2() {
  static constexpr Kernels table = RDM_KERNEL_TABLE;
  return &table;
}
}  // namespace rdm

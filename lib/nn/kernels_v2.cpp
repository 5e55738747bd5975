// Kernels for the base instruction set: four lanes, no fused multiply-add.
#include "nn/kernels.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#else
#include <cmath>
#endif

#include <cstring>

namespace rdm {
namespace {

using V = float __attribute__((vector_size(16)));
using D = double __attribute__((vector_size(16)));
using VI = int32_t __attribute__((vector_size(16)));
constexpr int kLanes = 4, kTileRows = 6, kTileVectors = 2;
constexpr const char* kIsa = "x86-64-v2";

inline V load(const float* p) {
  V v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline V load_part(const float* p, int n) {
  V v{};
  for (int i = 0; i < n; ++i) v[i] = p[i];
  return v;
}
inline void store(float* p, V v) {
  std::memcpy(p, &v, sizeof v);
}
inline void store_part(float* p, V v, int n) {
  for (int i = 0; i < n; ++i) p[i] = v[i];
}
inline V all(float s) {
  return V{s, s, s, s};
}
inline V fma(V a, V b, V c) {
  return a * b + c;
}
inline V root(V a) {
#if defined(__SSE2__)
  return _mm_sqrt_ps(a);
#else
  return V{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
#endif
}
// Of two operands with a not-a-number, the second is given.
inline V low(V a, V b) {
  return a < b ? a : b;
}
inline V high(V a, V b) {
  return a > b ? a : b;
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
  const V a = load(from), b = load(from + row), c = load(from + 2 * row), d = load(from + 3 * row);
  const V ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const V ab2 = __builtin_shufflevector(a, b, 2, 6, 3, 7), cd2 = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  column[0] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
  column[1] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  column[2] = __builtin_shufflevector(ab2, cd2, 0, 1, 4, 5);
  column[3] = __builtin_shufflevector(ab2, cd2, 2, 3, 6, 7);
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

#include "nn/kernels_vector.hpp"

namespace rdm {
const Kernels* kernels_v2() {
  static constexpr Kernels table = RDM_KERNEL_TABLE;
  return &table;
}
}  // namespace rdm

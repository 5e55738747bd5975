// Kernels for x86-64-v3 (AVX2, FMA). The pragma stands after every header that has code in it, so that no
// shared inline function is compiled with it.
#include "nn/kernels.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <cstring>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif

namespace rdm {
namespace {

using V = __m256;
using D = __m256d;
using VI = int32_t __attribute__((vector_size(32)));
constexpr int kLanes = 8, kTileRows = 6, kTileVectors = 2;
constexpr const char* kIsa = "x86-64-v3";

// All ones in the first n of 8 lanes.
inline __m256i first(int n) {
  return _mm256_cmpgt_epi32(_mm256_set1_epi32(n), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
}
inline V load(const float* p) {
  return _mm256_loadu_ps(p);
}
inline V load_part(const float* p, int n) {
  return _mm256_maskload_ps(p, first(n));
}
inline void store(float* p, V v) {
  _mm256_storeu_ps(p, v);
}
inline void store_part(float* p, V v, int n) {
  _mm256_maskstore_ps(p, first(n), v);
}
inline V all(float s) {
  return _mm256_set1_ps(s);
}
inline V fma(V a, V b, V c) {
  return _mm256_fmadd_ps(a, b, c);
}
inline V root(V a) {
  return _mm256_sqrt_ps(a);
}
// Of two operands with a not-a-number, the second is given.
inline V low(V a, V b) {
  return _mm256_min_ps(a, b);
}
inline V high(V a, V b) {
  return _mm256_max_ps(a, b);
}
inline V positive(V z, V yes, V no) {
  return _mm256_blendv_ps(no, yes, _mm256_cmp_ps(z, _mm256_setzero_ps(), _CMP_GT_OQ));
}
inline D load_double(const float* p) {
  return _mm256_cvtps_pd(_mm_loadu_ps(p));
}
inline D all_double(double s) {
  return _mm256_set1_pd(s);
}
inline D fma(D a, D b, D c) {
  return _mm256_fmadd_pd(a, b, c);
}

// A block of 8 x 8: column[k] holds from[0..7][k]. The halves are put in place by the loads.
using Column = __m256;
constexpr int kBlock = 8;
inline void load_columns(const float* from, size_t row, Column (&column)[kBlock]) {
  __m256 r[8], t[8];
  for (size_t i = 0; i < 4; ++i)
    for (size_t half = 0; half < 2; ++half)
      r[i + 4 * half] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(from + i * row + 4 * half)),
                                             _mm_loadu_ps(from + (i + 4) * row + 4 * half), 1);
  for (size_t i = 0; i < 8; i += 2) {
    t[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
    t[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
  }
  for (size_t i = 0; i < 8; i += 4)
    for (size_t j = 0; j < 2; ++j) {
      column[i + 2 * j] = _mm256_shuffle_ps(t[i + j], t[i + j + 2], 0x44);
      column[i + 2 * j + 1] = _mm256_shuffle_ps(t[i + j], t[i + j + 2], 0xEE);
    }
}
inline Column load_column(const float* p) {
  return _mm256_loadu_ps(p);
}
inline void store_column(float* p, Column v) {
  _mm256_storeu_ps(p, v);
}
inline Column all_column(float s) {
  return _mm256_set1_ps(s);
}
inline float fma(float a, float b, float c) {
  return _mm_cvtss_f32(_mm_fmadd_ss(_mm_set_ss(a), _mm_set_ss(b), _mm_set_ss(c)));
}

}  // namespace
}  // namespace rdm

#include "nn/kernels_vector.hpp"

namespace rdm {
const Kernels* kernels_v3() {
  static constexpr Kernels table = RDM_KERNEL_TABLE;
  return &table;
}
}  // namespace rdm

#if defined(__clang__)
#pragma clang attribute pop
#endif
#else
namespace rdm {
const Kernels* kernels_v3() {
  return nullptr;
}
}  // namespace rdm
#endif

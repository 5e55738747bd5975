// Kernels for x86-64-v3 (AVX2, FMA). The pragma comes after all headers, so that no inline function that other files
// share is compiled for this instruction set.
#include "base/cpu.hpp"
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
constexpr const char* kIsa = kV3Isa;

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
// If an operand is NaN, min and max give the second one.
inline V low(V a, V b) {
  return _mm256_min_ps(a, b);
}
inline V high(V a, V b) {
  return _mm256_max_ps(a, b);
}
inline V above(V a, V b, V yes, V no) {
  return _mm256_blendv_ps(no, yes, _mm256_cmp_ps(a, b, _CMP_GT_OQ));
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

}  // namespace
}  // namespace rdm

#include "nn/kernels_block.inl"

namespace rdm {
namespace {

inline float fma(float a, float b, float c) {
  return _mm_cvtss_f32(_mm_fmadd_ss(_mm_set_ss(a), _mm_set_ss(b), _mm_set_ss(c)));
}

}  // namespace
}  // namespace rdm

#include "nn/kernels_points.hpp"

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

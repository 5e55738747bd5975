// Kernels for x86-64-v4 (AVX-512). The pragma stands after every header that has code in it, so that no
// shared inline function is compiled with it.
#include "base/cpu.hpp"
#include "nn/kernels.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <cstring>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,avx2,fma"))), \
                             apply_to = function)
#else
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl,avx2,fma")
#endif

namespace rdm {
namespace {

using V = __m512;
using D = __m512d;
using VI = int32_t __attribute__((vector_size(64)));
constexpr int kLanes = 16, kTileRows = 6, kTileVectors = 4;
constexpr const char* kIsa = kV4Isa;

inline __mmask16 first(int n) {
  return static_cast<__mmask16>((1u << n) - 1u);
}
inline V load(const float* p) {
  return _mm512_loadu_ps(p);
}
inline V load_part(const float* p, int n) {
  return _mm512_maskz_loadu_ps(first(n), p);
}
inline void store(float* p, V v) {
  _mm512_storeu_ps(p, v);
}
inline void store_part(float* p, V v, int n) {
  _mm512_mask_storeu_ps(p, first(n), v);
}
inline V all(float s) {
  return _mm512_set1_ps(s);
}
inline V fma(V a, V b, V c) {
  return _mm512_fmadd_ps(a, b, c);
}
// The masked forms: the plain ones read an undefined register, of which GCC 12 warns.
inline V root(V a) {
  return _mm512_maskz_sqrt_ps(0xFFFF, a);
}
// Of two operands with a not-a-number, the second is given.
inline V low(V a, V b) {
  return _mm512_maskz_min_ps(0xFFFF, a, b);
}
inline V high(V a, V b) {
  return _mm512_maskz_max_ps(0xFFFF, a, b);
}
inline V above(V a, V b, V yes, V no) {
  return _mm512_mask_blend_ps(_mm512_cmp_ps_mask(a, b, _CMP_GT_OQ), no, yes);
}
inline V positive(V z, V yes, V no) {
  return _mm512_mask_blend_ps(_mm512_cmp_ps_mask(z, _mm512_setzero_ps(), _CMP_GT_OQ), no, yes);
}
inline D load_double(const float* p) {
  return _mm512_maskz_cvtps_pd(0xFF, _mm256_loadu_ps(p));
}
inline D all_double(double s) {
  return _mm512_set1_pd(s);
}
inline D fma(D a, D b, D c) {
  return _mm512_fmadd_pd(a, b, c);
}

}  // namespace
}  // namespace rdm

#include "nn/kernels_block.inl"

namespace rdm {
namespace {

inline Column fma(Column a, Column b, Column c) {
  return _mm256_fmadd_ps(a, b, c);
}
inline float fma(float a, float b, float c) {
  return _mm_cvtss_f32(_mm_fmadd_ss(_mm_set_ss(a), _mm_set_ss(b), _mm_set_ss(c)));
}

}  // namespace
}  // namespace rdm

#include "nn/kernels_points.hpp"

namespace rdm {
const Kernels* kernels_v4() {
  static constexpr Kernels table = RDM_KERNEL_TABLE;
  return &table;
}
}  // namespace rdm

#if defined(__clang__)
#pragma clang attribute pop
#endif
#else
namespace rdm {
const Kernels* kernels_v4() {
  return nullptr;
}
}  // namespace rdm
#endif

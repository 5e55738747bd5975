// Blocks of 8 x 8 floats, for the sets with eight or more lanes. Part of kernels_v3.cpp and kernels_v4.cpp.
#pragma once

namespace rdm {
namespace {

// column[k] holds from[0..7][k]. The halves are put in place by the loads.
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

}  // namespace
}  // namespace rdm

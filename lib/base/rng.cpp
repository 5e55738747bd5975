#include "base/rng.hpp"

#include <algorithm>

#include "base/cpu.hpp"
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace rdm {
namespace {

constexpr int kChunk = 8;

}  // namespace

#if defined(__x86_64__)
// A word stands in the low half of 64 bits, and what comes into the high half is left there: a product takes
// no notice of it.
[[gnu::target("avx2")]] void Stream::chunk(uint64_t counter, const uint32_t* keys, float* out) const {
  __m256i c0[2], c1[2], c2[2], c3[2];
  for (int i = 0; i < 2; ++i) {
    const __m256i first = _mm256_set1_epi64x(static_cast<int64_t>(counter) + 4 * i);
    c0[i] = _mm256_add_epi64(first, _mm256_set_epi64x(3, 2, 1, 0));
    c1[i] = _mm256_srli_epi64(c0[i], 32);
    c2[i] = _mm256_set1_epi64x(world_);
    c3[i] = _mm256_set1_epi64x(purpose_);
  }
  const __m256i m0 = _mm256_set1_epi64x(kM0), m1 = _mm256_set1_epi64x(kM1);
  for (int round = 0; round < kRounds; ++round) {
    const __m256i k0 = _mm256_set1_epi32(static_cast<int32_t>(keys[2 * round])),
                  k1 = _mm256_set1_epi32(static_cast<int32_t>(keys[2 * round + 1]));
    for (int i = 0; i < 2; ++i) {
      const __m256i p0 = _mm256_mul_epu32(c0[i], m0), p1 = _mm256_mul_epu32(c2[i], m1);
      c0[i] = _mm256_xor_si256(_mm256_srli_epi64(p1, 32), _mm256_xor_si256(c1[i], k0));
      c2[i] = _mm256_xor_si256(_mm256_srli_epi64(p0, 32), _mm256_xor_si256(c3[i], k1));
      c1[i] = p1;
      c3[i] = p0;
    }
  }
  const __m256i even = _mm256_set_epi32(7, 5, 3, 1, 6, 4, 2, 0);
  const __m256d high_unit = _mm256_set1_pd(0x1p-31), low_unit = _mm256_set1_pd(0x1p-52);
  for (int i = 0; i < 2; ++i) {
    const __m128i low = _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(c0[i], even)),
                  high = _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(c1[i], even));
    // signed_unit() of these words: both terms and their sum are exact
    const __m256d a = _mm256_cvtepi32_pd(_mm_xor_si128(high, _mm_set1_epi32(INT32_MIN))),
                  b = _mm256_cvtepi32_pd(_mm_srli_epi32(low, 11));
    _mm_storeu_ps(out + 4 * i,
                  _mm256_cvtpd_ps(_mm256_add_pd(_mm256_mul_pd(a, high_unit), _mm256_mul_pd(b, low_unit))));
  }
}
#else
void Stream::chunk(uint64_t, const uint32_t*, float*) const {}
#endif

void Stream::signed_units(float* out, int count) {
  int i = 0;
  if (cpu().avx2) {
    uint32_t keys[2 * kRounds];
    for (uint32_t r = 0; r < kRounds; ++r) {
      keys[2 * r] = static_cast<uint32_t>(seed_) + r * kW0;
      keys[2 * r + 1] = static_cast<uint32_t>(seed_ >> 32) + r * kW1;
    }
    for (; i + kChunk <= count; i += kChunk, counter_ += kChunk) chunk(counter_, keys, out + i);
  }
  for (; i < count; ++i) out[i] = static_cast<float>(signed_unit());
}

}  // namespace rdm

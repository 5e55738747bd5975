// Eight lanes with AVX: the same numbers as without it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/cpu.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
#define RDM_SIMD_AVX

#include "base/simd.hpp"

namespace rdm {
namespace {

using L = Simd<float, 8>;
constexpr int kMost = 13;

// [kMost][8] lane by lane, and back again.
void columns(const float* const* rows, int count, float (*out)[8]) {
  L::V to[kMost] = {};
  L::gather(rows, count, to);
  std::memcpy(out, to, sizeof to);
}
void rows_of(const float (*from)[8], int count, int lanes, float* const* rows) {
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

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

namespace rdm {
namespace {

float number(int row, int column) {
  return 1.0f + 16.0f * static_cast<float>(row) + static_cast<float>(column);
}

class SimdAvx : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!cpu().avx2) GTEST_SKIP() << "this processor has no AVX2";
  }
};

TEST_F(SimdAvx, GathersRowsIntoColumns) {
  float rows[8][kMost];
  const float* from[8];
  for (int l = 0; l < 8; ++l) {
    from[l] = rows[l];
    for (int i = 0; i < kMost; ++i) rows[l][i] = number(l, i);
  }
  for (int count = 0; count <= kMost; ++count) {
    float out[kMost][8];
    columns(from, count, out);
    for (int i = 0; i < kMost; ++i)
      for (int l = 0; l < 8; ++l) EXPECT_EQ(out[i][l], i < count ? number(l, i) : 0) << count;
  }
}

TEST_F(SimdAvx, ScattersColumnsIntoTheRowsThereAre) {
  float from[kMost][8];
  for (int i = 0; i < kMost; ++i)
    for (int l = 0; l < 8; ++l) from[i][l] = number(l, i);
  for (int count = 0; count <= kMost; ++count)
    for (int lanes = 0; lanes <= 8; ++lanes) {
      float rows[8][kMost] = {};
      float* to[8];
      for (int l = 0; l < 8; ++l) to[l] = l < lanes ? rows[l] : nullptr;
      rows_of(from, count, lanes, to);
      for (int l = 0; l < 8; ++l)
        for (int i = 0; i < kMost; ++i)
          EXPECT_EQ(rows[l][i], l < lanes && i < count ? number(l, i) : 0) << count << ", " << lanes;
    }
}

TEST_F(SimdAvx, RootsAndMasksAreThoseOfEachLane) {
  const float from[8] = {0, 2, 3, 1e-30f, 1e30f, 5, 7, 0.1f};
  float out[8];
  roots(from, out);
  for (int l = 0; l < 8; ++l) EXPECT_EQ(out[l], std::sqrt(from[l]));
  for (int l = 0; l < 8; ++l) {
    float one[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    one[l] = -1;
    EXPECT_EQ(bits_below(one, 0), 1u << l);
  }
}

}  // namespace
}  // namespace rdm
#endif

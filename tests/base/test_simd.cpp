#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/simd.hpp"

namespace rdm {
namespace {

constexpr Float4 kA{-2, 0, 3, 16}, kB{1, -0.5f, 3, 9};

TEST(Simd, EachLaneIsTheScalarOperation) {
  const Float4 lo = min(kA, kB), hi = max(kA, kB), held = clamp(kA, -1, 4), root = sqrt(hi);
  for (int i = 0; i < kFloat4Lanes; ++i) {
    EXPECT_EQ(lo[i], std::min(kA[i], kB[i]));
    EXPECT_EQ(hi[i], std::max(kA[i], kB[i]));
    EXPECT_EQ(held[i], std::min(4.0f, std::max(-1.0f, kA[i])));
    EXPECT_EQ(root[i], std::sqrt(hi[i]));
    EXPECT_EQ(abs(kA)[i], std::abs(kA[i]));
  }
  EXPECT_EQ(largest(kA), 16);
  EXPECT_EQ(largest(-kA), 2);
}

TEST(Simd, MasksChooseLaneByLane) {
  const Int4 less = kA < kB;
  const Float4 chosen = select(less, kA, kB);
  for (int i = 0; i < kFloat4Lanes; ++i) EXPECT_EQ(chosen[i], kA[i] < kB[i] ? kA[i] : kB[i]);
  EXPECT_TRUE(any(less));
  EXPECT_FALSE(any(kA > 100.0f));
  for (int i = 0; i < kFloat4Lanes; ++i) {
    Int4 one = splat_int(0);
    one[i] = -1;
    EXPECT_TRUE(any(one)) << i;
  }
}

TEST(Simd, LoadsStoresAndBits) {
  const float from[] = {9, 1, 2, 3, 4, 9};
  float to[6] = {};
  store4(to + 1, load4(from + 1));
  for (int i = 0; i < 6; ++i) EXPECT_EQ(to[i], i % 5 ? from[i] : 0);
  for (uint32_t bits = 0; bits < 16; ++bits) {
    Int4 m = splat_int(0);
    for (int i = 0; i < 4; ++i) m[i] = bits >> i & 1 ? -1 : 0;
    EXPECT_EQ(bits_of(m), bits);
  }
}

TEST(Simd, TransposesFourByFour) {
  Float4 r[4];
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) r[i][j] = static_cast<float>(4 * i + j);
  transpose(r);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_EQ(r[i][j], static_cast<float>(4 * j + i));
}

}  // namespace
}  // namespace rdm

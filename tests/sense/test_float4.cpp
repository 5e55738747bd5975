#include <gtest/gtest.h>

#include "sense/render/float4.hpp"

namespace rdm {
namespace {

constexpr Float4 kA{-2, 0, 3, 16}, kB{1, -0.5f, 3, 9};

TEST(Packet, EachLaneIsTheScalarOperation) {
  const Float4 lo = min(kA, kB), hi = max(kA, kB), held = clamp(kA, -1, 4), root = sqrt(hi);
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_EQ(lo[i], std::min(kA[i], kB[i]));
    EXPECT_EQ(hi[i], std::max(kA[i], kB[i]));
    EXPECT_EQ(held[i], std::min(4.0f, std::max(-1.0f, kA[i])));
    EXPECT_EQ(root[i], std::sqrt(hi[i]));
    EXPECT_EQ(abs(kA)[i], std::abs(kA[i]));
  }
  EXPECT_EQ(largest(kA), 16);
  EXPECT_EQ(largest(-kA), 2);
}

TEST(Packet, MasksChooseLaneByLane) {
  const LaneMask less = kA < kB;
  const Float4 chosen = select(less, kA, kB);
  for (int i = 0; i < kLanes; ++i) EXPECT_EQ(chosen[i], kA[i] < kB[i] ? kA[i] : kB[i]);
  EXPECT_TRUE(any(less));
  EXPECT_FALSE(any(kA > 100.0f));
  for (int i = 0; i < kLanes; ++i) {
    LaneMask one = splat_int(0);
    one[i] = -1;
    EXPECT_TRUE(any(one)) << i;
  }
}

TEST(Packet, VectorsOfLanes) {
  const Lanes3 v{Float4{3, 0, 1, 2}, Float4{4, -2, 2, 3}, Float4{12, 0, 2, 6}};
  const Float4 length = sqrt(dot(v, v)), unit = dot(normalized(v), normalized(v));
  EXPECT_EQ(length[0], 13);
  EXPECT_EQ(length[1], 2);
  EXPECT_EQ(length[2], 3);
  EXPECT_EQ(length[3], 7);
  for (int i = 0; i < kLanes; ++i) EXPECT_NEAR(unit[i], 1, 1e-6);
  const Lanes3 middle = mix(splat(0, 0, 0), v, splat(0.5f));
  EXPECT_EQ(middle.y[1], -1);
}

}  // namespace
}  // namespace rdm

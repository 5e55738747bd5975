#include <gtest/gtest.h>

#include "sense/render/lanes3.hpp"

namespace rdm {
namespace {

TEST(Lanes3, IsFourVectors) {
  const Lanes3 v{Float4{3, 0, 1, 2}, Float4{4, -2, 2, 3}, Float4{12, 0, 2, 6}};
  const Float4 length = sqrt(dot(v, v)), unit = dot(normalized(v), normalized(v));
  EXPECT_EQ(length[0], 13);
  EXPECT_EQ(length[1], 2);
  EXPECT_EQ(length[2], 3);
  EXPECT_EQ(length[3], 7);
  for (int i = 0; i < kFloat4Lanes; ++i) EXPECT_NEAR(unit[i], 1, 1e-6);
  const Lanes3 middle = mix(splat(0, 0, 0), v, splat(0.5f));
  EXPECT_EQ(middle.y[1], -1);
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include "base/eigen.hpp"

namespace rdm {
namespace {

TEST(Eigen, IsCompiledWithoutTheMachinesVectors) {
  EXPECT_STREQ(Eigen::SimdInstructionSetsInUse(), "None");
}

TEST(Eigen, VectorsAndMatricesGoThereAndBack) {
  const Mat3 m{{1, 2, 3, 4, 5, 6, 7, 8, 10}};
  const Vec3 v{-1, 0.5, 2};
  const Eigen::Matrix3d e = to_eigen(m);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(e(r, c), m(r, c));
      EXPECT_EQ(to_mat3(e)(r, c), m(r, c));
    }
  const Vec3 ours = m * v, theirs = to_vec3(e * to_eigen(v));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ours[i], theirs[i]);
}

}  // namespace
}  // namespace rdm

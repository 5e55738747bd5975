// Noise between knots: values at knots, hand-computed values between them, weights that add up to 1.
#include <gtest/gtest.h>

#include <vector>

#include "plan/knots.hpp"

namespace rdm {
namespace {

constexpr Interpolation kKinds[] = {Interpolation::kZero, Interpolation::kLinear, Interpolation::kCubic};

double value(Interpolation kind, const std::vector<double>& knots, int32_t horizon, int32_t step) {
  const KnotRow row = knot_row(kind, static_cast<int32_t>(knots.size()), horizon, step);
  double sum = 0;
  for (int32_t k = 0; k < row.count; ++k)
    sum += static_cast<double>(row.weight[k]) * knots[static_cast<size_t>(row.first + k)];
  return sum;
}

TEST(Knots, WeightsAddUpToOneAndStayWithinTheKnots) {
  for (const Interpolation kind : kKinds)
    for (int32_t horizon = 1; horizon <= 17; ++horizon)
      for (int32_t knots = 1; knots <= horizon; ++knots)
        for (int32_t t = 0; t < horizon; ++t) {
          const KnotRow row = knot_row(kind, knots, horizon, t);
          ASSERT_GE(row.first, 0);
          ASSERT_GE(row.count, 1);
          ASSERT_LE(row.first + row.count, knots) << horizon << ' ' << t;
          EXPECT_NEAR(value(kind, std::vector<double>(static_cast<size_t>(knots), 1.0), horizon, t), 1, 1e-6);
        }
}

TEST(Knots, ZeroHoldsEachKnotForItsShareOfTheHorizon) {
  const std::vector<double> knots = {10, 20, 30, 40};
  const double expected[] = {10, 10, 20, 20, 30, 30, 40, 40};
  for (int32_t t = 0; t < 8; ++t) EXPECT_EQ(value(Interpolation::kZero, knots, 8, t), expected[t]) << t;
}

TEST(Knots, LinearIsStraightBetweenKnots) {
  const std::vector<double> knots = {0, 4, -2};
  const double expected[] = {0, 2, 4, 1, -2};
  for (int32_t t = 0; t < 5; ++t) EXPECT_NEAR(value(Interpolation::kLinear, knots, 5, t), expected[t], 1e-6);
}

TEST(Knots, CubicIsHermiteWithMeanSlopes) {
  // p = (0, 1, 0): slopes 1, 0, -1; halfway h00 0 + h10 1 + h01 1 + h11 0 = 0.125 + 0.5
  const std::vector<double> knots = {0, 1, 0};
  const double expected[] = {0, 0.625, 1, 0.625, 0};
  for (int32_t t = 0; t < 5; ++t) EXPECT_NEAR(value(Interpolation::kCubic, knots, 5, t), expected[t], 1e-6);
  // p = (0, 0, 1, 0, 0) a quarter after knot 1: slopes 1/2 and 0; h10 = 9/64, h01 = 10/64
  EXPECT_NEAR(value(Interpolation::kCubic, {0, 0, 1, 0, 0}, 17, 5), 0.5 * 9 / 64 + 10.0 / 64, 1e-6);
  // a straight line stays one
  for (int32_t t = 0; t < 13; ++t)
    EXPECT_NEAR(value(Interpolation::kCubic, {1, 2, 3, 4, 5}, 13, t), 1 + t / 3.0, 1e-5);
}

TEST(Knots, AKnotPerStepIsThatKnot) {
  for (const Interpolation kind : kKinds)
    for (int32_t t = 0; t < 6; ++t)
      EXPECT_EQ(value(kind, {3, 1, 4, 1, 5, 9}, 6, t),
                (std::vector<double>{3, 1, 4, 1, 5, 9})[static_cast<size_t>(t)]);
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/elementary.hpp"
#include "base/fpmode.hpp"
#include "base/hash.hpp"
#include "base/rng.hpp"

namespace rdm {
namespace {

using Wide = long double;
using One = double (*)(double);
using Reference = Wide (*)(Wide);

constexpr double kInf = std::numeric_limits<double>::infinity(),
                 kNan = std::numeric_limits<double>::quiet_NaN(), kMin = std::numeric_limits<double>::min(),
                 kMax = std::numeric_limits<double>::max();

// Some emulators compute the extended type in double: then nothing is left to compare with.
bool has_extended() {
  volatile Wide one = 1;
  return std::numeric_limits<Wide>::digits >= 64 && one + 0x1p-60L != one;
}

double ulps(double got, Wide want) {
  return static_cast<double>(std::fabs(static_cast<Wide>(got) - want) /
                             std::ldexp(1.0L, std::ilogb(want) - 52));
}

// Largest error of `f` over 200,000 arguments: uniform between low and high, or +-2^u with u uniform there.
struct Range {
  double low, high;
  bool exponents = false, negative = true;
};
double worst(One f, Reference g, const Range& range) {
  Stream s(1, 0, Purpose::kTest);
  double most = 0;
  for (int i = 0; i < 200000; ++i) {
    double x = s.uniform(range.low, range.high);
    if (range.exponents) x = std::exp2(x) * (range.negative && s.uniform() < 0.5 ? -1 : 1);
    const double error = ulps(f(x), g(static_cast<Wide>(x)));
    if (!(error <= most)) most = error;
  }
  return most;
}

class Accuracy : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_extended()) GTEST_SKIP() << "no extended precision to compare with";
  }
};

TEST_F(Accuracy, SineAndCosine) {
  for (const Range r : {Range{-4, 4}, Range{-1600, 1600}, Range{-60, 10, true}}) {
    EXPECT_LT(worst(elementary::sin, sinl, r), 1);
    EXPECT_LT(worst(elementary::cos, cosl, r), 1);
  }
}

TEST_F(Accuracy, SineNextToItsZeros) {
  for (int n = 1; n < 1018; ++n) {
    double x = n * 1.5707963267948966;
    for (const double y : {std::nextafter(x, 0), x, std::nextafter(x, 2e3)}) {
      ASSERT_LT(ulps(elementary::sin(y), sinl(static_cast<Wide>(y))), 1) << y;
      ASSERT_LT(ulps(elementary::cos(y), cosl(static_cast<Wide>(y))), 1) << y;
    }
  }
}

// The slope of the sine is at most 1: an argument that is half a ulp off moves it by no more than that.
TEST_F(Accuracy, SineOfLargeArguments) {
  Stream s(2, 0, Purpose::kTest);
  for (int i = 0; i < 20000; ++i) {
    const double x = s.signed_unit() * std::exp2(s.uniform(11, 50));
    const Wide half = std::ldexp(1.0L, std::ilogb(x) - 53);
    ASSERT_LE(std::fabs(static_cast<Wide>(elementary::sin(x)) - sinl(static_cast<Wide>(x))), half + 0x1p-53L)
        << x;
    ASSERT_LE(std::fabs(static_cast<Wide>(elementary::cos(x)) - cosl(static_cast<Wide>(x))), half + 0x1p-53L)
        << x;
  }
}

TEST_F(Accuracy, Exponential) {
  for (const Range r : {Range{-1, 1}, Range{-708.39, 709.78}, Range{-60, 9, true}})
    EXPECT_LT(worst(elementary::exp, expl, r), 1);
  for (const Range r : {Range{-0.5, 0.5}, Range{-45, 45}, Range{45, 709.78}, Range{-60, 9, true}})
    EXPECT_LT(worst(elementary::expm1, expm1l, r), 2);
}

TEST_F(Accuracy, Logarithm) {
  for (const Range r : {Range{0.3, 3}, Range{-1021, 1023, true, false}})
    EXPECT_LT(worst(elementary::log, logl, r), 1);
  for (const Range r : {Range{-0.9999, 2}, Range{-60, -0.01, true}, Range{0, 1023, true, false}})
    EXPECT_LT(worst(elementary::log1p, log1pl, r), 2);
}

TEST_F(Accuracy, ArcusFunctions) {
  EXPECT_LT(worst(elementary::asin, asinl, {-1, 1}), 2.5);
  EXPECT_LT(worst(elementary::asin, asinl, {-60, 0, true}), 2.5);
  Stream s(3, 0, Purpose::kTest);
  for (int i = 0; i < 400000; ++i) {
    const double far = i % 2 ? 1 : std::exp2(s.uniform(-40, 1000));
    const double x = s.signed_unit() * far, y = s.signed_unit() * (i % 3 ? far : 1);
    if (std::fabs(y) / std::fabs(x) < kMin) continue;
    ASSERT_LT(ulps(elementary::atan2(y, x), atan2l(static_cast<Wide>(y), static_cast<Wide>(x))), 2)
        << y << " " << x;
  }
}

TEST_F(Accuracy, IntegerPowers) {
  for (const double x : {0.9, 0.999, 0.99, -0.5, 1.01})
    for (const int64_t n : {0, 1, 2, 3, 7, 100, 1000, 5000}) {
      const Wide want = powl(static_cast<Wide>(x), static_cast<Wide>(n));
      EXPECT_LE(std::fabs(static_cast<Wide>(elementary::pow(x, n)) - want),
                static_cast<Wide>(n) * 0x1p-53L * std::fabs(want) + kMin)
          << x << " " << n;
    }
  EXPECT_EQ(elementary::pow(3, 5), 243);
  EXPECT_EQ(elementary::pow(0, 0), 1);
  EXPECT_EQ(elementary::pow(0.5, int64_t{1} << 40), 0);
}

// Equal down to the sign of a zero.
void expect_same(double got, double want) {
  if (std::isnan(want)) {
    EXPECT_TRUE(std::isnan(got)) << got;
    return;
  }
  EXPECT_EQ(got, want);
  EXPECT_EQ(std::signbit(got), std::signbit(want));
}

void expect_edges() {
  for (const One f :
       {One{elementary::sin}, One{elementary::expm1}, One{elementary::log1p}, One{elementary::asin}}) {
    expect_same(f(0.0), 0.0);
    expect_same(f(-0.0), -0.0);
    expect_same(f(kMin), kMin);
    expect_same(f(-kMin), -kMin);
  }
  for (const One f :
       {One{elementary::sin}, One{elementary::cos}, One{elementary::exp}, One{elementary::expm1},
        One{elementary::log}, One{elementary::log1p}, One{elementary::asin}})
    expect_same(f(kNan), kNan);
  for (const One f : {One{elementary::sin}, One{elementary::cos}, One{elementary::asin}}) {
    expect_same(f(kInf), kNan);
    expect_same(f(-kInf), kNan);
  }
  expect_same(elementary::cos(-0.0), 1);
  for (const double x : {1601.0, -1e9, 1e22, kMax, -kMax}) {
    const elementary::SinCos both = elementary::sincos(x);
    EXPECT_NEAR(both.sin * both.sin + both.cos * both.cos, 1, 1e-15) << x;
    expect_same(elementary::sin(-x), -both.sin);
    expect_same(elementary::cos(-x), both.cos);
  }

  expect_same(elementary::exp(0), 1);
  expect_same(elementary::exp(-0.0), 1);
  expect_same(elementary::exp(kInf), kInf);
  expect_same(elementary::exp(-kInf), 0);
  expect_same(elementary::exp(709.79), kInf);
  expect_same(elementary::exp(-708.4), 0);
  EXPECT_TRUE(std::isfinite(elementary::exp(709.782712893384)));
  EXPECT_GE(elementary::exp(-708.396418532264), kMin);
  expect_same(elementary::expm1(kInf), kInf);
  expect_same(elementary::expm1(-kInf), -1);
  expect_same(elementary::expm1(-1000), -1);
  EXPECT_TRUE(std::isfinite(elementary::expm1(709.782712893384)));

  expect_same(elementary::log(1), 0);
  expect_same(elementary::log(0.0), -kInf);
  expect_same(elementary::log(-0.0), -kInf);
  expect_same(elementary::log(-1), kNan);
  expect_same(elementary::log(-kInf), kNan);
  expect_same(elementary::log(kInf), kInf);
  expect_same(elementary::log1p(-1), -kInf);
  expect_same(elementary::log1p(-1.5), kNan);
  expect_same(elementary::log1p(kInf), kInf);

  expect_same(elementary::asin(1), 1.5707963267948966);
  expect_same(elementary::asin(-1), -1.5707963267948966);
  expect_same(elementary::asin(1.0000001), kNan);
}

void expect_angles() {
  const double pi = 3.141592653589793;
  for (const double s : {1.0, -1.0}) {
    for (const double y : {0.0, 1.0, kMin, 1e300}) expect_same(elementary::atan2(s * y, kInf), s * 0.0);
    for (const double x : {0.0, 1.0, kMin, 1e300}) expect_same(elementary::atan2(s * 0.0, x), s * 0.0);
    for (const double x : {0.0, 1.0, kMin, 1e300, kInf}) expect_same(elementary::atan2(s * 0.0, -x), s * pi);
    for (const double x : {0.0, -0.0, 1.0, -1e300}) expect_same(elementary::atan2(s * kInf, x), s * pi / 2);
    for (const double y : {1.0, kMin, kMax}) expect_same(elementary::atan2(s * y, 0.0), s * pi / 2);
    for (const double y : {1.0, kMin, kMax, kInf}) {
      expect_same(elementary::atan2(s * y, y), s * pi / 4);
      expect_same(elementary::atan2(s * y, -y), s * 3 * pi / 4);
    }
  }
  expect_same(elementary::atan2(kNan, 1), kNan);
  expect_same(elementary::atan2(1, kNan), kNan);
}

TEST(Elementary, EdgesInBothModes) {
  expect_edges();
  expect_angles();
  const FpMode flushed;
  expect_edges();
  expect_angles();
}

TEST(Elementary, OneAtATimeIsAsBothAtOnce) {
  Stream s(4, 0, Purpose::kTest);
  for (int i = 0; i < 10000; ++i) {
    const double x = s.uniform(-2000, 2000);
    const elementary::SinCos both = elementary::sincos(x);
    ASSERT_EQ(elementary::sin(x), both.sin);
    ASSERT_EQ(elementary::cos(x), both.cos);
  }
}

// The one number that every machine, compiler and mathematics library must come to.
TEST(Elementary, SameBitsEverywhere) {
  uint64_t hash = kHashSeed;
  Stream s(5, 0, Purpose::kTest);
  for (int i = 0; i < 20000; ++i) {
    const double u = s.signed_unit(), far = s.uniform(-3000, 3000), near = 5 * s.signed_unit();
    const elementary::SinCos a = elementary::sincos(near), b = elementary::sincos(far);
    const double v[] = {a.sin,
                        a.cos,
                        b.sin,
                        b.cos,
                        elementary::exp(near),
                        elementary::exp(far),
                        elementary::expm1(near),
                        elementary::log(std::abs(far)),
                        elementary::log1p(u),
                        elementary::atan2(near, u),
                        elementary::asin(u),
                        elementary::pow(u, i % 50)};
    hash = hash_bytes(v, sizeof v, hash);
  }
  EXPECT_EQ(hash, 0xe167c0df5241736eu);
}

}  // namespace
}  // namespace rdm

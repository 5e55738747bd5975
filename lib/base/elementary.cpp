// Polynomials were fitted for the least largest error with coefficients rounded to double; the reductions
// are those of W. J. Cody and W. Waite (Software Manual for the Elementary Functions, 1980).
#include "base/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/bit_cast.hpp"

namespace rdm::elementary {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMin = std::numeric_limits<double>::min();
constexpr double kRound = 0x1.8p52;  // adding and taking it away again rounds to an integer

// The first part has trailing zeros enough that its products with n below are exact.
constexpr double kLog2High = 0x1.62e42fefa38p-1, kLog2Low = 0x1.ef35793c7673p-45;
constexpr double kHalfPi[] = {0x1.921fb54442cp0, 0x1.18469898cc4p-44, 0x1.1701b839a252p-88};

// Remainder of |x| > 1600 by the double next to 2 pi, exact, by integers: one turn is that number times 2^50.
double wrap(double x) {
  constexpr uint64_t kTurn = 0x1921fb54442d18;
  const auto bits = bit_cast<uint64_t>(x);
  uint64_t rest = ((bits & 0xfffffffffffff) | 0x10000000000000) % kTurn;
  for (int left = static_cast<int>(bits >> 52 & 0x7ff) - 1025; left > 0; left -= 11)
    rest = (rest << std::min(left, 11)) % kTurn;
  return std::copysign(static_cast<double>(rest) * 0x1p-50, x);
}

// x = quadrant pi/2 + high + low, |high| <= pi/4 but for rounding.
struct Reduced {
  double high, low;
  uint64_t quadrant;
};

inline Reduced reduce(double x) {
  if (!(std::abs(x) <= 1600)) {
    if (!std::isfinite(x)) return {kNan, 0, 0};
    x = wrap(x);
  }
  const double shifted = x * 0x1.45f306dc9c883p-1 + kRound, n = shifted - kRound;
  // With |n| < 2^10 both products and a are exact; y is too where |a| < |b|, else the next line has its loss.
  const double a = x - n * kHalfPi[0], b = n * kHalfPi[1], y = a - b;
  return {y, ((a - y) - b) - n * kHalfPi[2], bit_cast<uint64_t>(shifted)};
}

inline double sin_near(double x, double low) {
  const double z = x * x, w = z * z, cube = z * x;
  const double p = (0x1.111111110f75ep-7 + z * -0x1.a01a019bf2523p-13) +
                   w * ((0x1.71de355f3628cp-19 + z * -0x1.ae5e549c421c3p-26) + w * 0x1.5d8e4234a005dp-33);
  return x - ((z * (0.5 * low - cube * p) - low) - cube * -0x1.5555555555548p-3);
}

inline double cos_near(double x, double low) {
  const double z = x * x, w = z * z, half = 0.5 * z;
  const double p = (0x1.555555555554cp-5 + z * -0x1.6c16c16c15221p-10) +
                   w * ((0x1.a01a019cbfa52p-16 + z * -0x1.27e4f812e7a89p-22) +
                        w * (0x1.1ee9f1714b281p-29 + z * -0x1.8fb13e95259f2p-37));
  const double first = 1 - half;
  return first + (((1 - first) - half) + (w * p - x * low));
}

// e^x = 2^n (1 + q), |q| < 0.42.
struct Power {
  int64_t n;
  double q;
};

inline Power split(double x) {
  const double n = (x * 0x1.71547652b82fep0 + kRound) - kRound;
  const double high = x - n * kLog2High, low = n * kLog2Low, r = high - low, z = r * r;
  // r (e^r + 1) / (e^r - 1) is even and close to 2.
  const double p =
      0x1.555555555553ep-3 +
      z * (-0x1.6c16c16bebac8p-9 +
           z * (0x1.1566aaf1a7d4fp-14 + z * (-0x1.bbd41a348f35ap-20 + z * 0x1.637580ad37b86p-25)));
  const double c = r - z * p;
  return {static_cast<int64_t>(n), high - (low - r * c / (2 - c))};
}

// x 2^n where both are normal.
inline double scaled(double x, int64_t n) {
  return bit_cast<double>(bit_cast<uint64_t>(x) + (static_cast<uint64_t>(n) << 52));
}

constexpr double kExpMax = 0x1.62e42fefa39efp9;   // its exponential is the largest double
constexpr double kExpMin = -0x1.6232bdd7abcd2p9;  // log 2^-1022

// For |x| <= 7/16.
inline double atan_near(double x) {
  const double z = x * x, w = z * z;
  const double even =
      -0x1.555555555550bp-2 +
      w * (-0x1.2492491ff177fp-3 +
           w * (-0x1.745cdb8c1587ep-4 +
                w * (-0x1.10d5ee70d7f39p-4 + w * (-0x1.979c05506129ap-5 + w * -0x1.0a68895fffc0ep-6))));
  const double odd = 0x1.999999998e7b4p-3 +
                     w * (0x1.c71c6fda4d8e3p-4 +
                          w * (0x1.3b0f1ea612469p-4 + w * (0x1.dddca1412e2fbp-5 + w * 0x1.2b0ce47dc3f8p-5)));
  return x + x * z * (even + z * odd);
}

// A constant and what its rounding lost.
struct Angle {
  double high, low;
};
constexpr Angle kQuarterTurns[] = {
    {0, 0}, {0x1.921fb54442d18p0, 0x1.1a62633145c07p-54}, {0x1.921fb54442d18p1, 0x1.1a62633145c07p-53}};
constexpr Angle kAtanHalf = {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56};
constexpr Angle kAtanOne = {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55};

}  // namespace

// Quadrants of real angles are hard to predict: bits are masked where one would branch.
SinCos sincos(double x) {
  const Reduced r = reduce(x);
  const auto s = bit_cast<uint64_t>(sin_near(r.high, r.low));
  const auto c = bit_cast<uint64_t>(cos_near(r.high, r.low));
  const uint64_t q = r.quadrant, change = (s ^ c) & (0 - (q & 1));
  return {bit_cast<double>(s ^ change ^ (q & 2) << 62), bit_cast<double>(c ^ change ^ ((q + 1) & 2) << 62)};
}

double sin(double x) {
  return sincos(x).sin;
}

double cos(double x) {
  return sincos(x).cos;
}

double exp(double x) {
  if (std::isnan(x)) return x;
  if (x > kExpMax) return kInfinity;
  if (x < kExpMin) return 0;
  const Power p = split(x);
  return scaled(1 + p.q, p.n);
}

double expm1(double x) {
  if (std::isnan(x)) return x;
  if (x > kExpMax) return kInfinity;
  if (x < -40) return -1;
  const Power p = split(x);
  if (p.n == 0) return p.q;
  const double one = p.n < 60 ? scaled(1, -p.n) : 0;  // in units of 2^n
  return scaled((1 - one) + p.q, p.n);
}

double log(double x) {
  if (std::isnan(x) || x == kInfinity) return x;
  if (x < kMin) return x <= -kMin ? kNan : -kInfinity;
  // x = 2^n m with m in [sqrt(1/2), sqrt(2)).
  const auto bits = bit_cast<uint64_t>(x);
  const auto n = static_cast<int64_t>(bits - 0x3fe6a09e667f3bcd) >> 52;
  const double f = bit_cast<double>(bits - (static_cast<uint64_t>(n) << 52)) - 1;
  const double s = f / (2 + f), z = s * s, w = z * z, half = 0.5 * f * f, k = static_cast<double>(n);
  const double p = z * (0x1.5555555555558p-1 +
                        w * (0x1.2492492e0351ap-2 + w * (0x1.7462bcee6f079p-3 + w * 0x1.2b66663d11a7p-3))) +
                   w * (0x1.9999999995288p-2 + w * (0x1.c71c62ca7b3a3p-3 + w * 0x1.39fd42e4673fep-3));
  return k * kLog2High - ((half - (s * (half + p) + k * kLog2Low)) - f);
}

double log1p(double x) {
  const double u = 1 + x;
  if (u == 1) return x;
  const double y = log(u);
  return std::isfinite(y) ? y + (x - (u - 1)) / u : y;  // what the sum 1 + x lost
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNan;
  double a = std::abs(y), b = std::abs(x);
  if (a == kInfinity && b == kInfinity) a = b = 1;
  const bool steep = a > b, behind = std::signbit(x);
  double q = a == 0 && b == 0 ? 0 : steep ? b / a : a / b;
  // Angle of q: of 1/2 or 1, and a small rest.
  Angle base = {0, 0};
  if (q > 0.6875) {
    base = kAtanOne;
    q = (q - 1) / (q + 1);
  } else if (q > 0.4375) {
    base = kAtanHalf;
    q = (2 * q - 1) / (2 + q);
  }
  double rest = atan_near(q);
  const Angle turn = kQuarterTurns[steep ? 1 : behind ? 2 : 0];
  if (steep != behind) base = {-base.high, -base.low}, rest = -rest;
  const double sum = turn.high + base.high;
  const double lost = (turn.high - sum) + base.high;
  return std::copysign(sum + (lost + ((base.low + turn.low) + rest)), y);
}

double asin(double x) {
  return atan2(x, std::sqrt(std::abs(x) < 0.5 ? 1 - x * x : (1 - x) * (1 + x)));
}

double pow(double x, int64_t n) {
  double y = 1;
  for (; n > 0; n >>= 1, x *= x)
    if (n & 1) y *= x;
  return y;
}

}  // namespace rdm::elementary

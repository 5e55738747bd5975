// How the outputs m of a network become an action a in [-1, 1] beside noise n = std z:
//
//   none     a = clip(m + n)
//   sample   a = tanh(m + n)         a density on (-1, 1): log p(a) = log N(m + n) - sum log(1 - a^2)
//   mean     a = clip(tanh(m) + n)   noise as large at the bounds as within
//
// Without noise the last two are tanh(m).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/elementary.hpp"
#include "nn/kernels.hpp"

namespace rdm {

enum class Squash : int32_t { kNone = 0, kSample = 1, kMean = 2 };

// x = tanh(x), unless it is none.
inline void squash(Squash s, float* x, size_t count) {
  if (s != Squash::kNone) kernels().map_tanh(x, count, x);
}

// log(1 - tanh(u)^2) = 2 (log 2 - u - log(1 + e^(-2u))), which stays right where the tanh is 1 to the last digit.
inline double log_slope_of_tanh(double u) {
  const double v = std::abs(u);
  return 2 * (0.6931471805599453 - v - elementary::log1p(elementary::exp(-2 * v)));
}

// What a mean action is before the tanh; held within it.
inline double unsquash(double action) {
  const double a = std::clamp(action, -0.999, 0.999);
  return 0.5 * (elementary::log1p(a) - elementary::log1p(-a));
}

}  // namespace rdm

#include "plan/knots.hpp"

#include <algorithm>

namespace rdm {

KnotRow knot_row(Interpolation kind, int32_t knots, int32_t horizon, int32_t step) {
  KnotRow row;
  if (knots < 2) return row;
  if (kind == Interpolation::kZero) {
    row.first = static_cast<int32_t>(int64_t{step} * knots / horizon);
    return row;
  }
  // whole and broken part of step (K - 1) / (H - 1), in integers: a step on a knot is that knot exactly
  const int64_t x = int64_t{step} * (knots - 1), span = horizon - 1;
  const auto k = static_cast<int32_t>(std::min<int64_t>(x / span, knots - 2));
  const double s = static_cast<double>(x - k * span) / static_cast<double>(span);
  if (kind == Interpolation::kLinear) {
    row.first = k;
    row.count = 2;
    row.weight[0] = static_cast<float>(1 - s);
    row.weight[1] = static_cast<float>(s);
    return row;
  }
  const double h00 = (1 + 2 * s) * (1 - s) * (1 - s), h10 = s * (1 - s) * (1 - s), h01 = s * s * (3 - 2 * s),
               h11 = s * s * (s - 1);
  double w[4] = {0, h00, h01, 0};                 // of knots k - 1 .. k + 2
  const auto slope = [&](int32_t at, double h) {  // of knot `at`, times h
    const int32_t low = std::max(at - 1, 0), high = std::min(at + 1, knots - 1);
    const double share = h / (high - low);
    w[high - k + 1] += share;
    w[low - k + 1] -= share;
  };
  slope(k, h10);
  slope(k + 1, h11);
  row.first = std::max(k - 1, 0);
  row.count = std::min(k + 2, knots - 1) - row.first + 1;
  for (int32_t i = 0; i < row.count; ++i) row.weight[i] = static_cast<float>(w[row.first - k + 1 + i]);
  return row;
}

}  // namespace rdm

// Noise over a plan out of few numbers: values at knots, and what stands between them.
//
// Of K knots and steps t = 0 .. H - 1, knot k stands at t_k = k (H - 1) / (K - 1):
//   zero    piecewise constant: knot floor(t K / H) holds
//   linear  between the two knots about t
//   cubic   Hermite, with slopes (p_k+1 - p_k-1) / 2, at the ends the difference to the neighbour
// (the three of predictive sampling in Howell et al. 2022). Weights of a step add up to 1; one knot is
// constant.
#pragma once
#include <cstdint>

namespace rdm {

enum class Interpolation : int32_t { kZero = 0, kLinear = 1, kCubic = 2 };

// Step t is the sum over i < count of weight[i] times knot first + i.
struct KnotRow {
  int32_t first = 0, count = 1;
  float weight[4] = {1, 0, 0, 0};
};
// 1 <= knots <= horizon, 0 <= step < horizon.
KnotRow knot_row(Interpolation kind, int32_t knots, int32_t horizon, int32_t step);

}  // namespace rdm

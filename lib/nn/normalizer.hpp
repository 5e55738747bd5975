// Running mean and standard deviation of vectors (Chan's parallel merge, double), one merge per call.
#pragma once
#include <cstdint>

#include "base/arena.hpp"

namespace rdm {

struct Normalizer {
  int32_t dim = 0;
  double count = 0;
  double *mean = nullptr, *m2 = nullptr;     // [dim]; m2: sum of squared deviations
  float *shift = nullptr, *scale = nullptr;  // [dim]: output = clip((x - shift) scale, +-clip)
  float clip = 5;
};
Normalizer carve_normalizer(Arena& arena, int32_t dim);
// Leaves the input unchanged (clipped) until two samples were merged.
void normalizer_reset(Normalizer& n);
// Merges rows whose mask is not 0 (mask null: all). x [rows][dim]. std = sqrt(m2/(count-1)) within [1e-2,
// 1e37]. With count_max > 0 the count saturates there, so that old data fade.
void normalizer_merge(Normalizer& n, const float* x, int32_t rows, const uint8_t* mask, double count_max);
// The same in two steps: moments [1 + 2 dim] of rows, their count, mean and sum of squared deviations, which
// add up pairwise; and what is merged.
void normalizer_moments(int32_t dim, const float* x, int32_t rows, const uint8_t* mask, double* moments);
void normalizer_add_moments(int32_t dim, double* moments, const double* more);
void normalizer_merge_moments(Normalizer& n, const double* moments, double count_max);
// y may be x.
void normalizer_apply(const Normalizer& n, const float* x, int32_t rows, float* y);
// shift and scale from count, mean, m2 (after a load).
void normalizer_refresh(Normalizer& n);

}  // namespace rdm

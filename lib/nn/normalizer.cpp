#include "nn/normalizer.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {

Normalizer carve_normalizer(Arena& arena, int32_t dim) {
  Normalizer n;
  n.dim = dim;
  const auto size = static_cast<size_t>(dim);
  n.mean = arena.make<double>(size);
  n.m2 = arena.make<double>(size);
  n.shift = arena.make<float>(size);
  n.scale = arena.make<float>(size);
  if (!arena.measuring()) normalizer_reset(n);
  return n;
}

void normalizer_reset(Normalizer& n) {
  n.count = 0;
  for (int32_t j = 0; j < n.dim; ++j) n.mean[j] = n.m2[j] = 0;
  normalizer_refresh(n);
}

void normalizer_refresh(Normalizer& n) {
  for (int32_t j = 0; j < n.dim; ++j) {
    const bool known = n.count > 1;
    n.shift[j] = known ? static_cast<float>(n.mean[j]) : 0;
    n.scale[j] = known ? static_cast<float>(1 / std::max(std::sqrt(n.m2[j] / (n.count - 1)), 1e-2)) : 1;
  }
}

void normalizer_merge(Normalizer& n, const float* x, int32_t rows, const uint8_t* mask, double count_max) {
  double k = 0;
  for (int32_t r = 0; r < rows; ++r) k += !mask || mask[r];
  if (k == 0) return;
  const auto dim = static_cast<size_t>(n.dim);
  const double total = n.count + k;
  for (size_t j = 0; j < dim; ++j) {
    double mean = 0, m2 = 0;
    for (size_t r = 0; r < static_cast<size_t>(rows); ++r)
      if (!mask || mask[r]) mean += static_cast<double>(x[r * dim + j]);
    mean /= k;
    for (size_t r = 0; r < static_cast<size_t>(rows); ++r)
      if (!mask || mask[r]) {
        const double d = static_cast<double>(x[r * dim + j]) - mean;
        m2 += d * d;
      }
    const double gap = mean - n.mean[j];
    n.mean[j] += gap * (k / total);
    n.m2[j] += m2 + gap * gap * (n.count * k / total);
  }
  n.count = total;
  if (count_max > 1 && total > count_max) {
    for (size_t j = 0; j < dim; ++j) n.m2[j] *= (count_max - 1) / (total - 1);
    n.count = count_max;
  }
  normalizer_refresh(n);
}

void normalizer_apply(const Normalizer& n, const float* x, int32_t rows, float* y) {
  const auto dim = static_cast<size_t>(n.dim);
  for (size_t r = 0; r < static_cast<size_t>(rows); ++r)
    for (size_t j = 0; j < dim; ++j)
      y[r * dim + j] = std::clamp((x[r * dim + j] - n.shift[j]) * n.scale[j], -n.clip, n.clip);
}

}  // namespace rdm

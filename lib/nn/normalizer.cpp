#include "nn/normalizer.hpp"

#include <algorithm>
#include <cmath>

#include "nn/kernels.hpp"

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
    // At most 1e37, so that a scale never is a denormal, which is 0 to the library.
    const double std = known ? std::clamp(std::sqrt(n.m2[j] / (n.count - 1)), 1e-2, 1e37) : 1;
    n.scale[j] = static_cast<float>(1 / std);
  }
}

namespace {

double count_rows(int32_t rows, const uint8_t* mask) {
  double k = 0;
  for (int32_t r = 0; r < rows; ++r) k += !mask || mask[r];
  return k;
}

// The gap between two means m of k and K samples moves the first one's.
void add_column(double* mean, double* m2, double count, double more_mean, double more_m2, double k) {
  const double gap = more_mean - *mean, total = count + k;
  *mean += gap * (k / total);
  *m2 += more_m2 + gap * gap * (count * k / total);
}

void finish_merge(Normalizer& n, double total, double count_max) {
  n.count = total;
  if (count_max > 1 && total > count_max) {
    for (int32_t j = 0; j < n.dim; ++j) n.m2[j] *= (count_max - 1) / (total - 1);
    n.count = count_max;
  }
  normalizer_refresh(n);
}

}  // namespace

void normalizer_moments(int32_t dim, const float* x, int32_t rows, const uint8_t* mask, double* moments) {
  std::fill_n(moments, 1 + 2 * dim, 0.0);
  moments[0] = count_rows(rows, mask);
  if (moments[0] > 0)
    kernels().column_moments(x, rows, dim, dim, mask, moments[0], moments + 1, moments + 1 + dim);
}

void normalizer_add_moments(int32_t dim, double* moments, const double* more) {
  if (more[0] == 0) return;
  for (int32_t j = 0; j < dim; ++j)
    add_column(moments + 1 + j, moments + 1 + dim + j, moments[0], more[1 + j], more[1 + dim + j], more[0]);
  moments[0] += more[0];
}

void normalizer_merge_moments(Normalizer& n, const double* moments, double count_max) {
  if (moments[0] == 0) return;
  for (int32_t j = 0; j < n.dim; ++j)
    add_column(n.mean + j, n.m2 + j, n.count, moments[1 + j], moments[1 + n.dim + j], moments[0]);
  finish_merge(n, n.count + moments[0], count_max);
}

void normalizer_merge(Normalizer& n, const float* x, int32_t rows, const uint8_t* mask, double count_max) {
  const double k = count_rows(rows, mask);
  if (k == 0) return;
  constexpr int32_t kColumns = 256;  // the batch's moments live on the stack
  double mean[kColumns], m2[kColumns];
  for (int32_t j0 = 0; j0 < n.dim; j0 += kColumns) {
    const int32_t width = std::min(kColumns, n.dim - j0);
    kernels().column_moments(x + j0, rows, width, n.dim, mask, k, mean, m2);
    for (int32_t j = 0; j < width; ++j)
      add_column(n.mean + j0 + j, n.m2 + j0 + j, n.count, mean[j], m2[j], k);
  }
  finish_merge(n, n.count + k, count_max);
}

void normalizer_apply(const Normalizer& n, const float* x, int32_t rows, float* y) {
  kernels().normalize(x, rows, n.dim, n.shift, n.scale, n.clip, y);
}

}  // namespace rdm

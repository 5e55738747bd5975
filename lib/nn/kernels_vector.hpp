// Adam, the normaliser and the Gaussian head by lanes. Part of kernels_v*.cpp, which define the lanes.
#pragma once
#include "nn/kernels_gemm.hpp"

namespace rdm {
namespace {

constexpr int kHalf = kLanes / 2;  // lanes of D
constexpr float kHalfLogTwoPi = 0.91893853320467274178f;

// Calls body(first, count) for whole lanes and once for what is left.
template <class Body>
inline void by_lanes(int32_t n, Body body) {
  int32_t j = 0;
  for (; j + kLanes <= n; j += kLanes) body(at(j), kLanes);
  if (j < n) body(at(j), n - j);
}
inline V get(const float* p, int32_t n) {
  return n == kLanes ? load(p) : load_part(p, n);
}
inline void put(float* p, V v, int32_t n) {
  if (n == kLanes)
    store(p, v);
  else
    store_part(p, v, n);
}

void column_sums(const float* x, int32_t rows, int32_t n, float* sum) {
  constexpr int32_t kWide = 4 * kLanes;
  int32_t j = 0;
  for (; j + kWide <= n; j += kWide) {
    V s[4] = {};
    for (int32_t r = 0; r < rows; ++r)
#pragma GCC unroll 4
      for (size_t v = 0; v < 4; ++v) s[v] = s[v] + load(x + at(r) * at(n) + at(j) + v * kLanes);
    for (size_t v = 0; v < 4; ++v) store(sum + at(j) + v * kLanes, s[v]);
  }
  by_lanes(n - j, [&](size_t from, int32_t count) {
    V s = {};
    for (int32_t r = 0; r < rows; ++r) s = s + get(x + at(r) * at(n) + at(j) + from, count);
    put(sum + at(j) + from, s, count);
  });
}

inline double sum_of(D v) {
  double lane[kHalf], sum = 0;
  std::memcpy(lane, &v, sizeof v);
  for (const double s : lane) sum += s;
  return sum;
}

double sum_squares(const float* x, size_t n) {
  D s[4] = {};
  size_t i = 0;
  for (; i + 4 * kHalf <= n; i += 4 * kHalf)
#pragma GCC unroll 4
    for (size_t v = 0; v < 4; ++v) {
      const D d = load_double(x + i + v * kHalf);
      s[v] = fma(d, d, s[v]);
    }
  double sum = sum_of((s[0] + s[1]) + (s[2] + s[3]));
  for (; i < n; ++i) sum += static_cast<double>(x[i]) * static_cast<double>(x[i]);
  return sum;
}

void adam(const AdamArgs& g) {
  const V scale = all(g.scale), step = all(g.step), unbias = all(g.root);
  const auto update = [&](size_t i, int32_t n) {
    const V d = get(g.grad + i, n) * scale;
    V m = get(g.m + i, n), v = get(g.v + i, n);
    m = fma(all(0.1f), d - m, m);
    v = fma(all(0.001f), d * d - v, v);
    put(g.m + i, m, n);
    put(g.v + i, v, n);
    put(g.params + i, get(g.params + i, n) - step * m / fma(root(v), unbias, all(1e-8f)), n);
  };
  size_t i = 0;
  for (; i + kLanes <= g.size; i += kLanes) update(i, kLanes);
  if (i < g.size) update(i, static_cast<int32_t>(g.size - i));
}

// Columns [j, j + width): the batch's moments in two passes. kVectors of D at a time.
template <int kVectors>
inline void moments_of(const float* x, int32_t rows, size_t n, const uint8_t* mask, double count,
                       double* mean, double* m2) {
  D m[kVectors] = {}, s[kVectors] = {};
  for (int32_t r = 0; r < rows; ++r)
    if (!mask || mask[r])
#pragma GCC unroll 4
      for (size_t v = 0; v < kVectors; ++v) m[v] = m[v] + load_double(x + at(r) * n + v * kHalf);
  for (size_t v = 0; v < kVectors; ++v) m[v] = m[v] / all_double(count);
  for (int32_t r = 0; r < rows; ++r)
    if (!mask || mask[r])
#pragma GCC unroll 4
      for (size_t v = 0; v < kVectors; ++v) {
        const D d = load_double(x + at(r) * n + v * kHalf) - m[v];
        s[v] = fma(d, d, s[v]);
      }
  std::memcpy(mean, m, sizeof m);
  std::memcpy(m2, s, sizeof s);
}

void column_moments(const float* x, int32_t rows, int32_t n, int32_t row_step, const uint8_t* mask,
                    double count, double* mean, double* m2) {
  int32_t j = 0;
  for (; j + 4 * kHalf <= n; j += 4 * kHalf)
    moments_of<4>(x + j, rows, at(row_step), mask, count, mean + j, m2 + j);
  for (; j + kHalf <= n; j += kHalf) moments_of<1>(x + j, rows, at(row_step), mask, count, mean + j, m2 + j);
  // Columns are independent, so the last lanes may cover some of them a second time.
  if (j < n && n >= kHalf) {
    j = n - kHalf;
    moments_of<1>(x + j, rows, at(row_step), mask, count, mean + j, m2 + j);
    return;
  }
  for (; j < n; ++j) {
    double m = 0, s = 0;
    for (int32_t r = 0; r < rows; ++r)
      if (!mask || mask[r]) m += static_cast<double>(x[at(r) * at(row_step) + at(j)]);
    m /= count;
    for (int32_t r = 0; r < rows; ++r)
      if (!mask || mask[r]) {
        const double d = static_cast<double>(x[at(r) * at(row_step) + at(j)]) - m;
        s += d * d;
      }
    mean[j] = m;
    m2[j] = s;
  }
}

void normalize(const float* x, int32_t rows, int32_t n, const float* shift, const float* scale, float limit,
               float* y) {
  const V top = all(limit), bottom = all(-limit);
  for (int32_t r = 0; r < rows; ++r, x += n, y += n)
    by_lanes(n, [&](size_t j, int32_t count) {
      const V u = (get(x + j, count) - get(shift + j, count)) * get(scale + j, count);
      put(y + j, low(top, high(bottom, u)), count);
    });
}

void add_noise(const float* log_std, const float* noise, int32_t rows, int32_t n, float limit, float* y) {
  for (int32_t r = 0; r < rows; ++r, y += n)
    by_lanes(n, [&](size_t j, int32_t count) {
      V a = get(y + j, count);
      if (noise) a = fma(exp_of(get(log_std + j, count)), get(noise + at(r) * at(n) + j, count), a);
      put(y + j, low(all(limit), high(all(-limit), a)), count);
    });
}

// Lanes past the end hold zeros everywhere and so add nothing.
float log_prob(const float* mean, const float* log_std, const float* action, int32_t n) {
  V sum = {};
  by_lanes(n, [&](size_t j, int32_t count) {
    const V l = get(log_std + j, count), u = (get(action + j, count) - get(mean + j, count)) * exp_of(-l);
    sum = sum - fma(all(0.5f) * u, u, l);
  });
  return sum_of(sum) - static_cast<float>(n) * kHalfLogTwoPi;
}

void log_prob_grad(const float* mean, const float* log_std, const float* action, int32_t n, float scale,
                   float* dmean, float* dlog_std) {
  by_lanes(n, [&](size_t j, int32_t count) {
    const V s = exp_of(-get(log_std + j, count)), u = (get(action + j, count) - get(mean + j, count)) * s;
    put(dmean + j, all(scale) * u * s, count);
    put(dlog_std + j, fma(all(scale), fma(u, u, all(-1.0f)), get(dlog_std + j, count)), count);
  });
}

// d + (e^-2d - 1)/2 without cancellation: a series near 0.
inline V spread_of(V d) {
  const V y = all(-2.0f) * d;
  V p = fma(all(0.5f / 3628800), y, all(0.5f / 362880));
  p = fma(p, y, all(0.5f / 40320));
  p = fma(p, y, all(0.5f / 5040));
  p = fma(p, y, all(0.5f / 720));
  p = fma(p, y, all(0.5f / 120));
  p = fma(p, y, all(0.5f / 24));
  p = fma(p, y, all(0.5f / 6));
  p = fma(p, y, all(0.25f));
  const V far = d + all(0.5f) * (exp_of(y) - all(1.0f));
  return positive(all(1.0f) - y * y, p * y * y, far);
}

float kl(const float* mean0, const float* log_std0, const float* mean1, const float* log_std1, int32_t n) {
  V sum = {};
  by_lanes(n, [&](size_t j, int32_t count) {
    const V l = get(log_std1 + j, count), d = l - get(log_std0 + j, count);
    const V u = (get(mean0 + j, count) - get(mean1 + j, count)) * exp_of(-l);
    sum = sum + fma(all(0.5f) * u, u, spread_of(d));
  });
  return sum_of(sum);
}

inline V elu_of(V z) {
  return activation_of(Activation::kElu, z);
}

template <V (*kFunction)(V)>
void map(const float* x, size_t n, float* y) {
  for (size_t i = 0; i < n; i += kLanes) {
    const int32_t count = n - i < kLanes ? static_cast<int32_t>(n - i) : kLanes;
    put(y + i, kFunction(get(x + i, count)), count);
  }
}

}  // namespace
}  // namespace rdm

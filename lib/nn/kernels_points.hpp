// What a PointNet needs beside matrix products, by lanes, and the table of all kernels. Part of
// kernels_v*.cpp, which define the lanes.
#pragma once
#include "nn/kernels_vector.hpp"

namespace rdm {
namespace {

// kVectors vectors of columns at a time. A row's number is a float, exact up to 2^24, so that one blend moves
// it beside the value.
template <int kVectors>
inline void max_columns(const float* z, int32_t rows, size_t n, float first, float* best, float* at_best) {
  V top[kVectors], where[kVectors], number = all(first);
  for (size_t v = 0; v < kVectors; ++v)
    top[v] = load(best + v * kLanes), where[v] = load(at_best + v * kLanes);
  for (int32_t r = 0; r < rows; ++r, z += n, number = number + all(1.0f))
#pragma GCC unroll 4
    for (size_t v = 0; v < kVectors; ++v) {
      const V here = load(z + v * kLanes);
      where[v] = above(here, top[v], number, where[v]);
      top[v] = above(here, top[v], here, top[v]);
    }
  for (size_t v = 0; v < kVectors; ++v)
    store(best + v * kLanes, top[v]), store(at_best + v * kLanes, where[v]);
}

void max_rows(const float* z, int32_t rows, int32_t n, float first, float* best, float* at_best) {
  int32_t j = 0;
  for (; j + 4 * kLanes <= n; j += 4 * kLanes)
    max_columns<4>(z + j, rows, at(n), first, best + j, at_best + j);
  for (; j + kLanes <= n; j += kLanes) max_columns<1>(z + j, rows, at(n), first, best + j, at_best + j);
  const int32_t left = n - j;
  if (left == 0) return;
  V top = load_part(best + j, left), where = load_part(at_best + j, left), number = all(first);
  for (int32_t r = 0; r < rows; ++r, number = number + all(1.0f)) {
    const V here = load_part(z + at(r) * at(n) + at(j), left);
    where = above(here, top, number, where);
    top = above(here, top, here, top);
  }
  store_part(best + j, top, left), store_part(at_best + j, where, left);
}

void activate(Activation a, float* x, size_t n) {
  for (size_t i = 0; i < n; i += kLanes) {
    const int32_t count = n - i < kLanes ? static_cast<int32_t>(n - i) : kLanes;
    put(x + i, activation_of(a, get(x + i, count)), count);
  }
}

void slope(Activation a, const float* h, size_t n, float* d) {
  for (size_t i = 0; i < n; i += kLanes) {
    const int32_t count = n - i < kLanes ? static_cast<int32_t>(n - i) : kLanes;
    put(d + i, get(d + i, count) * slope_of(a, get(h + i, count)), count);
  }
}

void spread_slots(const float* dz, const int32_t* slot, int32_t n, int32_t k, const float* h, const float* w,
                  float* dw, float* dh) {
  const auto add_to = [k](float s, const float* x, float* y) {
    by_lanes(k, [&](size_t i, int32_t count) {
      put(y + i, fma(all(s), get(x + i, count), get(y + i, count)), count);
    });
  };
  for (size_t j = 0; j < at(n); ++j) {
    if (dz[j] == 0) continue;
    const size_t row = at(slot[j]) * at(k);
    add_to(dz[j], h + row, dw + j * at(k));
    if (dh) add_to(dz[j], w + j * at(k), dh + row);
  }
}

void dot_slots(const int32_t* slot, int32_t n, int32_t k, const float* h, const float* v, float* y) {
  for (size_t j = 0; j < at(n); ++j) {
    V sum = {};
    by_lanes(k, [&](size_t i, int32_t count) {
      sum = fma(get(v + j * at(k) + i, count), get(h + at(slot[j]) * at(k) + i, count), sum);
    });
    y[j] += sum_of(sum);
  }
}

inline V sigmoid_of(V x) {
  return fma(all(0.5f), tanh_of(all(0.5f) * x), all(0.5f));
}

void gru_gates(const float* state_part, const float* before, int32_t rows, int32_t n, float* gates,
               float* h) {
  for (int32_t row = 0; row < rows; ++row, state_part += 3 * n, before += n, gates += 3 * n, h += n)
    by_lanes(n, [&](size_t j, int32_t count) {
      const size_t jz = j + at(n), jn = jz + at(n);
      const V r = sigmoid_of(get(gates + j, count) + get(state_part + j, count));
      const V z = sigmoid_of(get(gates + jz, count) + get(state_part + jz, count));
      const V c = tanh_of(fma(r, get(state_part + jn, count), get(gates + jn, count)));
      put(gates + j, r, count);
      put(gates + jz, z, count);
      put(gates + jn, c, count);
      put(h + j, fma(z, get(before + j, count) - c, c), count);
    });
}

void gru_slopes(const float* before, const float* dh, int32_t rows, int32_t n, float* gates,
                float* state_part, float* carry) {
  const V one = all(1.0f);
  for (int32_t row = 0; row < rows;
       ++row, before += n, dh += n, gates += 3 * n, state_part += 3 * n, carry += n)
    by_lanes(n, [&](size_t j, int32_t count) {
      const size_t jz = j + at(n), jn = jz + at(n);
      const V d = get(dh + j, count) + get(carry + j, count);
      const V r = get(gates + j, count), z = get(gates + jz, count), c = get(gates + jn, count);
      const V dc = d * (one - z) * fma(-c, c, one);
      const V dz = d * (get(before + j, count) - c) * z * (one - z);
      const V dr = dc * get(state_part + jn, count) * r * (one - r);
      put(gates + j, dr, count);
      put(gates + jz, dz, count);
      put(gates + jn, dc, count);
      put(state_part + j, dr, count);
      put(state_part + jz, dz, count);
      put(state_part + jn, dc * r, count);
      put(carry + j, d * z, count);
    });
}

void gru_tangents(const float* state_part, const float* before, const float* gates, int32_t rows, int32_t n,
                  const float* dgates, const float* dstate_part, const float* dbefore, float* dh) {
  const V one = all(1.0f);
  for (int32_t row = 0; row < rows; ++row, state_part += 3 * n, before += n, gates += 3 * n, dgates += 3 * n,
               dstate_part += 3 * n, dbefore += n, dh += n)
    by_lanes(n, [&](size_t j, int32_t count) {
      const size_t jz = j + at(n), jn = jz + at(n);
      const V r = get(gates + j, count), z = get(gates + jz, count), c = get(gates + jn, count);
      const V dr = r * (one - r) * (get(dgates + j, count) + get(dstate_part + j, count));
      const V dz = z * (one - z) * (get(dgates + jz, count) + get(dstate_part + jz, count));
      const V dc = fma(-c, c, one) * (get(dgates + jn, count) +
                                      fma(dr, get(state_part + jn, count), r * get(dstate_part + jn, count)));
      const V stays = fma(z, get(dbefore + j, count), (one - z) * dc);
      put(dh + j, fma(dz, get(before + j, count) - c, stays), count);
    });
}

// Of a build that acts and does not learn, what only learners call is left out.
#ifndef RDM_LEARNS
#define RDM_LEARNS 1
#endif
#define RDM_TO_LEARN(kernel) (RDM_LEARNS ? (kernel) : nullptr)
#define RDM_KERNEL_TABLE                                                                          \
  {                                                                                               \
    kIsa, gemm, RDM_TO_LEARN(column_sums), RDM_TO_LEARN(adam), RDM_TO_LEARN(sum_squares),         \
        RDM_TO_LEARN(column_moments), normalize, add_noise, RDM_TO_LEARN(log_prob),               \
        RDM_TO_LEARN(log_prob_grad), RDM_TO_LEARN(kl), max_rows, activate, RDM_TO_LEARN(slope),   \
        RDM_TO_LEARN(spread_slots), RDM_TO_LEARN(dot_slots), gru_gates, RDM_TO_LEARN(gru_slopes), \
        RDM_TO_LEARN(gru_tangents), RDM_TO_LEARN(map<tanh_of>), RDM_TO_LEARN(map<elu_of>),        \
        RDM_TO_LEARN(map<exp_of>)                                                                 \
  }

}  // namespace
}  // namespace rdm

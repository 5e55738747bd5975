// The contact solver of one world: block projected Gauss-Seidel over points, in whitened coordinates.
//
// With the robots' mass matrix M = L^T D L (drives and limits in it) a contact row J becomes
// z = D^-1/2 L^-T J^T: inverse inertia is the identity, a row touches only the segments of its two paths
// (a free body is one segment of six), and the velocity change of a row is z . sum, where `sum` adds up
// z x impulse of all points. Each point is one block: normal first, then both tangents together, their
// impulse kept inside the friction cone. A cone, not a pyramid: sliding is opposed along the slip and the
// angle at which a body starts to slide does not depend on its heading.
// Warm started; from kConjugateFrom points on the sweeps are sped up by the non-smooth non-linear conjugate
// gradient method (Silcowitz-Hansen, Niebe, Erleben 2010). Fixed order; at most `iterations` sweeps, for
// piles of many points up to four times as many, fewer once nothing changes any more. Part of stepper_v*.cpp.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/arena.hpp"
#include "physics/articulated/tree.hpp"

namespace rdm {
namespace {

constexpr int kConjugateFrom = 6;
constexpr int32_t kPileFactor = 4;
// Square of the relative change at which the sweeps end early, and that of a pile of more than kPile points.
constexpr double kStill = 1e-9, kPileStill = 1e-8;
constexpr int32_t kPile = 64;

template <class S>
struct ContactRows {
  typedef S Row __attribute__((vector_size(sizeof(S) * kSegment)));

  struct Point {
    S A[6];        // effective inverse mass: nn, tt, uu, nt, nu, tu
    S inverse_n;   // of nn with softness
    S inverse[3];  // of the tangents' block: tt, uu, tu
    S inverse_t;   // a step that is short enough for both tangents
    S b[3];        // wanted change of velocity
    S impulse[3];  // normal, tangents, N s
    S softness, mu;
    int32_t first, count;  // rows and segments of this point
    int32_t axes;          // 3, or 1 without friction
  };

  Point* points = nullptr;                                      // [max_points]
  Row* rows = nullptr;                                          // [max_points][2 * path_segments][3]
  int32_t* segments = nullptr;                                  // [max_points][2 * path_segments]
  Row *sum = nullptr, *before = nullptr, *direction = nullptr;  // [num_segments]
  S (*change)[3] = nullptr;                                     // [max_points]
  S (*point_direction)[3] = nullptr;
  int32_t count = 0, num_segments = 0, span = 0;  // span: most segments of a point

  void carve(Arena& arena, int32_t max_points, int32_t total_segments, int32_t path_segments) {
    const auto n = static_cast<size_t>(max_points), k = static_cast<size_t>(2 * path_segments);
    span = 2 * path_segments;
    num_segments = total_segments;
    points = arena.make<Point>(n);
    rows = arena.make<Row>(n * k * 3);
    segments = arena.make<int32_t>(n * k);
    sum = arena.make<Row>(static_cast<size_t>(total_segments));
    before = arena.make<Row>(static_cast<size_t>(total_segments));
    direction = arena.make<Row>(static_cast<size_t>(total_segments));
    change = arena.make<S[3]>(n);
    point_direction = arena.make<S[3]>(n);
  }

  void begin() {
    count = 0;
    for (int32_t s = 0; s < num_segments; ++s) sum[s] = Row{};
  }
  Point& add(S mu, S softness) {
    Point& p = points[count];
    p = Point{};
    p.mu = mu;
    p.softness = softness;
    p.first = count++ * span;
    p.axes = mu > 0 ? 3 : 1;
    return p;
  }
  // The point's rows in a segment, axis by axis.
  Row* segment_rows(Point* p, int32_t segment) {
    int32_t k = 0;
    while (k < p->count && segments[p->first + k] != segment) ++k;
    Row* r = rows + 3 * (p->first + k);
    if (k == p->count) {
      segments[p->first + p->count++] = segment;
      r[0] = r[1] = r[2] = Row{};
    }
    return r;
  }
  // After all sides are in.
  void finish(Point* p);
  void warm(Point* p, const S* impulse);
  void solve(int32_t iterations);

 private:
  static S total(const Row& r) {
    S t = 0;
    const auto halves = [&](int i) { return r[i] + r[i + 4]; };
    t = (halves(0) + halves(2)) + (halves(1) + halves(3));
    return t;
  }
  // Three totals at once, each summed in the order of total().
  static void totals(const Row* r, S* out) {
    typedef S Half __attribute__((vector_size(sizeof(S) * 4)));
    Half h[3];
    for (int f = 0; f < 3; ++f)
      h[f] =
          __builtin_shufflevector(r[f], r[f], 0, 1, 2, 3) + __builtin_shufflevector(r[f], r[f], 4, 5, 6, 7);
    // (0 + 2, 1 + 3) of rows 0 and 1 side by side, then of row 2
    const Half a =
        __builtin_shufflevector(h[0], h[1], 0, 1, 4, 5) + __builtin_shufflevector(h[0], h[1], 2, 3, 6, 7);
    const Half b =
        __builtin_shufflevector(h[2], h[2], 0, 1, 0, 1) + __builtin_shufflevector(h[2], h[2], 2, 3, 2, 3);
    out[0] = a[0] + a[1];
    out[1] = a[2] + a[3];
    out[2] = b[0] + b[1];
  }
  S sweep(S* size);
};

template <class S>
void ContactRows<S>::finish(Point* p) {
  const auto product = [&](int f, int g) {
    Row r{};
    for (int32_t k = 0; k < p->count; ++k) {
      const Row* z = rows + 3 * (p->first + k);
      r += z[f] * z[g];
    }
    return total(r);
  };
  p->A[0] = product(0, 0);
  p->inverse_n = 1 / (p->A[0] + p->softness);
  if (p->axes == 1) return;
  p->A[1] = product(1, 1);
  p->A[2] = product(2, 2);
  p->A[3] = product(0, 1);
  p->A[4] = product(0, 2);
  p->A[5] = product(1, 2);
  const S larger = p->A[1] > p->A[2] ? p->A[1] : p->A[2], across = p->A[5] < 0 ? -p->A[5] : p->A[5];
  p->inverse_t = 1 / (larger + across);
  const S determinant = p->A[1] * p->A[2] - p->A[5] * p->A[5];
  if (determinant > S(1e-6) * larger * larger) {
    const S d = 1 / determinant;
    p->inverse[0] = p->A[2] * d;
    p->inverse[1] = p->A[1] * d;
    p->inverse[2] = -p->A[5] * d;
  } else {
    p->inverse[0] = p->inverse[1] = p->inverse_t;
  }
}

template <class S>
void ContactRows<S>::warm(Point* p, const S* impulse) {
  for (int f = 0; f < p->axes; ++f) p->impulse[f] = impulse[f];
  for (int32_t k = 0; k < p->count; ++k) {
    const Row* z = rows + 3 * (p->first + k);
    Row& s = sum[segments[p->first + k]];
    for (int f = 0; f < p->axes; ++f) s += z[f] * p->impulse[f];
  }
}

// One pass over all points; the sums of squared impulse changes and of squared impulses.
template <class S>
S ContactRows<S>::sweep(S* size) {
  S moved = 0, all = 0;
  for (int32_t i = 0; i < count; ++i) {
    Point& p = points[i];
    const Row* z = rows + 3 * p.first;
    const int32_t* segment = segments + p.first;
    if (p.axes == 1) {
      Row r{};
      for (int32_t k = 0; k < p.count; ++k) r += z[3 * k] * sum[segment[k]];
      S n = p.impulse[0] + (p.b[0] - total(r) - p.softness * p.impulse[0]) * p.inverse_n;
      n = n < 0 ? S(0) : n;
      const S d = n - p.impulse[0];
      p.impulse[0] = n;
      for (int32_t k = 0; k < p.count; ++k) sum[segment[k]] += z[3 * k] * d;
      change[i][0] = d;
      change[i][1] = change[i][2] = 0;
      moved += d * d;
      all += n * n;
      continue;
    }
    Row r[3] = {};
    for (int32_t k = 0; k < p.count; ++k) {
      const Row s = sum[segment[k]];
      for (int f = 0; f < 3; ++f) r[f] += z[3 * k + f] * s;
    }
    S v[3];
    totals(r, v);
    S n = p.impulse[0] + (p.b[0] - v[0] - p.softness * p.impulse[0]) * p.inverse_n;
    n = n < 0 ? S(0) : n;
    const S d0 = n - p.impulse[0];
    const S e1 = p.b[1] - v[1] - p.A[3] * d0, e2 = p.b[2] - v[2] - p.A[4] * d0;
    // stick: both tangents at once; slip: a gradient step back onto the cone
    S t1 = p.impulse[1] + (p.inverse[0] * e1 + p.inverse[2] * e2);
    S t2 = p.impulse[2] + (p.inverse[2] * e1 + p.inverse[1] * e2);
    const S bound = p.mu * n;
    if (t1 * t1 + t2 * t2 > bound * bound) {
      t1 = p.impulse[1] + p.inverse_t * e1;
      t2 = p.impulse[2] + p.inverse_t * e2;
      const S square = t1 * t1 + t2 * t2;
      if (square > bound * bound) {
        const S shrink = bound / std::sqrt(square);
        t1 *= shrink;
        t2 *= shrink;
      }
    }
    const S d1 = t1 - p.impulse[1], d2 = t2 - p.impulse[2];
    p.impulse[0] = n;
    p.impulse[1] = t1;
    p.impulse[2] = t2;
    for (int32_t k = 0; k < p.count; ++k)
      sum[segment[k]] += z[3 * k] * d0 + z[3 * k + 1] * d1 + z[3 * k + 2] * d2;
    change[i][0] = d0;
    change[i][1] = d1;
    change[i][2] = d2;
    moved += d0 * d0 + d1 * d1 + d2 * d2;
    all += n * n + t1 * t1 + t2 * t2;
  }
  *size = all;
  return moved;
}

template <class S>
void ContactRows<S>::solve(int32_t iterations) {
  S size = 0;  // sum of squared impulses
  // weight travels from point to point, one sweep each: piles get more
  const S still = count > kPile ? S(kPileStill) : S(kStill);
  iterations = std::clamp(3 * count / 4, iterations, kPileFactor * iterations);
  if (count < kConjugateFrom) {
    for (int32_t k = 0; k < iterations; ++k) {
      const S moved = sweep(&size);
      if (moved <= still * size) return;
    }
    return;
  }
  const auto restart = [&] {
    for (int32_t s = 0; s < num_segments; ++s) direction[s] = Row{};
    for (int32_t i = 0; i < count; ++i)
      for (int f = 0; f < 3; ++f) point_direction[i][f] = 0;
  };
  restart();
  S last = 0;
  for (int32_t k = 0; k < iterations; ++k) {
    for (int32_t s = 0; s < num_segments; ++s) before[s] = sum[s];
    const S moved = sweep(&size);
    if (moved <= still * size || k + 1 == iterations) return;
    const S beta = k ? moved / last : S(0);
    last = moved;
    if (beta > 1) {
      restart();
      continue;
    }
    for (int32_t s = 0; s < num_segments; ++s) {
      const Row d = sum[s] - before[s];
      sum[s] += beta * direction[s];
      direction[s] = beta * direction[s] + d;
    }
    for (int32_t i = 0; i < count; ++i)
      for (int f = 0; f < 3; ++f) {
        points[i].impulse[f] += beta * point_direction[i][f];
        point_direction[i][f] = beta * point_direction[i][f] + change[i][f];
      }
  }
}

}  // namespace
}  // namespace rdm

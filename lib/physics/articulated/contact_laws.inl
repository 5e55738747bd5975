// Contact points with a law of their own (model/contact_law.hpp), beside the plain ones of
// contact_solver.inl, whose sums they share. Part of stepper_v*.cpp.
//
// A point has up to six rows: its normal and tangents n, t, u, the turning about n, and that about t and u,
// each stored as z = Z J^T (contact_solver.inl). The block A = J M^-1 J^T of its own rows is kept, so that an
// update reads the sums once, passes kPasses times over its unknowns against what is missing to the wanted velocities
//   e = b - z . sum,   e <- e - A d for every change d of the impulses,
// and writes the whole change once.
//   cone      n <- max(0, n + (e_n - s n) / (A_nn + s)), then (t, u) within mu n, the turning about n within
//             torsional n, and about the tangents within rolling n: pairs as in contact_solver.inl
//   pyramid   edges f_+-j >= 0 of z_n +- mu_j z_j with the wanted velocity b_n +- mu_j b_j, one by one
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/arena.hpp"
#include "physics/articulated/tree.hpp"

namespace rdm {
namespace {

template <class S>
struct LawContacts {
  typedef S Row __attribute__((vector_size(sizeof(S) * kSegment)));
  static constexpr int kAxes = 6, kEdges = 2 * (kAxes - 1), kPasses = 4;

  struct Point {
    S b[kAxes];  // wanted change of velocity
    S A[kAxes][kAxes];
    S impulse[kAxes], delta[kAxes], direction[kAxes];  // N s, N m s; of the last sweep; conjugate
    S edge[kEdges], edge_delta[kEdges], edge_direction[kEdges];
    S tangent[3];                // t, world axes
    S softness[kAxes];           // of a pyramid the first is that of all edges
    S friction[kAxes];           // -, mu, mu, torsional, rolling, rolling
    int32_t first, count, axes;  // rows and segments of this point; 1, 3, 4 or 6
    bool pyramid;
  };

  Point* points = nullptr;      // [max_points]
  Row* rows = nullptr;          // [max_points][most_segments][kAxes]
  int32_t* segments = nullptr;  // [max_points][most_segments]
  int32_t count = 0, most_segments = 0;

  void carve(Arena& arena, int32_t max_points, int32_t path_segments) {
    most_segments = 2 * path_segments;
    const auto n = static_cast<size_t>(max_points), k = static_cast<size_t>(most_segments);
    points = arena.make<Point>(n);
    rows = arena.make<Row>(n * k * kAxes);
    segments = arena.make<int32_t>(n * k);
  }
  Point& add(int32_t axes) {
    Point& p = points[count];
    p = Point{};
    p.first = count++ * most_segments;
    p.axes = axes;
    return p;
  }
  Row* segment_rows(Point* p, int32_t segment) {
    int32_t k = 0;
    while (k < p->count && segments[p->first + k] != segment) ++k;
    Row* r = rows + kAxes * (p->first + k);
    if (k == p->count) {
      segments[p->first + p->count++] = segment;
      for (int f = 0; f < kAxes; ++f) r[f] = Row{};
    }
    return r;
  }
  void prepare(Point* p) const {
    for (int f = 0; f < p->axes; ++f)
      for (int g = 0; g <= f; ++g) {
        Row r{};
        for (int32_t k = 0; k < p->count; ++k) {
          const Row* z = rows + kAxes * (p->first + k);
          r += z[f] * z[g];
        }
        p->A[f][g] = p->A[g][f] = total(r);
      }
  }
  // Impulses along the normal and the tangents to begin with.
  void warm_start(Point* p, const S* impulse, Row* sum) const;
  // As ContactSolver::sweep.
  S sweep(const S* beta, S* impulse_square, Row* sum);
  // As ContactSolver::residual; soft points have none.
  S residual() const {
    S most = 0;
    for (int32_t i = 0; i < count; ++i) {
      const Point& p = points[i];
      if (!p.pyramid) most = std::max(most, std::abs(p.delta[0]) * (p.A[0][0] + p.softness[0]));
    }
    return most;
  }

 private:
  // As ContactSolver::prepare's: along such a row nothing can be moved. 1/kg
  static constexpr S kImmovable = S(1e-6);
  static S total(const Row& r) { return ((r[0] + r[4]) + (r[2] + r[6])) + ((r[1] + r[5]) + (r[3] + r[7])); }
  static void push(const Row* z, const S* d, int axes, Row* s) {
    Row more{};
    for (int f = 0; f < axes; ++f) more += z[f] * d[f];
    *s += more;
  }
  static void change(const Point& p, int f, S d, S* e) {
    for (int g = 0; g < p.axes; ++g) e[g] -= p.A[g][f] * d;
  }
  static void pass_cone(const Point& p, S* x, S* e);
  static void pass_pyramid(const Point& p, S* x, S* edge, S* e);
  static void pass_pair(const Point& p, int f, S bound, S* x, S* e);
};

template <class S>
void LawContacts<S>::warm_start(Point* p, const S* impulse, Row* sum) const {
  if (p->pyramid) {
    const int pairs = p->axes - 1;
    const S share = impulse[0] / (2 * static_cast<S>(pairs));
    for (int j = 0; j < pairs; ++j)
      for (int side = 0; side < 2; ++side) {
        const S mu = (side ? -1 : 1) * p->friction[1 + j];
        const S f = share + (j < 2 ? impulse[1 + j] / (2 * mu) : S(0));
        S& edge = p->edge[2 * j + side];
        edge = f < 0 ? S(0) : f;
        p->impulse[0] += edge;
        p->impulse[1 + j] += mu * edge;
      }
  } else {
    for (int f = 0; f < std::min(p->axes, 3); ++f) p->impulse[f] = impulse[f];
  }
  for (int32_t k = 0; k < p->count; ++k)
    push(rows + kAxes * (p->first + k), p->impulse, p->axes, &sum[segments[p->first + k]]);
}

// Rows f and f + 1 within a circle.
template <class S>
void LawContacts<S>::pass_pair(const Point& p, int f, S bound, S* x, S* e) {
  const S tt = p.A[f][f] + p.softness[f], uu = p.A[f + 1][f + 1] + p.softness[f], tu = p.A[f][f + 1];
  const S larger = tt > uu ? tt : uu, coupling = tu < 0 ? -tu : tu;
  if (!(larger > kImmovable)) return;
  const S e0 = e[f] - p.softness[f] * x[f], e1 = e[f + 1] - p.softness[f] * x[f + 1];
  const S step = 1 / (larger + coupling), determinant = tt * uu - tu * tu;
  S a = x[f] + step * e0, b = x[f + 1] + step * e1;
  if (determinant > S(1e-6) * larger * larger) {
    const S d = 1 / determinant, y0 = x[f] + d * (uu * e0 - tu * e1), y1 = x[f + 1] + d * (tt * e1 - tu * e0);
    if (y0 * y0 + y1 * y1 <= bound * bound) a = y0, b = y1;
  }
  const S square = a * a + b * b;
  if (square > bound * bound) {
    const S shrink = bound / std::sqrt(square);
    a *= shrink;
    b *= shrink;
  }
  const S d0 = a - x[f], d1 = b - x[f + 1];
  x[f] = a;
  x[f + 1] = b;
  change(p, f, d0, e);
  change(p, f + 1, d1, e);
}

template <class S>
void LawContacts<S>::pass_cone(const Point& p, S* x, S* e) {
  const S nn = p.A[0][0];
  S n = nn > kImmovable ? x[0] + (e[0] - p.softness[0] * x[0]) / (nn + p.softness[0]) : S(0);
  n = n < 0 ? S(0) : n;
  change(p, 0, n - x[0], e);
  x[0] = n;
  if (p.axes >= 3) pass_pair(p, 1, p.friction[1] * n, x, e);
  if (p.axes >= 4) {
    const S ss = p.A[3][3], bound = p.friction[3] * n;
    S s = ss > kImmovable ? x[3] + (e[3] - p.softness[3] * x[3]) / (ss + p.softness[3]) : S(0);
    s = s > bound ? bound : s < -bound ? -bound : s;
    change(p, 3, s - x[3], e);
    x[3] = s;
  }
  if (p.axes >= 6) pass_pair(p, 4, p.friction[4] * n, x, e);
}

template <class S>
void LawContacts<S>::pass_pyramid(const Point& p, S* x, S* edge, S* e) {
  const S softness = p.softness[0];
  for (int j = 1; j < p.axes; ++j)
    for (int side = 0; side < 2; ++side) {
      const S mu = side ? -p.friction[j] : p.friction[j];
      S& f = edge[2 * (j - 1) + side];
      const S a = p.A[0][0] + 2 * mu * p.A[0][j] + mu * mu * p.A[j][j];
      if (!(a + softness > kImmovable)) continue;
      S next = f + (e[0] + mu * e[j] - softness * f) / (a + softness);
      next = next < 0 ? S(0) : next;
      const S d = next - f;
      f = next;
      x[0] += d;
      x[j] += mu * d;
      for (int g = 0; g < p.axes; ++g) e[g] -= (p.A[g][0] + mu * p.A[g][j]) * d;
    }
}

template <class S>
S LawContacts<S>::sweep(const S* beta, S* impulse_square, Row* sum) {
  S delta_square = 0, square = 0;
  for (int32_t i = 0; i < count; ++i) {
    Point& p = points[i];
    if (beta) {
      for (int f = 0; f < p.axes; ++f) {
        const S way = *beta * p.direction[f];
        p.impulse[f] += way;
        p.direction[f] = way + p.delta[f];
      }
      for (int k = 0; p.pyramid && k < 2 * (p.axes - 1); ++k) {
        const S way = *beta * p.edge_direction[k];
        p.edge[k] += way;
        p.edge_direction[k] = way + p.edge_delta[k];
      }
    }
    S x[kAxes], e[kAxes], edge[kEdges];
    std::copy_n(p.impulse, kAxes, x);
    std::copy_n(p.edge, kEdges, edge);
    for (int f = 0; f < p.axes; ++f) {
      Row r{};
      for (int32_t k = 0; k < p.count; ++k) r += rows[kAxes * (p.first + k) + f] * sum[segments[p.first + k]];
      e[f] = p.b[f] - total(r);
    }
    for (int k = 0; k < kPasses; ++k) p.pyramid ? pass_pyramid(p, x, edge, e) : pass_cone(p, x, e);
    for (int f = 0; f < p.axes; ++f) {
      p.delta[f] = x[f] - p.impulse[f];
      p.impulse[f] = x[f];
      delta_square += p.delta[f] * p.delta[f];
      square += x[f] * x[f];
    }
    for (int k = 0; p.pyramid && k < 2 * (p.axes - 1); ++k) {
      p.edge_delta[k] = edge[k] - p.edge[k];
      p.edge[k] = edge[k];
    }
    for (int32_t k = 0; k < p.count; ++k)
      push(rows + kAxes * (p.first + k), p.delta, p.axes, &sum[segments[p.first + k]]);
  }
  *impulse_square += square;
  return delta_square;
}

}  // namespace
}  // namespace rdm

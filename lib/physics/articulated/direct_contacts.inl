// A direct solve for the points of a few bodies of very different mass. Part of stepper_v*.cpp.
//
// Sweeps (contact_solver.inl) carry weight from point to point, and where a ton stands on a kilogram each of
// them moves a thousandth of it: eight sweeps do not hold it. Where free bodies that hang together by contacts
// differ by more than kExtremeRatio in mass, all of their points are therefore solved at once before the sweeps
// begin. The sweeps then find what this did not see: a robot that touches one of the bodies, and what else that
// robot touches; where there is nothing of the kind they are left out.
//
// Equations, in the coordinates Z J^T of contact_solver.inl, in which the mass matrix is the identity. Unknown is
// y = sum of z lambda over the points; u = z y - b is what a point's velocity is off by, s its softness:
//   minimise  |y|^2 / 2 + sum of psi(u),   lambda = -d psi / du,
//   psi(u) = max over |(t, u)| <= mu n of  -lambda . u - s (n^2 + |(t, u)|^2 / mu^2) / 2
// which with p = -u_n and q = mu |u_t| is
//   sticks  p >= q    (p^2 + q^2) / 2 s        slides   (p + q)^2 / 4 s        open  p <= -q    0.
// It is convex (Todorov, Convex and analytically-invertible dynamics with contacts, ICRA 2014): Newton's method
// with a line search comes to its end from everywhere, and what redundant points leave open is shared evenly.
// Two terms are taken back in turn, kOuter times: that a sliding point rises by mu |u_t| (de Saxce's correction:
// b_n less that), and that one which sticks creeps by s t / mu^2 (b_t plus that, an augmented Lagrangian).
//
// Softness. A column under a load P bends where its joints give way: n cubes of half width a stand while the
// depth at which P is carried is below pi^2 a / (8 n^2). Here a loaded point gives way by at most kYieldShare of
// the layer, which is in proportion to the things' size (kLayerShare): twenty cubes stand.
//
// Double precision, one world, no lanes: the bytes do not depend on the instruction set. An island of more than
// kMostDirect points or kMostUnknowns coordinates (six for a body) is left to the sweeps, which say where they
// do not come to an end.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/arena.hpp"

namespace rdm {
namespace {

constexpr double kExtremeRatio = 20;      // of the masses of free bodies that hang together
constexpr int32_t kMostDirect = 128;      // points of an island
constexpr int32_t kMostUnknowns = 192;    // 32 bodies; 0.15 MB of working memory
constexpr int kOuter = 10, kNewton = 30;  // at most
constexpr double kYieldShare = 0.1;

template <class Solver>
struct DirectContacts {
  using S = typename Solver::Scalar;
  using Point = typename Solver::Point;

  struct Direct {
    Point* point;
    double yield;           // m/s by which it gives way at most
    double b[3], shift[3];  // wanted, less what other points do; what is taken back
    double u[3], way[3];    // of y, and of the step along which is searched
    double lambda[3], s, mu;
  };
  Direct* points = nullptr;  // [kMostDirect]
  double* matrix = nullptr;  // [row (row + 1) / 2 + column] of kMostUnknowns
  double *y = nullptr, *step = nullptr, *column = nullptr, *other = nullptr;  // [kMostUnknowns]
  int32_t* place = nullptr;   // [segments] of each in y, -1: not in it
  int32_t* listed = nullptr;  // [kMostUnknowns] segments in y
  int32_t count = 0, num_listed = 0, unknowns = 0;

  void carve(Arena& arena, int32_t segments) {
    constexpr auto kSize = static_cast<size_t>(kMostUnknowns);
    points = arena.make<Direct>(static_cast<size_t>(kMostDirect));
    matrix = arena.make<double>(kSize * (kSize + 1) / 2);
    y = arena.make<double>(kSize);
    step = arena.make<double>(kSize);
    column = arena.make<double>(kSize);
    other = arena.make<double>(kSize);
    place = arena.make<int32_t>(static_cast<size_t>(segments));
    listed = arena.make<int32_t>(kSize);
  }
  void begin() { count = 0; }
  void add(Point* point, double yield) {
    points[count] = Direct{};
    points[count].yield = yield;
    points[count++].point = point;
  }
  // The impulses of the points that were added, which have been warm started, and the sums with them. False: there
  // is no room for them.
  bool solve(Solver* solver);

 private:
  // psi's second derivative along the axes n, t, u; lambda by the way.
  static void answer(const Direct& p, const double* u, double* lambda, double (*curvature)[3]);
  static size_t at(int32_t row, int32_t col) {
    return static_cast<size_t>(row) * (static_cast<size_t>(row) + 1) / 2 + static_cast<size_t>(col);
  }
  static int32_t width(const Solver& solver, int32_t segment) {
    return segment < solver.wide.first_segment ? kSegment : 6;
  }
  // visit(axis row of the solver, place in y, entries) for each part of a point's rows.
  template <class Visit>
  void each_part(const Solver& solver, const Direct& p, const Visit& visit) const {
    for (int32_t k = 0; k < p.point->count; ++k) {
      const int32_t segment = solver.segments[p.point->first + k];
      visit(solver.rows + 3 * (p.point->first + k), place[segment], width(solver, segment));
    }
  }
  bool place_segments(const Solver& solver);
  void begin_points(const Solver& solver);
  void project(const Solver& solver, const double* from, int32_t i, double* out) const;
  bool factorise();
  void minimise(const Solver& solver);
  double search() const;
  bool correct();
};

// Where each segment of the points stands in y; false: there is no room.
template <class Solver>
bool DirectContacts<Solver>::place_segments(const Solver& solver) {
  num_listed = unknowns = 0;
  std::fill_n(place, solver.num_segments, -1);
  for (int32_t i = 0; i < count; ++i) {
    const Point& p = *points[i].point;
    for (int32_t k = 0; k < p.count; ++k) {
      const int32_t segment = solver.segments[p.first + k];
      if (place[segment] >= 0) continue;
      if (unknowns + width(solver, segment) > kMostUnknowns) return false;
      place[segment] = unknowns;
      unknowns += width(solver, segment);
      listed[num_listed++] = segment;
    }
  }
  return true;
}

template <class Solver>
void DirectContacts<Solver>::project(const Solver& solver, const double* from, int32_t i, double* out) const {
  out[0] = out[1] = out[2] = 0;
  each_part(solver, points[i], [&](const auto* z, int32_t to, int32_t entries) {
    for (int f = 0; f < points[i].point->axes; ++f)
      for (int32_t c = 0; c < entries; ++c) out[f] += static_cast<double>(z[f][c]) * from[to + c];
  });
}

// y of the impulses that the points begin with, and b without what all others do.
template <class Solver>
void DirectContacts<Solver>::begin_points(const Solver& solver) {
  std::fill_n(y, unknowns, 0.0);
  for (int32_t i = 0; i < count; ++i) {
    Direct& p = points[i];
    p.mu = static_cast<double>(p.point->axes == 3 ? p.point->mu : S(0));
    p.s = static_cast<double>(p.point->softness);
    for (int f = 0; f < 3; ++f) p.lambda[f] = static_cast<double>(p.point->impulse[f]);
    each_part(solver, p, [&](const auto* z, int32_t to, int32_t entries) {
      for (int f = 0; f < p.point->axes; ++f)
        for (int32_t c = 0; c < entries; ++c) y[to + c] += static_cast<double>(z[f][c]) * p.lambda[f];
    });
  }
  for (int32_t k = 0; k < num_listed; ++k) {
    const int32_t segment = listed[k], to = place[segment];
    for (int32_t c = 0; c < width(solver, segment); ++c)
      other[to + c] = static_cast<double>(solver.sum[segment][c]) - y[to + c];
  }
  for (int32_t i = 0; i < count; ++i) {
    double v[3];
    project(solver, other, i, v);
    for (int f = 0; f < 3; ++f) points[i].b[f] = static_cast<double>(points[i].point->b[f]) - v[f];
  }
}

template <class Solver>
void DirectContacts<Solver>::answer(const Direct& p, const double* u, double* lambda,
                                    double (*curvature)[3]) {
  const double stiff = 1 / p.s, slip = std::sqrt(u[1] * u[1] + u[2] * u[2]), down = -u[0],
               across = p.mu * slip;
  for (int f = 0; f < 3; ++f) {
    lambda[f] = 0;
    for (int g = 0; g < 3; ++g) curvature[f][g] = 0;
  }
  if (down <= -across) return;
  if (down >= across) {
    lambda[0] = down * stiff;
    curvature[0][0] = stiff;
    for (int f = 1; f < 3; ++f) {
      lambda[f] = -p.mu * p.mu * u[f] * stiff;
      curvature[f][f] = p.mu * p.mu * stiff;
    }
    return;
  }
  const double half = 0.5 * stiff, n = (down + across) * half, e[2] = {u[1] / slip, u[2] / slip};
  const double w[3] = {-1, p.mu * e[0], p.mu * e[1]};
  lambda[0] = n;
  for (int f = 0; f < 2; ++f) lambda[1 + f] = -p.mu * n * e[f];
  for (int f = 0; f < 3; ++f)
    for (int g = 0; g < 3; ++g) curvature[f][g] = half * w[f] * w[g];
  const double turn = n * p.mu / slip;
  for (int f = 0; f < 2; ++f)
    for (int g = 0; g < 2; ++g) curvature[1 + f][1 + g] += turn * ((f == g ? 1 : 0) - e[f] * e[g]);
}

// `step` = -matrix^-1 step, by Cholesky's factorisation; false: not positive.
template <class Solver>
bool DirectContacts<Solver>::factorise() {
  for (int32_t k = 0; k < unknowns; ++k) {
    const double pivot = matrix[at(k, k)];
    if (!(pivot > 0)) return false;
    const double root = std::sqrt(pivot);
    matrix[at(k, k)] = root;
    for (int32_t i = k + 1; i < unknowns; ++i) {
      column[i] = matrix[at(i, k)] / root;
      matrix[at(i, k)] = column[i];
      if (column[i] == 0) continue;
      double* to = matrix + at(i, 0);
      for (int32_t j = k + 1; j <= i; ++j) to[j] -= column[i] * column[j];
    }
  }
  for (int32_t i = 0; i < unknowns; ++i) {
    const double* row = matrix + at(i, 0);
    double x = -step[i];
    for (int32_t j = 0; j < i; ++j) x -= row[j] * step[j];
    step[i] = x / row[i];
  }
  for (int32_t i = unknowns - 1; i >= 0; --i) {
    const double* row = matrix + at(i, 0);
    step[i] /= row[i];
    for (int32_t j = 0; j < i; ++j) step[j] -= row[j] * step[i];
  }
  return true;
}

// How far along the step the function is least: where its derivative is a tenth of what it was, or less.
template <class Solver>
double DirectContacts<Solver>::search() const {
  double along = 0, square = 0;
  for (int32_t k = 0; k < unknowns; ++k) {
    along += y[k] * step[k];
    square += step[k] * step[k];
  }
  const auto derivative = [&](double a, double* second) {
    double first = along + a * square;
    *second = square;
    for (int32_t i = 0; i < count; ++i) {
      const Direct& p = points[i];
      double u[3], lambda[3], curvature[3][3];
      for (int f = 0; f < 3; ++f) u[f] = p.u[f] + a * p.way[f];
      answer(p, u, lambda, curvature);
      for (int f = 0; f < 3; ++f) {
        first -= lambda[f] * p.way[f];
        for (int g = 0; g < 3; ++g) *second += p.way[f] * curvature[f][g] * p.way[g];
      }
    }
    return first;
  };
  double second, low = 0, high = HUGE_VAL, a = 1;
  const double start = derivative(0, &second), enough = 0.1 * std::fabs(start);
  for (int k = 0; k < 20; ++k) {
    const double slope = derivative(a, &second);
    if (std::fabs(slope) <= enough) break;
    (slope < 0 ? low : high) = a;
    a -= slope / second;
    if (a <= low || a >= high) a = high < HUGE_VAL ? 0.5 * (low + high) : 2 * low;
  }
  return a;
}

// Newton's method from y on.
template <class Solver>
void DirectContacts<Solver>::minimise(const Solver& solver) {
  constexpr double kEnd = 1e-20;  // of the squared gradient, to the squares of y
  for (int pass = 0; pass < kNewton; ++pass) {
    std::fill_n(matrix, at(unknowns, 0), 0.0);
    for (int32_t k = 0; k < unknowns; ++k) {
      matrix[at(k, k)] = 1;
      step[k] = y[k];
    }
    for (int32_t i = 0; i < count; ++i) {
      Direct& p = points[i];
      double curvature[3][3];
      project(solver, y, i, p.u);
      for (int f = 0; f < 3; ++f) p.u[f] -= p.b[f] + p.shift[f];
      answer(p, p.u, p.lambda, curvature);
      const int axes = p.point->axes;
      each_part(solver, p, [&](const auto* z, int32_t to, int32_t entries) {
        for (int f = 0; f < axes; ++f)
          for (int32_t c = 0; c < entries; ++c) step[to + c] -= static_cast<double>(z[f][c]) * p.lambda[f];
        if (curvature[0][0] == 0) return;
        each_part(solver, p, [&](const auto* x, int32_t from, int32_t others) {
          if (from > to) return;
          for (int32_t c = 0; c < entries; ++c) {
            double v[3] = {};
            for (int f = 0; f < axes; ++f)
              for (int g = 0; g < axes; ++g) v[g] += static_cast<double>(z[f][c]) * curvature[f][g];
            double* row = matrix + at(to + c, from);
            const int32_t most = from == to ? c + 1 : others;
            for (int g = 0; g < axes; ++g)
              for (int32_t d = 0; d < most; ++d) row[d] += v[g] * static_cast<double>(x[g][d]);
          }
        });
      });
    }
    double gradient = 0, size = 0;
    for (int32_t k = 0; k < unknowns; ++k) {
      gradient += step[k] * step[k];
      size += y[k] * y[k];
    }
    if (gradient <= kEnd * (1 + size) || !factorise()) return;
    for (int32_t i = 0; i < count; ++i) project(solver, step, i, points[i].way);
    const double a = search();
    for (int32_t k = 0; k < unknowns; ++k) y[k] += a * step[k];
  }
}

// What the next minimum takes back, and stiffer points where they carry much; false: nothing to speak of.
template <class Solver>
bool DirectContacts<Solver>::correct() {
  constexpr double kSpeed = 1e-6;  // m/s
  bool changed = false;
  for (int32_t i = 0; i < count; ++i) {
    Direct& p = points[i];
    const double soft =
        std::min(static_cast<double>(p.point->softness), p.lambda[0] > 0 ? p.yield / p.lambda[0] : HUGE_VAL);
    changed |= std::fabs(soft - p.s) > 0.05 * p.s;
    if (p.mu > 0) {
      const double u[2] = {p.u[1] + p.shift[1], p.u[2] + p.shift[2]};
      const double rise = -p.mu * std::sqrt(u[0] * u[0] + u[1] * u[1]) * (p.lambda[0] > 0 ? 1 : 0);
      changed |= std::fabs(rise - p.shift[0]) > kSpeed;
      p.shift[0] = rise;
      for (int f = 1; f < 3; ++f) {
        const double creep = soft / (p.mu * p.mu) * p.lambda[f];
        changed |= std::fabs(creep - p.shift[f]) > kSpeed;
        p.shift[f] = creep;
      }
    }
    p.s = soft;
  }
  return changed;
}

template <class Solver>
bool DirectContacts<Solver>::solve(Solver* solver) {
  if (!place_segments(*solver)) return false;
  begin_points(*solver);
  minimise(*solver);
  for (int outer = 1; outer < kOuter && correct(); ++outer) minimise(*solver);
  for (int32_t i = 0; i < count; ++i) {
    Point& p = *points[i].point;
    // softer points would take the sweeps away from here
    p.softness = static_cast<S>(points[i].s);
    solver->prepare(&p);
    for (int f = 0; f < p.axes; ++f) p.impulse[f] = static_cast<S>(points[i].lambda[f]);
  }
  for (int32_t k = 0; k < num_listed; ++k) {
    const int32_t segment = listed[k], from = place[segment];
    for (int32_t c = 0; c < width(*solver, segment); ++c)
      solver->sum[segment][c] = static_cast<S>(other[from + c] + y[from + c]);
  }
  // what is left, as a sweep would find it
  for (int32_t i = 0; i < count; ++i) {
    const Direct& p = points[i];
    double v[3];
    project(*solver, y, i, v);
    const double n = p.lambda[0], wrong = p.b[0] - v[0] - p.s * n;
    p.point->delta[0] = static_cast<S>(n > 0 ? wrong : std::max(wrong, 0.0)) * p.point->inv_n;
  }
  return true;
}

}  // namespace
}  // namespace rdm

// Random local problems of trust-region methods in double, and solvers that know none of the closed forms: a
// log-barrier interior-point method and a method of multipliers.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/rng.hpp"

namespace rdm::test {

using Row = std::vector<double>;
using Matrix = std::vector<Row>;

inline double inner(const Row& a, const Row& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
inline Row times(const Matrix& m, const Row& v) {
  Row out;
  for (const Row& row : m) out.push_back(inner(row, v));
  return out;
}
inline double quadratic(const Matrix& m, const Row& v) {
  return inner(v, times(m, v));
}
inline Row combine(double a, const Row& x, double b, const Row& y) {
  Row out(x.size());
  for (size_t i = 0; i < x.size(); ++i) out[i] = a * x[i] + b * y[i];
  return out;
}
inline Matrix identity(size_t n) {
  Matrix m(n, Row(n, 0.0));
  for (size_t i = 0; i < n; ++i) m[i][i] = 1;
  return m;
}
// x of m x = b, m symmetric positive definite, by Cholesky.
inline Row solve(Matrix m, Row b) {
  const size_t n = b.size();
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j <= i; ++j) {
      double sum = m[i][j];
      for (size_t k = 0; k < j; ++k) sum -= m[i][k] * m[j][k];
      m[i][j] = i == j ? std::sqrt(sum) : sum / m[j][j];
    }
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) b[i] -= m[i][k] * b[k];
    b[i] /= m[i][i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) b[i] -= m[k][i] * b[k];
    b[i] /= m[i][i];
  }
  return b;
}

struct Solved {
  Row x, p;
  double q, r, s;
};

// max g'y subject to b'y + c <= 0 and y'h y / 2 <= delta.
struct Subproblem {
  Row g, b;
  Matrix h;
  double c, delta;
  Solved solved() const {
    Solved v{solve(h, g), solve(h, b), 0, 0, 0};
    v.q = inner(g, v.x), v.r = inner(b, v.x), v.s = inner(b, v.p);
    return v;
  }
};

// 2 to 20 parameters; c up to 1.5 times what the trust region can move the cost, either way.
inline Subproblem random_subproblem(Stream& stream) {
  const auto n = 2 + static_cast<size_t>(stream.below(19));
  std::vector<float> z(n * n + 2 * n + 1);
  stream.normals(z.data(), static_cast<int>(z.size()));
  Subproblem s{Row(n), Row(n), identity(n), 0, 0};
  for (size_t i = 0; i < n; ++i) {
    s.g[i] = static_cast<double>(z[n * n + i]);
    s.b[i] = static_cast<double>(z[n * n + n + i]);
    for (size_t j = 0; j < n; ++j) {
      s.h[i][j] *= 0.1;
      for (size_t k = 0; k < n; ++k)
        s.h[i][j] +=
            static_cast<double>(z[i * n + k]) * static_cast<double>(z[j * n + k]) / static_cast<double>(n);
    }
  }
  s.delta = std::pow(10, -3 + 2 * stream.uniform());
  s.c = 1.5 * stream.signed_unit() * std::sqrt(2 * s.delta * inner(s.b, solve(s.h, s.b)));
  return s;
}

// One centring and all following: maximises weight t times g'y plus the logarithms of what the constraints
// leave, t from 1 until the gap 2 / t is `gap` of the value's scale. y is strictly feasible at first.
inline Row follow_barrier(const Subproblem& s, bool cost, double gap, Row y) {
  const size_t n = s.g.size();
  const auto room = [&](const Row& v) { return s.delta - quadratic(s.h, v) / 2; };
  const auto slack = [&](const Row& v) { return cost ? -(inner(s.b, v) + s.c) : 1.0; };
  const double scale = std::sqrt(2 * s.delta * inner(s.g, solve(s.h, s.g)));
  const auto value = [&](double t, const Row& v) {
    const double a = room(v), l = slack(v);
    return a > 0 && l > 0 ? t * inner(s.g, v) / scale + std::log(a) + (cost ? std::log(l) : 0) : -1e300;
  };
  for (double t = 1; t < 2 / gap; t *= 8) {
    for (int step = 0; step < 60; ++step) {
      const Row hy = times(s.h, y);
      const double a = room(y), l = slack(y);
      Row grad(n);
      Matrix m = s.h;
      for (size_t i = 0; i < n; ++i) {
        grad[i] = t * s.g[i] / scale - hy[i] / a - (cost ? s.b[i] / l : 0);
        for (size_t j = 0; j < n; ++j)
          m[i][j] = s.h[i][j] / a + hy[i] * hy[j] / (a * a) + (cost ? s.b[i] * s.b[j] / (l * l) : 0);
      }
      const Row move = solve(m, grad);
      const double decrement = inner(grad, move), now = value(t, y);
      double f = 1;
      while (f > 1e-12 && value(t, combine(1, y, f, move)) < now + 0.1 * f * decrement) f /= 2;
      if (f <= 1e-12) break;
      y = combine(1, y, f, move);
      if (decrement < 1e-10) break;
    }
  }
  return y;
}

// The optimum by interior points: its point, and the case as the feasible set alone decides it.
struct Optimum {
  Row y;
  int which = 0;
  double margin = 0;  // how far the case is from the next one, relative to what the region can move the cost
};
inline Optimum interior_point(const Subproblem& s, double gap = 1e-10) {
  const size_t n = s.g.size();
  Subproblem descend = s;
  for (size_t i = 0; i < n; ++i) descend.g[i] = -s.b[i];
  Optimum out;
  const Row lowest = follow_barrier(descend, false, gap, Row(n, 0.0));
  const double reach = -inner(s.b, lowest);
  out.margin = std::abs(reach - std::abs(s.c)) / reach;
  if (s.c >= 0 && s.c > reach) {
    out.y = lowest;
    return out;
  }
  out.which = s.c >= 0 ? 1 : s.c < -reach ? 3 : 2;
  // Half-way between the constraint's plane and the lowest point is inside of both constraints.
  const double f = s.c > 0 ? (1 + s.c / reach) / 2 : 0.5;
  out.y = follow_barrier(s, true, gap, combine(f, lowest, 0, lowest));
  return out;
}

// The point of b'y + c <= 0 nearest to `from` in the metric, by the method of multipliers.
inline Row nearest_point(const Matrix& metric, const Row& from, const Row& b, double c) {
  if (inner(b, from) + c <= 0) return from;
  const double stiff = 100 / inner(b, solve(metric, b));
  Matrix m = metric;
  for (size_t i = 0; i < b.size(); ++i)
    for (size_t j = 0; j < b.size(); ++j) m[i][j] += stiff * b[i] * b[j];
  const Row pull = times(metric, from);
  Row y = from;
  double u = 0;
  for (int i = 0; i < 12; ++i) {
    y = solve(m, combine(1, pull, -(stiff * c + u), b));
    u += stiff * (inner(b, y) + c);
  }
  return y;
}

}  // namespace rdm::test

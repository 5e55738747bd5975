#include "planar.hpp"

#include <cmath>

#include "lab.hpp"

namespace truth {
namespace {

using Values = std::vector<double>;

Values accelerations(const Values& a, const Values& w, double length, double mass) {
  const size_t n = a.size();
  const auto reach = [&](size_t k, size_t i) { return i < k ? length : i == k ? length / 2 : 0.0; };
  std::vector<Values> m(n, Values(n + 1));
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < n; ++j) {
      double sum = 0;
      for (size_t k = 0; k < n; ++k) sum += mass * reach(k, i) * reach(k, j);
      m[i][j] = sum * std::cos(a[i] - a[j]) + (i == j ? mass * length * length / 12 : 0);
      m[i][n] -= sum * std::sin(a[i] - a[j]) * w[j] * w[j];
    }
    for (size_t k = 0; k < n; ++k) m[i][n] -= kG * mass * reach(k, i) * std::sin(a[i]);
  }
  for (size_t i = 0; i < n; ++i)  // positive definite: no pivots
    for (size_t r = i + 1; r < n; ++r) {
      const double f = m[r][i] / m[i][i];
      for (size_t c = i; c <= n; ++c) m[r][c] -= f * m[i][c];
    }
  Values out(n);
  for (size_t i = n; i-- > 0;) {
    double sum = m[i][n];
    for (size_t j = i + 1; j < n; ++j) sum -= m[i][j] * out[j];
    out[i] = sum / m[i][i];
  }
  return out;
}

}  // namespace

PlanarState planar_chain(const std::vector<double>& q0, double length, double mass, double seconds) {
  const size_t n = q0.size();
  Values a = q0, w(n);
  for (size_t i = 1; i < n; ++i) a[i] += a[i - 1];
  const double h = 1e-4;
  const auto along = [](Values x, const Values& d, double s) {
    for (size_t i = 0; i < x.size(); ++i) x[i] += s * d[i];
    return x;
  };
  for (int k = 0, steps = static_cast<int>(std::lround(seconds / h)); k < steps; ++k) {
    const Values a1 = w, w1 = accelerations(a, w, length, mass);
    const Values a2 = along(w, w1, h / 2), w2 = accelerations(along(a, a1, h / 2), a2, length, mass);
    const Values a3 = along(w, w2, h / 2), w3 = accelerations(along(a, a2, h / 2), a3, length, mass);
    const Values a4 = along(w, w3, h), w4 = accelerations(along(a, a3, h), a4, length, mass);
    for (size_t i = 0; i < n; ++i) {
      a[i] += h / 6 * (a1[i] + 2 * a2[i] + 2 * a3[i] + a4[i]);
      w[i] += h / 6 * (w1[i] + 2 * w2[i] + 2 * w3[i] + w4[i]);
    }
  }
  PlanarState s{a, w};
  for (size_t i = n; i-- > 1;) s.q[i] -= s.q[i - 1], s.qd[i] -= s.qd[i - 1];
  return s;
}

}  // namespace truth

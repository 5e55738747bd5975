// Vectors, turns, poses and moments of inertia of the readers: double. Arrays have quaternions as (x, y, z, w).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "base/vec.hpp"

namespace rdm::import {

using V3 = Vec3;
using Turn = Quat;  // its operators, norm, dot and cross are base's

// `otherwise` for what has no direction.
inline V3 unit(V3 a, V3 otherwise = {0, 0, 1}) {
  const double n = norm(a);
  return n > 1e-12 ? (1 / n) * a : otherwise;
}

inline Turn back(Turn q) {
  return conjugate(q);
}
inline V3 operator*(Turn q, V3 v) {
  return rotate(q, v);
}
// The least turn from one unit vector to another.
inline Turn turn_between(V3 a, V3 b) {
  const double c = dot(a, b);
  if (c < -1 + 1e-12) return axis_angle(unit(cross(a, std::abs(a.x) < 0.7 ? V3{1, 0, 0} : V3{0, 1, 0})), kPi);
  const V3 v = cross(a, b);
  return normalized(Turn{1 + c, v.x, v.y, v.z});
}

struct Pose {
  V3 p;
  Turn q;
};
inline Pose operator*(const Pose& a, const Pose& b) {
  return {a.p + a.q * b.p, normalized(a.q * b.q)};
}
inline V3 operator*(const Pose& a, V3 v) {
  return a.p + a.q * v;
}
inline Pose back(const Pose& a) {
  return {back(a.q) * (-1 * a.p), back(a.q)};
}

using M3 = std::array<std::array<double, 3>, 3>;
inline M3 matrix(Turn q) {
  const V3 x = q * V3{1, 0, 0}, y = q * V3{0, 1, 0}, z = q * V3{0, 0, 1};
  return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
}
// Of an orthonormal right-handed matrix.
inline Turn turn_of(const M3& m) {
  const double t = m[0][0] + m[1][1] + m[2][2];
  if (t > 0) {
    const double s = 2 * std::sqrt(t + 1);
    return normalized(Turn{s / 4, (m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s});
  }
  const int i = m[0][0] > m[1][1] && m[0][0] > m[2][2] ? 0 : m[1][1] > m[2][2] ? 1 : 2;
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const auto at = [&](int a, int b) { return m[static_cast<size_t>(a)][static_cast<size_t>(b)]; };
  const double s = 2 * std::sqrt(std::max(1 + at(i, i) - at(j, j) - at(k, k), 1e-12));
  V3 v;
  v[i] = s / 4;
  v[j] = (at(j, i) + at(i, j)) / s;
  v[k] = (at(k, i) + at(i, k)) / s;
  return normalized(Turn{(at(k, j) - at(j, k)) / s, v.x, v.y, v.z});
}
inline M3 times(const M3& a, const M3& b) {
  M3 out{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t k = 0; k < 3; ++k)
      for (size_t j = 0; j < 3; ++j) out[i][j] += a[i][k] * b[k][j];
  return out;
}
inline M3 transposed(const M3& a) {
  M3 out{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) out[i][j] = a[j][i];
  return out;
}
// R m R^T
inline M3 turned(Turn q, const M3& m) {
  const M3 r = matrix(q);
  return times(times(r, m), transposed(r));
}
// Eigenvalues of a symmetric matrix and its eigenvectors as columns, right-handed (Jacobi).
inline std::array<double, 3> principal(M3 m, M3* axes) {
  M3 v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < 40; ++sweep)
    for (size_t p = 0; p < 2; ++p)
      for (size_t q = p + 1; q < 3; ++q) {
        if (m[p][q] == 0) continue;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        if (!std::isfinite(t)) continue;
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        M3 r{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
        r[p][p] = r[q][q] = c;
        r[p][q] = s;
        r[q][p] = -s;
        m = times(times(transposed(r), m), r);
        m[p][q] = m[q][p] = 0;
        v = times(v, r);
      }
  const V3 x{v[0][0], v[1][0], v[2][0]}, y{v[0][1], v[1][1], v[2][1]}, z = cross(x, y);
  for (size_t i = 0; i < 3; ++i) v[i][2] = z[static_cast<int>(i)];
  if (axes) *axes = v;
  return {m[0][0], m[1][1], m[2][2]};
}

// Mass, its centre, and moments about the centre, in one frame's axes.
struct Mass {
  double mass = 0;
  V3 com;
  M3 moment{};
};
inline M3 point_moment(double mass, V3 r) {
  M3 out{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out[static_cast<size_t>(i)][static_cast<size_t>(j)] = mass * ((i == j ? dot(r, r) : 0) - r[i] * r[j]);
  return out;
}
inline M3 operator+(const M3& a, const M3& b) {
  M3 out{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) out[i][j] = a[i][j] + b[i][j];
  return out;
}
inline Mass operator*(const Pose& X, const Mass& m) {
  return {m.mass, X * m.com, turned(X.q, m.moment)};
}
inline Mass operator+(const Mass& a, const Mass& b) {
  const double mass = a.mass + b.mass;
  if (mass <= 0) return {0, {}, a.moment + b.moment};
  const V3 com = (1 / mass) * (a.mass * a.com + b.mass * b.com);
  return {mass, com,
          a.moment + b.moment + point_moment(a.mass, a.com - com) + point_moment(b.mass, b.com - com)};
}

inline V3 vec(const double* v) {
  return {v[0], v[1], v[2]};
}
inline Turn turn(const double* q) {
  return {q[3], q[0], q[1], q[2]};
}
inline void put(V3 v, double* out) {
  out[0] = v.x, out[1] = v.y, out[2] = v.z;
}
inline void put(Turn q, double* out) {
  out[0] = q.x, out[1] = q.y, out[2] = q.z, out[3] = q.w;
}

}  // namespace rdm::import

// Small fixed-size geometry: vectors, quaternions (w, x, y, z), rotation matrices, poses. Double, SI.
//
// Frames are written in monogram notation: p_WB is the position of B's origin in W, R_WB and q_WB turn
// coordinates of B into coordinates of W, X_WB is the pose that holds both.
#pragma once
#include <cmath>

#include "base/elementary.hpp"

namespace rdm {

inline constexpr double kPi = 3.14159265358979323846, kDegree = kPi / 180;  // rad

struct Vec3 {
  double x = 0, y = 0, z = 0;
  constexpr double& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  constexpr double operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  Vec3& operator+=(const Vec3& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
  Vec3& operator-=(const Vec3& b) { return *this = {x - b.x, y - b.y, z - b.z}; }
};
inline Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator-(const Vec3& a) {
  return {-a.x, -a.y, -a.z};
}
inline Vec3 operator*(double s, const Vec3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Vec3 operator*(const Vec3& a, double s) {
  return s * a;
}
inline double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(const Vec3& a) {
  return std::sqrt(dot(a, a));
}
inline Vec3 normalized(const Vec3& a) {
  return (1 / norm(a)) * a;
}
inline bool finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

struct Quat {
  double w = 1, x = 0, y = 0, z = 0;
};
inline Quat operator*(const Quat& a, const Quat& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
inline Quat conjugate(const Quat& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
inline Quat normalized(const Quat& q) {
  const double s = 1 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {s * q.w, s * q.x, s * q.y, s * q.z};
}
// Turn by `angle` rad about the unit vector `axis`.
inline Quat axis_angle(const Vec3& axis, double angle) {
  const elementary::SinCos half = elementary::sincos(0.5 * angle);
  return {half.cos, half.sin * axis.x, half.sin * axis.y, half.sin * axis.z};
}
// R = Rz(rpy.z) Ry(rpy.y) Rx(rpy.x): fixed axes, rad.
inline Quat from_rpy(const Vec3& rpy) {
  return axis_angle({0, 0, 1}, rpy.z) * axis_angle({0, 1, 0}, rpy.y) * axis_angle({1, 0, 0}, rpy.x);
}
inline Vec3 rotate(const Quat& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2 * cross(u, v);
  return v + q.w * t + cross(u, t);
}

// Row-major rotation (or inertia) matrix.
struct Mat3 {
  double m[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double operator()(int r, int c) const { return m[3 * r + c]; }
  double& operator()(int r, int c) { return m[3 * r + c]; }
  Vec3 col(int c) const { return {m[c], m[3 + c], m[6 + c]}; }
};
inline Vec3 operator*(const Mat3& a, const Vec3& v) {
  return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z, a.m[3] * v.x + a.m[4] * v.y + a.m[5] * v.z,
          a.m[6] * v.x + a.m[7] * v.y + a.m[8] * v.z};
}
inline Mat3 operator*(const Mat3& a, const Mat3& b) {
  Mat3 o;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) o(r, c) = a(r, 0) * b(0, c) + a(r, 1) * b(1, c) + a(r, 2) * b(2, c);
  return o;
}
inline Mat3 transpose(const Mat3& a) {
  return {{a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}
inline Mat3 to_matrix(const Quat& q) {
  return {{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z), 2 * (q.x * q.z + q.w * q.y),
           2 * (q.x * q.y + q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.w * q.x),
           2 * (q.x * q.z - q.w * q.y), 2 * (q.y * q.z + q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)}};
}

// The unit quaternion of a rotation matrix.
inline Quat to_quat(const Mat3& r) {
  const double trace = r.m[0] + r.m[4] + r.m[8];
  if (trace > 0) return normalized(Quat{1 + trace, r.m[7] - r.m[5], r.m[2] - r.m[6], r.m[3] - r.m[1]});
  if (r.m[0] >= r.m[4] && r.m[0] >= r.m[8])
    return normalized(Quat{r.m[7] - r.m[5], 1 + r.m[0] - r.m[4] - r.m[8], r.m[1] + r.m[3], r.m[2] + r.m[6]});
  if (r.m[4] >= r.m[8])
    return normalized(Quat{r.m[2] - r.m[6], r.m[1] + r.m[3], 1 + r.m[4] - r.m[0] - r.m[8], r.m[5] + r.m[7]});
  return normalized(Quat{r.m[3] - r.m[1], r.m[2] + r.m[6], r.m[5] + r.m[7], 1 + r.m[8] - r.m[0] - r.m[4]});
}

struct Pose {
  Vec3 p;
  Quat q;
};
inline Pose operator*(const Pose& a, const Pose& b) {
  return {a.p + rotate(a.q, b.p), a.q * b.q};
}
inline Vec3 operator*(const Pose& a, const Vec3& v) {
  return a.p + rotate(a.q, v);
}
// The pose after `h` s of the steady velocities v and w, world axes.
inline Pose moved(const Pose& a, const Vec3& v, const Vec3& w, double h) {
  const double rate = norm(w);
  if (rate == 0) return {a.p + h * v, a.q};
  return {a.p + h * v, normalized(axis_angle((1 / rate) * w, h * rate) * a.q)};
}
inline Pose inverse(const Pose& a) {
  const Quat c = conjugate(a.q);
  return {-rotate(c, a.p), c};
}

}  // namespace rdm

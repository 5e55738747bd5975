// Four vectors side by side: the ray caster follows four rays at once.
#pragma once
#include "base/simd.hpp"

namespace rdm {

struct Lanes3 {
  Float4 x, y, z;
};
inline Lanes3 splat(float x, float y, float z) {
  return {splat(x), splat(y), splat(z)};
}
inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Lanes3 operator*(Float4 s, const Lanes3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Lanes3 operator*(const Lanes3& a, const Lanes3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline Float4 dot(const Lanes3& a, const Lanes3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Lanes3 normalized(const Lanes3& a) {
  return (1.0f / sqrt(dot(a, a))) * a;
}
inline Lanes3 select(Int4 m, const Lanes3& a, const Lanes3& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
inline Lanes3 min(const Lanes3& a, const Lanes3& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
inline Lanes3 max(const Lanes3& a, const Lanes3& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
inline Lanes3 mix(const Lanes3& a, const Lanes3& b, Float4 t) {
  return a + t * (b - a);
}

}  // namespace rdm

// Four floats side by side: the ray caster follows four rays at once, with the compiler's vector types.
//
// Every operation is the IEEE operation of each lane, so results do not depend on the instruction set.
#pragma once
#include <cmath>
#include <cstdint>

namespace rdm {

inline constexpr int kLanes = 4;
using Float4 = float __attribute__((vector_size(16)));
using LaneMask = int32_t __attribute__((vector_size(16)));  // -1: true, 0: false; also four integers

inline Float4 splat(float v) {
  return Float4{v, v, v, v};
}
inline LaneMask splat_int(int32_t v) {
  return LaneMask{v, v, v, v};
}
inline Float4 select(LaneMask m, Float4 a, Float4 b) {
  return m ? a : b;
}
inline LaneMask select(LaneMask m, LaneMask a, LaneMask b) {
  return m ? a : b;
}
inline Float4 min(Float4 a, Float4 b) {
  return a < b ? a : b;
}
inline Float4 max(Float4 a, Float4 b) {
  return a > b ? a : b;
}
inline Float4 clamp(Float4 v, float lo, float hi) {
  return min(max(v, splat(lo)), splat(hi));
}
inline Float4 abs(Float4 v) {
  return max(v, -v);
}
inline Float4 sqrt(Float4 v) {
  return Float4{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])};
}
inline bool any(LaneMask m) {
  return (m[0] | m[1] | m[2] | m[3]) != 0;
}
inline float largest(Float4 v) {
  const float a = v[0] > v[1] ? v[0] : v[1], b = v[2] > v[3] ? v[2] : v[3];
  return a > b ? a : b;
}

// Four vectors.
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
inline Lanes3 select(LaneMask m, const Lanes3& a, const Lanes3& b) {
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

// Four floats side by side: the ray caster follows four rays at once, with the compiler's vector types.
//
// Every operation is the IEEE operation of each lane, so results do not depend on the instruction set.
#pragma once
#include <cmath>
#include <cstdint>

namespace rdm {

inline constexpr int kLanes = 4;
using Lanes = float __attribute__((vector_size(16)));
using LaneMask = int32_t __attribute__((vector_size(16)));  // -1: true, 0: false; also four integers

inline Lanes splat(float v) {
  return Lanes{v, v, v, v};
}
inline LaneMask splat_int(int32_t v) {
  return LaneMask{v, v, v, v};
}
inline Lanes select(LaneMask m, Lanes a, Lanes b) {
  return m ? a : b;
}
inline LaneMask select(LaneMask m, LaneMask a, LaneMask b) {
  return m ? a : b;
}
inline Lanes min(Lanes a, Lanes b) {
  return a < b ? a : b;
}
inline Lanes max(Lanes a, Lanes b) {
  return a > b ? a : b;
}
inline Lanes clamp(Lanes v, float lo, float hi) {
  return min(max(v, splat(lo)), splat(hi));
}
inline Lanes abs(Lanes v) {
  return max(v, -v);
}
inline Lanes sqrt(Lanes v) {
  return Lanes{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])};
}
inline bool any(LaneMask m) {
  return (m[0] | m[1] | m[2] | m[3]) != 0;
}
inline float largest(Lanes v) {
  const float a = v[0] > v[1] ? v[0] : v[1], b = v[2] > v[3] ? v[2] : v[3];
  return a > b ? a : b;
}

// Four vectors.
struct Lanes3 {
  Lanes x, y, z;
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
inline Lanes3 operator*(Lanes s, const Lanes3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Lanes3 operator*(const Lanes3& a, const Lanes3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline Lanes dot(const Lanes3& a, const Lanes3& b) {
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
inline Lanes3 mix(const Lanes3& a, const Lanes3& b, Lanes t) {
  return a + t * (b - a);
}

}  // namespace rdm

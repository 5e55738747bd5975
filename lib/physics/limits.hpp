// Bounds on the numbers of a world's state, the same for every engine: what a setter or a loaded state may
// bring, and beyond which a step counts as diverged.
#pragma once
#include <cfloat>
#include <cmath>

#include "base/vec.hpp"

namespace rdm {

inline constexpr double kStateBound = 1e6;        // m, m/s, rad/s: of free bodies and bases
inline constexpr double kRateBound = 1e6;         // rad/s, m/s: of joints
inline constexpr double kMaxBodyTurn = 3;         // rad in a substep: free bodies are slowed to it
inline constexpr double kMomentumBound = 1e12;    // kg m2/s, N s: of links, and of contacts' impulses
inline constexpr double kFeedforwardBound = 1e9;  // N m, N: of what is added to a drive; efforts end at 1e7
inline constexpr double kUnitTolerance = 0.01;    // of the square of a unit quaternion's length

inline bool bounded(double x, double bound) {  // false for NaN
  return std::fabs(x) < bound;
}
inline bool bounded(const Vec3& v) {
  return bounded(v.x, kStateBound) && bounded(v.y, kStateBound) && bounded(v.z, kStateBound);
}
// Outputs (torques, forces) have no bound of their own: they must not become infinite in a host's float.
inline bool fits_float(const Vec3& v) {
  return bounded(v.x, FLT_MAX) && bounded(v.y, FLT_MAX) && bounded(v.z, FLT_MAX);
}
inline bool is_unit(const Quat& q) {
  return std::fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < kUnitTolerance;
}

}  // namespace rdm

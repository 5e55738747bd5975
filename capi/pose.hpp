// Vectors and poses across the ABI, where a quaternion is (x, y, z, w).
#pragma once
#include "base/error.hpp"
#include "base/vec.hpp"
#include "redman/base.h"

namespace rdm::capi {

inline Vec3 vec(const double v[3]) {
  return {v[0], v[1], v[2]};
}
inline void put(const Vec3& v, double out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = v[k];
}
inline rdm_pose to_abi(const Pose& X) {
  return {{X.p.x, X.p.y, X.p.z}, {X.q.x, X.q.y, X.q.z, X.q.w}};
}
// A q of all 0 is no rotation.
inline Pose from_abi(const rdm_pose& X) {
  const double* q = X.q;
  if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0) return {vec(X.p), {}};
  return {vec(X.p), {q[3], q[0], q[1], q[2]}};
}
// Turned to unit length.
inline Pose need_pose(const rdm_pose* X, const char* name) {
  if (!X) fail(Code::kArgument, "%s is NULL", name);
  const Pose out = from_abi(*X);
  const Quat& q = out.q;
  const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (!finite(out.p) || !(square > 0.99 && square < 1.01))
    fail(Code::kArgument, "%s: it is not finite, or its quaternion does not have length 1", name);
  return {out.p, normalized(q)};
}

}  // namespace rdm::capi

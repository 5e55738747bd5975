// ODE's numbers and ours: the only place that knows ODE's layouts.
//
// ODE keeps quaternions as (w, x, y, z) and rotation matrices as three rows of four. Poses are written
// through the pointers ODE hands out, because its setters renormalise and so change the last bit.
#pragma once
#include <ode/ode.h>

#include "base/vec.hpp"

namespace rdm {

inline Vec3 from_ode(const dReal* v) {
  return {v[0], v[1], v[2]};
}
inline Quat quat_from_ode(const dReal* q) {
  return {q[0], q[1], q[2], q[3]};
}
inline Mat3 mat_from_ode(const dReal* r) {
  return {{r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10]}};
}
inline void to_ode(const Vec3& v, dReal* out) {
  out[0] = v.x, out[1] = v.y, out[2] = v.z;
}
inline void to_ode(const Quat& q, dReal* out) {
  out[0] = q.w, out[1] = q.x, out[2] = q.y, out[3] = q.z;
}
inline void to_ode(const Mat3& r, dReal* out) {
  for (int i = 0; i < 3; ++i) {
    out[4 * i] = r(i, 0);
    out[4 * i + 1] = r(i, 1);
    out[4 * i + 2] = r(i, 2);
    out[4 * i + 3] = 0;
  }
}

// Exact bits of a body's pose and velocity. The position goes last and through the setter, which tells
// the geoms that they moved.
inline void write_pose(dBodyID body, const Vec3& p, const Quat& q, const Mat3& r) {
  to_ode(q, const_cast<dReal*>(dBodyGetQuaternion(body)));
  to_ode(r, const_cast<dReal*>(dBodyGetRotation(body)));
  dBodySetPosition(body, p.x, p.y, p.z);
}
inline void write_velocity(dBodyID body, const Vec3& v, const Vec3& w) {
  to_ode(v, const_cast<dReal*>(dBodyGetLinearVel(body)));
  to_ode(w, const_cast<dReal*>(dBodyGetAngularVel(body)));
}

}  // namespace rdm

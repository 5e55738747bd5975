// What a joint is, across the ABI.
#pragma once
#include <limits>

#include "redman/pool.h"

namespace rdm::capi {

// Of a row of a robot's table, or a joint of a scene: their members have the same names.
template <class Joint>
rdm_joint_info joint_info(const Joint& j, bool coupled) {
  rdm_joint_info o{};
  o.kind = static_cast<int32_t>(j.kind);
  o.lower = j.lower;
  o.upper = j.upper;
  o.velocity = j.velocity > 0 ? j.velocity : std::numeric_limits<double>::quiet_NaN();
  o.kp = coupled ? 0 : j.kp;
  o.kd = j.kd;
  o.effort = j.effort;
  return o;
}

}  // namespace rdm::capi

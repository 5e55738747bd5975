#include "physics/model/drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rdm {

double coupled_target(const JointDef& joint, double q, double q_other) {
  const double middle = joint.ratio * q_other;
  const double near = std::clamp(q, middle - joint.slack, middle + joint.slack);
  return std::clamp(near, joint.lower, joint.upper);
}

MotorRow motor_row(const JointDef& joint, const SolverDef& solver, double q, double qd, double target,
                   double feedforward) {
  double kp = joint.kp, force = joint.effort + joint.friction;
  double spring = kp * (target - q) + feedforward;
  if (solver.spring_only_effort) {
    if (std::fabs(spring) > joint.effort) {
      const double share = joint.effort / std::fabs(spring);
      spring *= share;
      kp *= share;
    }
    force = std::numeric_limits<double>::infinity();
  }
  const double beyond = q < joint.lower ? joint.lower - q : q > joint.upper ? joint.upper - q : 0;
  if (joint.friction > 0 && kp == 0 && spring == 0 && beyond == 0) {
    const double damping = joint.kd * std::fabs(qd), stick = joint.friction / kStickSpeed + joint.kd;
    return {0, 1 / stick, joint.friction + std::min(damping, force - joint.friction), stick};
  }
  double gain = drive_gain(solver.h, kp, joint.kd) + joint.friction / std::max(std::fabs(qd), kFrictionSpeed);
  if (gain <= 0 && spring != 0) gain = kLeastGain;
  if (beyond != 0 && solver.limit_stiffness > 0) {
    const double limited = spring + solver.limit_stiffness * beyond;
    const double limited_gain = gain + std::max(solver.h, kLimitTime) * solver.limit_stiffness;
    const double difference = limited / limited_gain - (gain > 0 ? spring / gain : 0);
    if (difference * beyond > 0) {
      spring = limited;
      gain = limited_gain;
      force += kLimitForce;
    }
  }
  if (gain <= 0) return {};
  return {spring / gain, 1 / gain, force, gain};
}

double motor_torque(const MotorRow& row, double qd_after) {
  return std::clamp(row.gain * (row.velocity - qd_after), -row.force, row.force);
}

}  // namespace rdm

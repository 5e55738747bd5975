// What the motor row of a joint is told for one substep: implicit PD, soft limit, dry friction, coupling.
//
// A row pulls the joint's rate towards `velocity` with softness `cfm` and at most `force`. With
// D = h kp + kd, velocity = kp (target - q) / D and cfm = 1 / D the row's impulse is that of the PD law at the end
// of the substep: stable at any gain, and damped by h kp more than configured, which more substeps take away. A
// feed-forward torque F adds to the spring: velocity = (kp (target - q) + F) / D; where there is no gain to divide
// by, kLeastGain stands in.
//
// Engine ode has one row a joint. Dry friction of a joint that nothing drives is that row, which sticks; beside a
// drive it is a secant in D, viscous below kFrictionSpeed. A coupling is one-way there: the other joint feels
// nothing. Engine articulated has rows for both (joint_limits.inl).
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

struct MotorRow {
  double velocity = 0;  // rad/s (m/s)
  double cfm = 0;       // as ODE's motor parameter takes it (ODE divides by h itself)
  double force = 0;     // N m (N); 0: the row is absent
  double gain = 0;      // D, N m s/rad
};

// The place a coupled joint is driven to, within its own range.
double coupled_target(const JointDef& joint, double q, double q_other);

// The limit spring replaces the drive only where it drives inward faster; it may add kLimitForce.
MotorRow motor_row(const JointDef& joint, const SolverDef& solver, double q, double qd, double target,
                   double feedforward = 0);

// Torque that the row's law gives at the rate the substep ended with.
double motor_torque(const MotorRow& row, double qd_after);

inline constexpr double kLimitForce = 10;   // N m
inline constexpr double kLeastGain = 1e-6;  // N m s/rad: of a drive that is a torque alone
inline constexpr double kFrictionSpeed =
    0.1;                                     // rad/s below which dry friction beside a drive acts as viscous
inline constexpr double kStickSpeed = 2e-5;  // rad/s at which friction that sticks gives all it has
inline constexpr double kLimitTime = 1.0 / 120;  // s, damping of a limit over its stiffness, at least
// Gain of the PD law, N m s/rad.
inline double drive_gain(double h, double kp, double kd) {
  return h * kp + kd;
}

}  // namespace rdm

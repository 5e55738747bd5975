#include <gtest/gtest.h>

#include <cmath>

#include "physics/model/drive.hpp"

namespace rdm {
namespace {

JointDef finger() {
  JointDef joint;
  joint.axis = {1, 0, 0};
  joint.lower = 0;
  joint.upper = 1.5;
  joint.kp = 1;
  joint.kd = 0.1;
  joint.effort = 0.9;
  return joint;
}

// One substep of a lone inertia under the row: the rate at which the row's torque, the bound included,
// explains the change of momentum.
double stepped(const MotorRow& row, double inertia, double h, double qd) {
  const double free = (row.velocity * row.gain * h + inertia * qd) / (inertia + row.gain * h);
  const double torque = row.gain * (row.velocity - free);
  if (std::fabs(torque) <= row.force) return free;
  return qd + h * std::copysign(row.force, torque) / inertia;
}

TEST(Drive, IsImplicitPd) {
  const SolverDef solver;
  const JointDef joint = finger();
  const double h = solver.h, inertia = 1e-4, q = 0.5, qd = 2, target = 0.9;
  const MotorRow row = motor_row(joint, solver, q, qd, target);
  const double after = stepped(row, inertia, h, qd);
  // I (qd' - qd) / h = kp (target - q - h qd') - kd qd'
  const double law = joint.kp * (target - q - h * after) - joint.kd * after;
  EXPECT_NEAR(inertia * (after - qd) / h, law, 1e-12);
  EXPECT_NEAR(motor_torque(row, after), law, 1e-12);
  EXPECT_EQ(row.force, joint.effort);
}

TEST(Drive, SettlesAtAnyGain) {
  const SolverDef solver;
  JointDef joint = finger();
  for (const double kp : {0.1, 1.0, 100.0, 1e5}) {
    joint.kp = kp;
    joint.kd = 0.1 * kp;
    joint.effort = 1e9;
    double q = 0.1, qd = 0;
    for (int i = 0; i < 240; ++i) {
      qd = stepped(motor_row(joint, solver, q, qd, 1), 1e-5, solver.h, qd);
      q += solver.h * qd;
      ASSERT_LT(q, 1.01) << kp;
    }
    EXPECT_NEAR(q, 1, 1e-3) << kp;
  }
}

TEST(Drive, TorqueIsBounded) {
  const MotorRow row = motor_row(finger(), SolverDef(), 0, 0, 1.5);
  EXPECT_EQ(motor_torque(row, 0), 0.9);
  EXPECT_EQ(motor_torque(row, 1e3), -0.9);
}

TEST(Drive, LimitSpringOnlyWhereItDrivesInwardFaster) {
  const SolverDef solver;
  const JointDef joint = finger();
  const MotorRow inside = motor_row(joint, solver, 0.5, 0, 0.5);
  EXPECT_EQ(inside.velocity, 0);
  // Beyond the range, the drive holding it there: the spring acts.
  const MotorRow beyond = motor_row(joint, solver, 1.51, 0, 1.5);
  EXPECT_LT(beyond.velocity, -0.5);
  EXPECT_EQ(beyond.force, joint.effort + kLimitForce);
  // Beyond the range, the drive already pulling inward faster than the spring would: the drive stays.
  const MotorRow leaving = motor_row(joint, solver, 1.501, 0, 0);
  EXPECT_EQ(leaving.force, joint.effort);
  // Same at the low end, mirrored.
  EXPECT_GT(motor_row(joint, solver, -0.01, 0, 0).velocity, 0.5);
  EXPECT_EQ(motor_row(joint, solver, -0.001, 0, 1.5).force, joint.effort);
}

TEST(Drive, NoDriveNoRow) {
  JointDef joint = finger();
  joint.kp = joint.kd = 0;
  EXPECT_EQ(motor_row(joint, SolverDef(), 0.5, 1, 1).force, 0);
  EXPECT_GT(motor_row(joint, SolverDef(), 1.6, 1, 1).force, 0);  // the limit remains
}

TEST(Drive, DryFrictionOpposesAndSticks) {
  JointDef joint = finger();
  joint.kp = joint.kd = 0;
  joint.friction = 0.02;
  const SolverDef solver;
  for (const double qd : {-3.0, -0.5, 0.5, 3.0}) {
    const MotorRow row = motor_row(joint, solver, 0.5, qd, 0);
    EXPECT_NEAR(motor_torque(row, qd), -std::copysign(0.02, qd), 1e-12);
  }
  const MotorRow row = motor_row(joint, solver, 0.5, 1, 0);
  EXPECT_NEAR(motor_torque(row, kStickSpeed / 2), -0.01, 1e-12);
  EXPECT_EQ(row.force, joint.friction);
  joint.kp = 1;  // beside a drive it fades below kFrictionSpeed
  joint.effort = 0.9;
  EXPECT_NEAR(motor_torque(motor_row(joint, solver, 0.5, 0.01, 0.5), 0.01),
              -(0.02 / kFrictionSpeed + solver.h * joint.kp) * 0.01, 1e-12);
}

TEST(Drive, SpringOnlyEffortLeavesDampingOutside) {
  SolverDef solver;
  solver.spring_only_effort = true;
  JointDef joint = finger();
  joint.kp = 10;
  const MotorRow row = motor_row(joint, solver, 0, 0, 1.5);
  EXPECT_TRUE(std::isinf(row.force));
  EXPECT_NEAR(motor_torque(row, 0), joint.effort, 1e-12);
  EXPECT_LT(motor_torque(row, 20), -joint.kd * 10);
}

TEST(Drive, CoupledTargetHasSlackAndRange) {
  JointDef joint = finger();
  joint.ratio = 1.142;
  joint.slack = 0.142;
  EXPECT_NEAR(coupled_target(joint, 0, 0.8), 1.142 * 0.8 - 0.142, 1e-12);
  EXPECT_EQ(coupled_target(joint, 0.9, 0.8), 0.9);
  EXPECT_NEAR(coupled_target(joint, 1.4, 0.8), 1.142 * 0.8 + 0.142, 1e-12);
  EXPECT_EQ(coupled_target(joint, 0, 1.5), 1.5);
  EXPECT_EQ(coupled_target(joint, 0, 0), 0);
}

}  // namespace
}  // namespace rdm

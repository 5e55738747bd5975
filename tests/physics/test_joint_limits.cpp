// The drive law is written twice: as the row of ODE's motor (physics/model/drive.cpp) and in the lanes of the
// articulated engine. Here the two are held against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/rng.hpp"
#include "physics/articulated/world_state.hpp"
#include "physics/model/drive.hpp"
// after every header with code
#include "physics/articulated/joint_limits.inl"

namespace rdm {
namespace {

using L = Simd<double, 1>;

// Two joints side by side, the second of which may follow the first; unit lanes, no contacts.
struct TwoJoints {
  TwoJoints() {
    tree.num_links = tree.num_coords = 2;
    for (int i = 0; i < 2; ++i) {
      tree.links.push_back({});
      tree.row.push_back(i);
      tree.depth.push_back(i);
    }
    tree.path = {0, 0, 1};
    tree.moving = {1, 0, 1};
    tree.first_below = {0, 1, 1};
    tree.below.push_back({1, 1});
    batch.tree = &tree;
    batch.model = model;
    batch.state = state;
    batch.work = work;
    batch.coord = coord;
    batch.mass_matrix = mass_matrix;
    batch.reduced = reduced;
    batch.factor = factor;
    batch.dv = dv;
  }
  void set(int i, const JointDef& joint) {
    model[i].kp = joint.kp;
    model[i].kd = joint.kd;
    model[i].effort = joint.effort;
    model[i].lower = joint.lower;
    model[i].upper = joint.upper;
    model[i].friction = joint.friction;
    model[i].ratio = joint.ratio;
    model[i].slack = joint.slack;
    tree.links[static_cast<size_t>(i)].coupled_to = joint.coupled_to;
    if (joint.coupled_to < 0) return;
    tree.links[static_cast<size_t>(i)].coupling_entry = 1;
    tree.coupled.push_back(i);
  }
  double& inertia(int i) { return mass_matrix[2 * i]; }
  void set(const SolverDef& solver) {
    batch.h = solver.h;
    batch.inv_h = 1 / solver.h;
    for (LinkModel<L>& m : model) {
      m.limit_stiffness = solver.limit_stiffness;
      m.limit_time = std::max(solver.h, kLimitTime);
    }
    batch.spring_only = solver.spring_only_effort;
  }

  Tree tree;
  LinkModel<L> model[2] = {};
  PersistentLink<double> state[2] = {};
  LinkWork<double> work[2] = {};
  CoordWork<double> coord[2] = {};
  double mass_matrix[3] = {1, 0, 1}, reduced[3] = {}, factor[3] = {}, dv[2] = {}, feedforward[2] = {};
  TreeBatch<L> batch = {};
};

// What holds the law: the torque that a rate gives, the rate that a substep ends with, and the torque
// reported.
TEST(JointLimits, DriveLawIsThatOfTheMotorRow) {
  Stream random(31, 0, Purpose::kTest);
  int bounded_drives = 0;
  for (int k = 0; k < 20000; ++k) {
    SolverDef solver;
    solver.h = 1.0 / (60 << random.below(4));
    solver.spring_only_effort = k % 3 == 0;
    JointDef joint;
    joint.lower = -1.5;
    joint.upper = 1.6;
    joint.kp = 20 * random.uniform();
    joint.kd = random.uniform();
    joint.effort = 3 * random.uniform();
    TwoJoints two;
    two.set(solver);
    two.set(0, joint);
    two.set(1, joint);
    const double q[2] = {random.signed_unit(), random.signed_unit()},
                 qd[2] = {5 * random.signed_unit(), (k % 7 ? 5 : 0.1) * random.signed_unit()};
    const double target = 2 * random.signed_unit(), inertia = 0.001 + 0.1 * random.uniform();
    for (int i = 0; i < 2; ++i) {
      two.work[i].q = q[i];
      two.work[i].target = target;
      two.coord[i].qd = qd[i];
      two.inertia(i) = inertia;
    }
    two.feedforward[1] = random.uniform(-2, 2);
    two.batch.feedforward = k % 2 ? two.feedforward : nullptr;
    joint_drives(two.batch);
    const double wanted = target < joint.lower ? joint.lower : target > joint.upper ? joint.upper : target;
    const double extra = two.batch.feedforward ? two.feedforward[1] : 0;
    const MotorRow row = motor_row(joint, solver, q[1], qd[1], wanted, extra);
    const LinkWork<double>& drive = two.work[1];
    ASSERT_NEAR(drive.gain, row.gain, 1e-13 * (1 + row.gain)) << k;
    ASSERT_NEAR(drive.spring, row.gain * row.velocity, 1e-12 * (1 + std::fabs(drive.spring))) << k;
    if (!solver.spring_only_effort) {
      ASSERT_EQ(drive.bound, row.force) << k;
    }
    // the substep's end, of a lone inertia
    solve_without_contacts(two.batch);
    joint_torques(two.batch, 1.0);
    const double v1 = two.coord[1].v1, torque = motor_torque(row, v1);
    ASSERT_NEAR(drive.torque, torque, 1e-11 * (1 + std::fabs(torque))) << k;
    ASSERT_NEAR(inertia * (v1 - qd[1]), solver.h * torque, 1e-12) << k;
    bounded_drives += two.state[1].saturated != 0;
  }
  EXPECT_GT(bounded_drives, 2000);
}

// A coupling's torque is on both joints, and bounded; damping is of the one that is coupled alone.
TEST(JointLimits, CouplingsActBack) {
  Stream random(33, 0, Purpose::kTest);
  int bounded_drives = 0, slack = 0;
  for (int k = 0; k < 20000; ++k) {
    SolverDef solver;
    solver.h = 1.0 / (60 << random.below(4));
    JointDef joint;
    joint.lower = -10;
    joint.upper = 10;
    TwoJoints two;
    two.set(solver);
    two.set(0, joint);
    joint.kp = 20 * random.uniform();
    joint.kd = random.uniform();
    joint.effort = 3 * random.uniform();
    joint.ratio = 1.5 * random.signed_unit();
    joint.slack = k % 2 ? 0.5 * random.uniform() : 0;
    joint.coupled_to = 0;
    two.set(1, joint);
    const double q[2] = {random.signed_unit(), random.signed_unit()},
                 qd[2] = {5 * random.signed_unit(), 5 * random.signed_unit()};
    const double inertia[2] = {0.001 + 0.1 * random.uniform(), 0.001 + 0.1 * random.uniform()};
    for (int i = 0; i < 2; ++i) {
      two.work[i].q = q[i];
      two.coord[i].qd = qd[i];
      two.inertia(i) = inertia[i];
    }
    joint_drives(two.batch);
    solve_without_contacts(two.batch);
    joint_torques(two.batch, 1.0);
    const double v1[2] = {two.coord[0].v1, two.coord[1].v1};
    const double tendon = inertia[1] * (v1[1] - qd[1]) / solver.h + joint.kd * v1[1];
    ASSERT_NEAR(inertia[0] * (v1[0] - qd[0]) / solver.h, -joint.ratio * tendon, 1e-8) << k;
    ASSERT_NEAR(two.work[1].torque, tendon - joint.kd * v1[1], 1e-8) << k;
    ASSERT_LE(std::fabs(tendon), joint.effort + 1e-8) << k;
    const double apart = q[1] - joint.ratio * q[0];
    if (std::fabs(apart) < joint.slack) {
      ASSERT_NEAR(tendon, 0, 1e-8) << k;
      ++slack;
    } else if (two.state[1].saturated == 0) {
      const double gain = drive_gain(solver.h, joint.kp, joint.kd) - joint.kd;
      ASSERT_NEAR(
          tendon,
          joint.kp * (std::copysign(joint.slack, apart) - apart) - gain * (v1[1] - joint.ratio * v1[0]), 1e-8)
          << k;
    }
    bounded_drives += two.state[1].saturated != 0;
  }
  EXPECT_GT(bounded_drives, 2000);
  EXPECT_GT(slack, 1000);
}

// Friction gives what it takes to stand still, up to its bound, which it gives while anything slides.
TEST(JointLimits, FrictionSticksOrSlides) {
  Stream random(34, 0, Purpose::kTest);
  int stuck = 0, slides = 0;
  for (int k = 0; k < 20000; ++k) {
    SolverDef solver;
    solver.h = 1.0 / (60 << random.below(4));
    JointDef joint;
    joint.lower = -10;
    joint.upper = 10;
    joint.kd = k % 3 ? 0 : random.uniform();
    joint.effort = 10;
    joint.friction = 0.1 + random.uniform();
    TwoJoints two;
    two.set(solver);
    for (int i = 0; i < 2; ++i) two.set(i, joint);
    const double qd = k % 2 ? 0 : random.signed_unit(), inertia = 0.001 + 0.1 * random.uniform(),
                 torque = 1.5 * random.signed_unit();
    two.coord[1].qd = qd;
    two.inertia(1) = inertia;
    two.feedforward[1] = torque;
    two.batch.feedforward = two.feedforward;
    joint_drives(two.batch);
    solve_without_contacts(two.batch);
    const double v1 = two.coord[1].v1, drive = torque - joint.kd * v1,
                 friction = inertia * (v1 - qd) / solver.h - drive;
    ASSERT_LE(std::fabs(friction), joint.friction * (1 + 1e-9)) << k;
    if (std::fabs(v1) > kStickSpeed) {
      ASSERT_NEAR(friction, -std::copysign(joint.friction, v1), 1e-9) << k;
      ++slides;
    } else {
      ++stuck;
    }
  }
  EXPECT_GT(stuck, 5000);
  EXPECT_GT(slides, 5000);
}

// At an end of the range a spring and a damper push inward from q + T qd = edge on, and never pull; they are the
// same for all substeps up to T.
TEST(JointLimits, LimitIsASpringAndADamper) {
  Stream random(32, 0, Purpose::kTest);
  int held = 0;
  for (int k = 0; k < 5000; ++k) {
    SolverDef solver;
    solver.h = 1.0 / (60 << random.below(5));
    const double time = std::max(solver.h, kLimitTime);
    JointDef joint;
    joint.lower = -0.5;
    joint.upper = 0.7;
    TwoJoints two;
    two.set(solver);
    two.set(0, joint);
    two.set(1, joint);
    const double q = random.signed_unit(), qd = 20 * random.signed_unit(),
                 inertia = 0.01 + 0.1 * random.uniform();
    for (int i = 0; i < 2; ++i) {
      two.work[i].q = q;
      two.coord[i].qd = qd;
      two.inertia(i) = inertia;
    }
    joint_drives(two.batch);
    solve_without_contacts(two.batch);
    joint_torques(two.batch, 1.0);
    const double v1 = two.coord[1].v1, held_at = q + time * v1;
    const double beyond = q + time * qd < joint.lower   ? joint.lower - held_at
                          : q + time * qd > joint.upper ? joint.upper - held_at
                                                        : 0;
    ASSERT_NEAR(two.work[1].torque, solver.limit_stiffness * beyond, 1e-9) << k;
    ASSERT_NEAR(inertia * (v1 - qd), solver.h * two.work[1].torque, 1e-9) << k;
    ASSERT_EQ(two.state[1].limited, beyond > 0 ? -1 : beyond < 0 ? 1 : 0) << k;
    held += beyond != 0;
  }
  EXPECT_GT(held, 1000);
}

}  // namespace
}  // namespace rdm

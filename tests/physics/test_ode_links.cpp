#include <gtest/gtest.h>

#include <vector>

#include "base/rng.hpp"
#include "physics/ode/ode_links.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

// A chain of rods, each `length` m long and `mass` kg, hanging along -z from hinges about y.
SceneDef rods(int count, double mass, double length) {
  SceneDef def;
  ArticulationDef chain;
  chain.gravity = true;
  for (int i = 0; i < count; ++i) {
    LinkDef rod;
    rod.parent = i - 1;
    rod.X_PL.p = {0, 0, i ? -length : 0};
    rod.inertia = box_inertia(mass, {0.01, 0.01, length / 2});
    rod.inertia.com = {0, 0, -length / 2};
    rod.joint.axis = {0, 1, 0};
    rod.joint.lower = -100;
    rod.joint.upper = 100;
    chain.links.push_back(rod);
  }
  def.articulations.push_back(chain);
  def.solver.link_armature = 0;
  return def;
}

TEST(OdeLinks, PendulumSwingsWithTheAnalyticPeriod) {
  SceneDef def = rods(1, 0.5, 0.4);
  def.solver.h = 1.0 / 960;
  def.solver.substeps = 16;
  test::Simulation sim(def);
  const double q0 = 0.1, still = 0;
  sim->set_joints(0, &q0, &still);
  // I about the hinge, and the period with its first-order growth with amplitude.
  const double inertia = 0.5 / 3 * (0.2 * 0.2 + 0.01 * 0.01) + 0.5 * 0.2 * 0.2;
  const double period = 2 * std::acos(-1.0) * std::sqrt(inertia / (0.5 * 9.81 * 0.2)) * (1 + q0 * q0 / 16);
  double t = 0, before = q0, first = 0, last = 0;
  int crossings = 0;
  for (; crossings < 11; before = sim->q()[0]) {
    sim->step();
    t += 1.0 / 60;
    ASSERT_LT(t, 20);
    if ((before > 0) == (sim->q()[0] > 0)) continue;
    last = t - sim->q()[0] / (sim->q()[0] - before) / 60;
    if (crossings++ == 0) first = last;
  }
  EXPECT_NEAR((last - first) / 5, period, 2e-3 * period);
}

// Relative angles of two such rods after `time`, from (1, 0.5) rad at rest: RK4 on the equations of motion in
// absolute angles.
std::vector<double> double_pendulum(double m, double l, double time) {
  const double g = 9.81, inertia = m / 3 * (l * l / 4 + 1e-4);
  std::vector<double> x = {1, 1.5, 0, 0};
  const auto slope = [&](const std::vector<double>& s) {
    const double d = s[0] - s[1], k = m * l * l / 2;
    const double m11 = inertia + 1.25 * m * l * l, m12 = k * std::cos(d), m22 = inertia + m * l * l / 4;
    const double f1 = -k * std::sin(d) * s[3] * s[3] - 1.5 * m * l * g * std::sin(s[0]),
                 f2 = k * std::sin(d) * s[2] * s[2] - 0.5 * m * l * g * std::sin(s[1]);
    const double det = m11 * m22 - m12 * m12;
    return std::vector<double>{s[2], s[3], (m22 * f1 - m12 * f2) / det, (m11 * f2 - m12 * f1) / det};
  };
  const int steps = 4000;
  const double h = time / steps;
  const auto moved = [&](const std::vector<double>& k, double by) {
    std::vector<double> out = x;
    for (size_t i = 0; i < 4; ++i) out[i] += by * k[i];
    return out;
  };
  for (int i = 0; i < steps; ++i) {
    const auto a = slope(x), b = slope(moved(a, h / 2)), c = slope(moved(b, h / 2)), d = slope(moved(c, h));
    for (size_t k = 0; k < 4; ++k) x[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return {x[0], x[1] - x[0]};
}

// Without velocity products it converges to another place, 0.1 rad away.
TEST(OdeLinks, DoublePendulumConvergesToTheAnalyticMotion) {
  const std::vector<double> exact = double_pendulum(0.5, 0.4, 1);
  double before = 0;
  for (const int32_t substeps : {2, 4, 8, 16}) {
    SceneDef def = rods(2, 0.5, 0.4);
    def.solver.exact = true;
    def.solver.substeps = substeps;
    def.solver.h = 1.0 / 60 / substeps;
    test::Simulation sim(def);
    const double q0[] = {1, 0.5}, still[] = {0, 0};
    sim->set_joints(0, q0, still);
    for (int k = 0; k < 60; ++k) sim->step();
    const double error = std::hypot(sim->q()[0] - exact[0], sim->q()[1] - exact[1]);
    EXPECT_LT(error, 0.2 / substeps) << substeps;
    EXPECT_LT(error, substeps > 2 ? 0.7 * before : 1) << substeps;
    before = error;
  }
}

TEST(OdeLinks, DriftIsZeroAndLinksStayTogether) {
  test::Simulation sim(test::two_hands_def());
  Stream random(3, 0, Purpose::kTest);
  double share[24];
  for (int k = 0; k < 200; ++k) {
    for (int hand = 0; hand < 2; ++hand) {
      for (double& s : share) s = random.uniform();
      test::target_share(*sim, hand, share);
    }
    sim->step();
    ASSERT_LT(sim->joint_drift(), 1e-12);
  }
}

TEST(OdeLinks, JointsStayInRangeUnderLoad) {
  test::Simulation sim(test::two_hands_def());
  Stream random(3, 0, Purpose::kTest);
  double share[24];
  for (int k = 0; k < 400; ++k) {
    for (double& s : share) s = random.uniform() < 0.5 ? 0 : 1;
    test::target_share(*sim, 0, share);
    sim->push_link(5, {random.signed_unit(), random.signed_unit(), random.signed_unit()}, sim->link(5).X.p);
    sim->step();
    for (int32_t i = 0; i < 48; ++i) {
      const JointDef& joint = sim.scene().link(i).joint;
      ASSERT_GE(sim->q()[i], joint.lower - sim.scene().def.solver.limit_margin);
      ASSERT_LE(sim->q()[i], joint.upper + sim.scene().def.solver.limit_margin);
    }
  }
}

TEST(OdeLinks, RatesAreThoseOfTheAngles) {
  SceneDef def = test::two_hands_def();
  def.solver.substeps = 1;
  test::Simulation sim(def);
  test::target_share(*sim, 0, test::kCup);
  for (int k = 0; k < 10; ++k) {
    const std::vector<double> before(sim->q(), sim->q() + 48);
    sim->step();
    for (size_t i = 0; i < 48; ++i) {
      const JointDef& joint = sim.scene().link(static_cast<int32_t>(i)).joint;
      if (sim->q()[i] < joint.lower || sim->q()[i] > joint.upper) continue;  // may have been clamped
      EXPECT_NEAR(sim->qd()[i], (sim->q()[i] - before[i]) / def.solver.h, 1e-9) << i;
    }
  }
}

// Steady deflection of wrist and first finger under loads, rad.
std::vector<double> sag(const SolverDef& solver, int control_steps) {
  test::TwoHands c;
  c.solver = solver;
  c.ball = false;
  SceneDef def = test::two_hands_def(c);
  for (ArticulationDef& a : def.articulations) {
    a.self_pairs.clear();
    // Without slack the coupled joint has one place to be.
    for (LinkDef& link : a.links) link.joint.slack = 0;
  }
  test::Simulation sim(std::move(def));
  test::target_share(*sim, 0, test::kCup);
  for (int k = 0; k < control_steps; ++k) sim->step();
  const std::vector<double> free(sim->q(), sim->q() + 24);
  for (int k = 0; k < control_steps; ++k) {
    sim->push_link(5, {0, 0, -0.3}, sim->link(5).X * Vec3{0, 0, 0.024});
    sim->push_link(1, {0, 0, -1}, sim->link(1).X * Vec3{0.006, 0, 0.066});
    sim->step();
  }
  std::vector<double> out;
  for (const size_t i : {1u, 3u, 4u, 5u}) out.push_back(sim->q()[i] - free[i]);
  return out;
}

TEST(OdeLinks, StaticSagIsThatOfTheExactSolver) {
  SolverDef fine;
  fine.h = 1.0 / 1920;
  fine.substeps = 16;
  fine.exact = true;
  const std::vector<double> exact = sag(fine, 240), quick = sag(SolverDef(), 120);
  const char* const names[] = {"WRJ0", "FFJ2", "FFJ1", "FFJ0"};
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(quick[i] / exact[i], 1, 0.05) << names[i];
}

TEST(OdeLinks, TorqueHoldsTheLoad) {
  // A rod held level: the mean torque of the drive is its weight's moment.
  SceneDef def = rods(1, 0.5, 0.4);
  JointDef& joint = def.articulations[0].links[0].joint;
  joint.kp = 50;
  joint.kd = 5;
  joint.effort = 10;
  test::Simulation sim(def);
  sim->target()[0] = std::acos(0.0);
  for (int k = 0; k < 300; ++k) sim->step();
  EXPECT_NEAR(std::fabs(sim->torque()[0]), 0.5 * 9.81 * 0.2 * std::sin(sim->q()[0]), 1e-3);
}

// A ball rests in a hand without weight: what the drives give is what the contacts ask for, -J^T of their
// forces. Returns the largest difference over the joints as a share of the largest torque.
double unbalanced(bool exact) {
  test::TwoHands c;
  c.ball_mass = 0.3;
  c.solver.exact = exact;
  test::Simulation sim(test::two_hands_def(c));
  const Scene& scene = sim.scene();
  test::target_share(*sim, 0, test::kCup);
  sim->set_body(0, {{{0, -0.36, 0.57}, {}}, {}, {}});
  for (int k = 0; k < 240; ++k) sim->step();
  EXPECT_LT(norm(sim->body(0).v), 0.02);
  constexpr int kSteps = 60;
  double given[24] = {}, asked[24] = {}, load = 0, worst = 0;
  for (int k = 0; k < kSteps; ++k) {
    sim->step();
    EXPECT_GT(sim->num_contacts(), 2);
    for (int i = 0; i < 24; ++i) {
      given[i] += sim->torque()[i] / kSteps;
      const Motion& link = sim->link(i);
      const Vec3 axis = rotate(link.X.q, scene.frames[static_cast<size_t>(i)].axis);
      for (int32_t n = 0; n < sim->num_contacts(); ++n) {
        const Contact& contact = sim->contacts()[n];
        for (const int side : {0, 1}) {
          const SceneShape& shape =
              scene.shapes[static_cast<size_t>(side ? contact.shape_b : contact.shape_a)];
          int32_t on = shape.carrier == Carrier::kLink ? shape.index : -1;
          while (on > i) on = scene.frames[static_cast<size_t>(on)].parent;
          if (on != i) continue;
          asked[i] -= (side ? -1.0 : 1.0) / kSteps * dot(axis, cross(contact.p - link.X.p, contact.force));
        }
      }
    }
  }
  for (int i = 0; i < 24; ++i) {
    load = std::max(load, std::fabs(asked[i]));
    worst = std::max(worst, std::fabs(given[i] - asked[i]));
  }
  EXPECT_GT(load, 0.05);
  return worst / load;
}

TEST(OdeLinks, DriveTorquesAreTheContactsReactions) {
  EXPECT_LT(unbalanced(true), 0.01);
  // In QuickStep's few sweeps the contacts do not get all that the drives would give.
  EXPECT_LT(unbalanced(false), 0.4);
}

TEST(OdeLinks, DampedSwingLosesEnergy) {
  // Springs off, a tenth of the hand's damping: what moves only slows down.
  test::TwoHands c;
  c.ball = false;
  SceneDef def = test::two_hands_def(c);
  for (ArticulationDef& a : def.articulations) {
    a.self_pairs.clear();
    for (LinkDef& link : a.links) {
      link.joint.kp = link.joint.friction = 0;
      link.joint.kd *= 0.1;
    }
  }
  test::Simulation sim(def);
  Stream random(5, 0, Purpose::kTest);
  double q[24], qd[24];
  for (int i = 0; i < 24; ++i) {
    const JointDef& joint = sim.scene().link(i).joint;
    q[i] = 0.5 * (joint.lower + joint.upper);
    qd[i] = 10 * random.signed_unit();
  }
  sim->set_joints(0, q, qd);
  const auto energy = [&] {
    double sum = 0;
    for (int32_t i = 0; i < 24; ++i) {
      const Inertia& inertia = sim.scene().link(i).inertia;
      const Motion& m = sim->link(i);
      const Vec3 v = m.v + cross(m.w, rotate(m.X.q, inertia.com));
      sum += 0.5 * inertia.mass * dot(v, v) + 0.5 * inertia.moment[0] * dot(m.w, m.w);
    }
    return sum;
  };
  const double start = energy();
  double before = start;
  for (int k = 0; k < 60; ++k) {
    sim->step();
    const double now = energy();
    ASSERT_LT(now, before + 0.01 * start) << k;
    before = now;
  }
  EXPECT_LT(before, 0.2 * start);
}

TEST(OdeLinks, DrivenFingersDoNotGainEnergy) {
  // Random rates at the start, drives on: after a second all is at rest.
  test::TwoHands c;
  c.ball = false;
  test::Simulation sim(test::two_hands_def(c));
  Stream random(5, 0, Purpose::kTest);
  double q[24], qd[24], fastest = 0;
  for (int i = 0; i < 24; ++i) {
    const JointDef& joint = sim.scene().link(i).joint;
    q[i] = sim->target()[i] = 0.5 * (joint.lower + joint.upper);
    qd[i] = 20 * random.signed_unit();
    fastest = std::max(fastest, std::fabs(qd[i]));
  }
  sim->set_joints(0, q, qd);
  for (int k = 0; k < 90; ++k) {
    sim->step();
    for (int i = 0; i < 24; ++i) ASSERT_LT(std::fabs(sim->qd()[i]), 2 * fastest) << k;
  }
  for (int i = 0; i < 24; ++i) EXPECT_LT(std::fabs(sim->qd()[i]), 0.05) << i;
}

TEST(OdeLinks, SlidesAlongAPrismaticAxis) {
  SceneDef def;
  ArticulationDef lift;
  LinkDef car;
  car.inertia = box_inertia(2, {0.1, 0.1, 0.1});
  car.joint.kind = JointKind::kPrismatic;
  car.joint.axis = {0, 0.6, 0.8};
  car.joint.lower = -1;
  car.joint.upper = 1;
  lift.gravity = true;
  lift.links.push_back(car);
  LinkDef second = car;  // rides on the first, turned a quarter about z
  second.parent = 0;
  second.X_PL = {{0.3, 0, 0}, axis_angle({0, 0, 1}, std::acos(0.0))};
  second.joint.kp = 2000;
  second.joint.kd = 100;
  second.joint.effort = 1000;
  lift.links.push_back(second);
  def.articulations.push_back(lift);
  def.solver.h = 1.0 / 480;
  def.solver.substeps = 8;
  def.solver.exact = true;  // the row's geometry is at stake, not how far 8 sweeps get
  test::Simulation sim(def);
  sim->target()[1] = 0;
  for (int k = 0; k < 12; ++k) sim->step();
  // The lower car falls along its slope: with the second held, both together by g 0.8; in the first
  // order the explicit step leads by h / 2 t.
  const double t = 12.0 / 60, a = -9.81 * 0.8;
  EXPECT_NEAR(sim->qd()[0], a * t, 0.02);
  EXPECT_NEAR(sim->q()[0], 0.5 * a * t * t, 0.01);
  EXPECT_NEAR(sim->q()[1], 0, 0.01);
  const Vec3 along = rotate(axis_angle({0, 0, 1}, std::acos(0.0)), {0, 0.6, 0.8});
  const Vec3 expected = sim->q()[0] * Vec3{0, 0.6, 0.8} + Vec3{0.3, 0, 0} + sim->q()[1] * along;
  EXPECT_LT(norm(sim->link(1).X.p - expected), 1e-12);
  EXPECT_LT(norm(sim->link(1).v - (sim->qd()[0] * Vec3{0, 0.6, 0.8} + sim->qd()[1] * along)), 1e-12);
}

TEST(OdeLinks, LightLinkBetweenTwoAxesSparesABody) {
  // Same hand with a speck of a shape on each knuckle: no link may be merged then. Slow motions agree.
  test::TwoHands c;
  c.ball = false;
  SceneDef merged = test::two_hands_def(c), apart = merged;
  for (int32_t link : {2, 6, 10, 15, 19, 21}) {
    ArticulationShape speck;
    speck.link = link;
    speck.shape.size = {1e-4, 0, 0};
    speck.shape.collides = false;
    apart.articulations[0].shapes.push_back(speck);
  }
  apart.solver.exact = merged.solver.exact = true;
  test::Simulation a(merged), b(apart);
  test::target_share(*a, 0, test::kCup);
  test::target_share(*b, 0, test::kCup);
  for (int k = 0; k < 120; ++k) {
    a->step();
    b->step();
  }
  for (int i = 0; i < 24; ++i) EXPECT_NEAR(a->q()[i], b->q()[i], 0.01) << i;
}

}  // namespace
}  // namespace rdm

// Motion without contacts against closed forms: flights, spins, floating chains, damped bases, at any substeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "articulated.hpp"
#include "physics/model/flow.hpp"
#include "quality_bodies.hpp"

namespace rdm {
namespace {

constexpr EngineKind kEngine = EngineKind::kArticulated;

SolverDef with_substeps(int32_t substeps) {
  SolverDef solver;
  solver.substeps = substeps;
  solver.h = test::kTick / substeps;
  return solver;
}

class AnySubsteps : public testing::TestWithParam<int32_t> {};
INSTANTIATE_TEST_SUITE_P(SmoothMotion, AnySubsteps, testing::Values(1, 2, 4, 16));

// v' = g - c v from v0: v(t) = g/c + (v0 - g/c) e^(-ct).
TEST_P(AnySubsteps, FlightsAreExact) {
  for (const double c : {0.0, 0.3, 5.0, 100.0}) {
    SceneDef def;
    def.solver = with_substeps(GetParam());
    def.bodies.push_back(test::make_box(0.1, {0.03, 0.03, 0.03}, {}));
    def.bodies[0].linear_damping = c;
    test::Simulation sim(def, kEngine);
    const Vec3 v0{2, 1, 4};
    sim->set_body(0, {{{0, 0, 0}, {}}, v0, {}});
    for (int k = 0; k < 60; ++k) sim->step();
    for (int r = 0; r < 3; ++r) {
      const double g = r == 2 ? -test::kGravity : 0, end = c > 0 ? g / c : 0;
      const double way = c > 0 ? end + (v0[r] - end) * -std::expm1(-c) / c : v0[r] + g / 2;
      const double speed = c > 0 ? end + (v0[r] - end) * std::exp(-c) : v0[r] + g;
      EXPECT_NEAR(sim->body(0).X.p[r], way, 1e-9) << c;
      EXPECT_NEAR(sim->body(0).v[r], speed, 1e-9) << c;
    }
  }
}

double spin_energy(const Motion& m, const Vec3& moment) {
  const Vec3 w = transpose(to_matrix(m.X.q)) * m.w;
  return moment.x * w.x * w.x + moment.y * w.y * w.y + moment.z * w.z * w.z;
}
Vec3 spin_momentum(const Motion& m, const Vec3& moment) {
  const Mat3 R = to_matrix(m.X.q);
  const Vec3 w = transpose(R) * m.w;
  return R * Vec3{moment.x * w.x, moment.y * w.y, moment.z * w.z};
}

TEST_P(AnySubsteps, SpinsKeepMomentumAndEnergy) {
  for (const Vec3& w : {Vec3{0.02, 8, 0}, Vec3{3, -5, 7}}) {
    SceneDef def;
    def.solver = with_substeps(GetParam());
    def.gravity = {};
    def.bodies.push_back(test::make_box(0.1, {0.06, 0.03, 0.01}, {}));
    test::Simulation sim(def, kEngine);
    const double* I = def.bodies[0].inertia.moment;
    const Vec3 moment{I[0], I[1], I[2]};
    sim->set_body(0, {{}, {}, w});
    const double energy = spin_energy(sim->body(0), moment);
    const Vec3 momentum = spin_momentum(sim->body(0), moment);
    double most = 0;
    for (int k = 0; k < 600; ++k) {
      sim->step();
      most = std::max(most, std::fabs(spin_energy(sim->body(0), moment) / energy - 1));
      EXPECT_LT(norm(spin_momentum(sim->body(0), moment) - momentum), 1e-9 * norm(momentum));
    }
    EXPECT_LT(most, GetParam() == 1 ? 1e-2 : 1e-3) << w.x << ' ' << w.y << ' ' << w.z;
  }
}

// Rods in a row, 0.3 m and 0.1 kg each, hinges about y, x, y, without drives or gravity.
constexpr double kRod = 0.3, kRodMass = 0.1, kAcross = kRodMass * kRod * kRod / 12;
SceneDef chain(int joints, double axial, int32_t substeps, Integrator integrator) {
  SceneDef def;
  def.solver = with_substeps(substeps);
  def.solver.integrator = integrator;
  def.gravity = {};
  ArticulationDef robot;
  robot.free_base = true;
  robot.base.mass = kRodMass;
  robot.base.com = {0, 0, -kRod / 2};
  const double moment[3] = {kAcross, kAcross, axial};
  std::copy_n(moment, 3, robot.base.moment);
  for (int i = 0; i < joints; ++i) {
    LinkDef link;
    link.parent = i - 1;
    link.X_PL.p = {0, 0, -kRod};
    link.inertia = robot.base;
    link.joint.axis = i % 2 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    link.joint.lower = -1e4;
    link.joint.upper = 1e4;
    robot.links.push_back(link);
  }
  def.articulations.push_back(robot);
  return def;
}
void set_going(World& world) {
  const double q[3] = {0.5, -0.4, 0.8}, qd[3] = {3, -5, 4};
  world.set_base(0, {{}, {0.3, 0.2, 0.1}, {2, -3, 1}});
  world.set_joints(0, q, qd);
}
struct Whole {
  double energy = 0;
  Vec3 momentum, center;  // center: of mass, times the mass
};
Whole whole(const World& world, double axial) {
  Whole out;
  for (int32_t i = -1; i < world.scene().num_links; ++i) {
    const Motion& m = i < 0 ? world.base(0) : world.link(i);
    const Mat3 R = to_matrix(m.X.q);
    const Vec3 arm = R * Vec3{0, 0, -kRod / 2}, v = m.v + cross(m.w, arm), w = transpose(R) * m.w;
    out.center += kRodMass * (m.X.p + arm);
    out.energy += 0.5 * (kRodMass * dot(v, v) + kAcross * (w.x * w.x + w.y * w.y) + axial * w.z * w.z);
    out.momentum += kRodMass * v;
  }
  return out;
}

// Energy as its mean over the last second; the centre of mass goes straight on by the momentum of the start.
TEST(SmoothMotion, FloatingChainsKeepEnergyAndMomentum) {
  for (const int32_t substeps : {2, 4, 8})
    for (const int joints : {1, 2, 3})
      for (const double axial : {1e-4, kAcross}) {
        test::Simulation sim(chain(joints, axial, substeps, Integrator::kAuto), kEngine);
        set_going(*sim);
        const Whole start = whole(*sim, axial);
        double energy = 0;
        for (int k = 0; k < 600; ++k) {
          sim->step();
          ASSERT_EQ(sim->status(), 0u) << joints << ' ' << substeps << ' ' << k;
          if (k >= 540) energy += whole(*sim, axial).energy / 60;
        }
        EXPECT_NEAR(energy / start.energy, 1, 0.05) << joints << ' ' << axial << ' ' << substeps;
        const Vec3 way = 10.0 * start.momentum, off = whole(*sim, axial).center - start.center - way;
        EXPECT_LT(norm(off), 1e-3 * norm(way)) << joints << ' ' << axial << ' ' << substeps;
      }
}

// The same chain by one solve a substep gains what the default keeps: the option does what it says.
TEST(SmoothMotion, ASingleSolveDoesNotKeepIt) {
  test::Simulation sim(chain(3, 1e-4, 2, Integrator::kEuler), kEngine);
  set_going(*sim);
  const double start = whole(*sim, 1e-4).energy;
  double most = 0;
  for (int k = 0; k < 240 && sim->status() == 0; ++k) {
    sim->step();
    most = std::max(most, std::fabs(whole(*sim, 1e-4).energy / start - 1));
  }
  EXPECT_GT(most, 0.2);
}

// Two worlds of a hand's kind: four, eight lanes and doubles move a chain alike.
TEST(SmoothMotion, LanesMoveChainsAlike) {
  uint64_t first = 0;
  for (const int32_t lanes : {1, 4, 8, 16}) {
    SceneDef def = chain(3, 1e-4, 2, Integrator::kAuto);
    def.solver.lanes = lanes;
    test::Partners worlds(def, 5);
    for (int32_t i = 0; i < 5; ++i) set_going(worlds[i]);
    for (int k = 0; k < 60; ++k) World::step_together(worlds.data(), 5);
    for (int32_t i = 0; i < 5; ++i) {
      const uint64_t hash = test::state_hash(worlds[i]);
      if (first == 0) first = hash;
      EXPECT_EQ(hash, first) << lanes << ' ' << i;
    }
  }
}

// A state taken in mid-flight goes on as the world it is of.
TEST(SmoothMotion, AChainGoesOnFromItsState) {
  test::Simulation one(chain(3, 1e-4, 2, Integrator::kAuto), kEngine),
      other(chain(3, 1e-4, 2, Integrator::kAuto), kEngine);
  set_going(*one);
  for (int k = 0; k < 7; ++k) one->step();
  test::load(*other, test::saved(*one));
  for (int k = 0; k < 20; ++k) {
    one->step();
    other->step();
  }
  EXPECT_EQ(test::state_hash(*one), test::state_hash(*other));
}

// A fixed double pendulum from (2, 1) rad in gravity: the trapezoid keeps what one solve loses.
TEST(SmoothMotion, TheTrapezoidKeepsAPendulumsEnergy) {
  double kept[2];
  for (const Integrator integrator : {Integrator::kEuler, Integrator::kTrapezoid}) {
    SceneDef def = chain(2, 1e-4, 2, integrator);
    def.articulations[0].free_base = false;
    def.articulations[0].base = {};
    def.articulations[0].gravity = true;
    def.gravity = {0, 0, -test::kGravity};
    for (LinkDef& link : def.articulations[0].links) link.joint.axis = {0, 1, 0};
    test::Simulation sim(def, kEngine);
    const double q[2] = {2, 1}, qd[2] = {};
    sim->set_joints(0, q, qd);
    const auto energy = [&] {
      double e = 0;
      for (int32_t i = 0; i < 2; ++i) {
        const Motion& m = sim->link(i);
        const Vec3 c = to_matrix(m.X.q) * Vec3{0, 0, -kRod / 2}, v = m.v + cross(m.w, c);
        e += 0.5 * (kRodMass * dot(v, v) + kAcross * dot(m.w, m.w)) +
             kRodMass * test::kGravity * (m.X.p.z + c.z + 2 * kRod);
      }
      return e;
    };
    const double start = energy();
    for (int k = 0; k < 600; ++k) sim->step();
    kept[integrator == Integrator::kTrapezoid] = energy() / start;
  }
  EXPECT_LT(kept[0], 0.5);
  EXPECT_GT(kept[1], 0.8);
  EXPECT_LT(kept[1], 1.1);
}

// A damped base pushed by a steady force: the same rate at each control step, whatever the substeps.
TEST_P(AnySubsteps, ADampedBaseIsPushedExactly) {
  SceneDef def;
  def.solver = with_substeps(GetParam());
  def.gravity = {};
  ArticulationDef robot;
  robot.free_base = true;
  robot.base = box_inertia(0.8, {0.1, 0.05, 0.2});
  robot.base_damping = 100;
  def.articulations.push_back(robot);
  test::Simulation sim(def, kEngine);
  const Vec3 force{40, -10, 5};
  double t = 0;
  for (int k = 0; k < 5; ++k) {
    sim->push_base(0, force, {0, 0, 0.2});
    sim->step();
    t += test::kTick;
    const double rate = -std::expm1(-100 * t) / 100;
    for (int r = 0; r < 3; ++r)
      EXPECT_NEAR(sim->base(0).v[r], force[r] / 0.8 * rate, 2e-6 * std::fabs(force[r])) << k;
    EXPECT_NEAR(sim->base(0).w.z, 0.2 / robot.base.moment[2] * rate, 1e-4) << k;
  }
}

}  // namespace
}  // namespace rdm

// Couplings tie two joints, and both feel it: masses, torques and momenta of tied pairs against pencil and paper.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/articulated/tree.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

constexpr double kInertia = 0.02, kTorque = 0.05;

LinkDef wheel(int32_t parent, const Vec3& p) {
  LinkDef link;
  link.parent = parent;
  link.X_PL.p = p;
  link.inertia.mass = 1;
  for (int r = 0; r < 3; ++r) link.inertia.moment[r] = kInertia;
  link.joint.lower = -1e3;
  link.joint.upper = 1e3;
  link.joint.effort = 10;
  return link;
}

void couple(LinkDef* link, int32_t to, double ratio) {
  link->joint.coupled_to = to;
  link->joint.ratio = ratio;
  link->joint.kp = 50;
  link->joint.kd = 0;
}

SceneDef scene(const Vector<LinkDef>& links, int32_t substeps) {
  SceneDef def;
  def.feedforward = true;
  def.solver.substeps = substeps;
  def.solver.h = 1.0 / 60 / substeps;
  ArticulationDef robot;
  robot.links = links;
  def.articulations.push_back(robot);
  return def;
}

// Two wheels side by side, geared: I (1 + ratio^2) for whoever is pushed, and the other turns with it.
TEST(Coupling, GearsOnTwoBranchesShareTheirInertia) {
  for (const bool follower_first : {false, true})
    for (const double ratio : {1.0, -2.0, 0.5})
      for (const int32_t substeps : {1, 2, 16}) {
        Vector<LinkDef> links = {wheel(-1, {}), wheel(-1, {0.3, 0, 0})};
        const size_t follower = follower_first ? 0 : 1, leader = 1 - follower;
        couple(&links[follower], static_cast<int32_t>(leader), ratio);
        test::Simulation sim(scene(links, substeps), EngineKind::kArticulated);
        for (int k = 0; k < 60; ++k) {
          sim->feedforward()[leader] = kTorque;
          sim->step();
        }
        const double exact = kTorque / (kInertia * (1 + ratio * ratio));
        EXPECT_NEAR(sim->qd()[leader] / exact, 1, 0.02) << follower_first << ratio << ' ' << substeps;
        EXPECT_NEAR(sim->q()[leader] / (exact / 2), 1, 0.02) << follower_first << ratio << ' ' << substeps;
        EXPECT_NEAR(sim->qd()[follower] / (ratio * exact), 1, 0.02) << ratio << ' ' << substeps;
      }
}

// Pushed at the follower, the leader comes along.
TEST(Coupling, TheLeaderFeelsALoadOnTheFollower) {
  Vector<LinkDef> links = {wheel(-1, {}), wheel(-1, {0.3, 0, 0})};
  couple(&links[1], 0, 1);
  test::Simulation sim(scene(links, 2), EngineKind::kArticulated);
  const double force = 0.1, reach = 0.5;
  for (int k = 0; k < 60; ++k) {
    const Pose& X = sim->link(1).X;
    const Vec3 arm = rotate(X.q, {reach, 0, 0});
    sim->push_link(1, force * cross({0, 0, 1}, (1 / reach) * arm), X.p + arm);
    sim->step();
  }
  const double exact = force * reach / (2 * kInertia);
  EXPECT_NEAR(sim->qd()[0] / exact, 1, 0.02);
  EXPECT_NEAR(sim->qd()[1] / exact, 1, 0.02);
}

// Within the slack there are two wheels; then the first runs into the second and takes it along.
TEST(Coupling, SlackIsFree) {
  Vector<LinkDef> links = {wheel(-1, {}), wheel(-1, {0.3, 0, 0})};
  couple(&links[1], 0, 1);
  links[1].joint.slack = 0.5;
  test::Simulation sim(scene(links, 4), EngineKind::kArticulated);
  const double q0[] = {0, 0}, qd0[] = {1, 0};
  sim->set_joints(0, q0, qd0);
  for (int k = 0; k < 27; ++k) sim->step();
  EXPECT_NEAR(sim->qd()[0], 1, 1e-6);
  EXPECT_NEAR(sim->qd()[1], 0, 1e-6);
  for (int k = 0; k < 10; ++k) sim->step();
  EXPECT_GT(sim->qd()[1], 0.1);
  EXPECT_NEAR(sim->qd()[0] + sim->qd()[1], 1, 1e-4);  // nothing but the two
}

// A finger's last joints: one behind the other, in a robot of more branches; rows of all that hangs on them hold.
TEST(Coupling, TiesAcrossBranchesAndAlongAChainTogether) {
  // 0 and 1 on the base, 2 on 0, 3 on 1, 4 on 3: 2 follows 3 and 4 follows 1
  Vector<LinkDef> links = {wheel(-1, {}), wheel(-1, {0.5, 0, 0}), wheel(0, {0, 0, 0}), wheel(1, {0, 0, 0}),
                           wheel(3, {0, 0, 0})};
  couple(&links[2], 3, 1);
  couple(&links[4], 1, -1);
  const SceneDef def = scene(links, 4);
  const Vector<Tree> trees = make_trees(make_scene(def));
  const Tree& tree = trees[0];
  for (int32_t c = 0; c < tree.num_coords; ++c) {  // a row is its own end behind the row of one before
    const int32_t row = tree.row[static_cast<size_t>(c)], depth = tree.depth[static_cast<size_t>(c)];
    EXPECT_EQ(tree.path[static_cast<size_t>(row + depth)], c);
    if (depth == 0) continue;
    const auto before = static_cast<size_t>(tree.path[static_cast<size_t>(row + depth - 1)]);
    ASSERT_EQ(tree.depth[before], depth - 1);
    for (int32_t d = 0; d < depth; ++d)
      EXPECT_EQ(tree.path[static_cast<size_t>(row + d)],
                tree.path[static_cast<size_t>(tree.row[before] + d)]);
  }
  test::Simulation sim(def, EngineKind::kArticulated);
  for (int k = 0; k < 60; ++k) {
    sim->feedforward()[0] = kTorque;
    sim->step();
  }
  // All axes coincide in their branch, so that rates in the world are sums along it: T = I / 2 (w0^2 + (w0 + q2)^2
  // + w1^2 + (w1 + q3)^2 + (w1 + q3 + q4)^2) with q2 = q3, q4 = -w1; torque on 0 alone. With x = (q0, q1, q3):
  //   a0 (2, ., 1), a1 (., 2, 1) ...: M = I [[2, 0, 1], [0, 2, 1], [1, 1, 3]]
  const double a = kTorque / kInertia;
  // M^-1 (a, 0, 0): det = 2 (6 - 1) - 2 = 8
  const double exact[3] = {5 * a / 8, 1 * a / 8, -2 * a / 8};
  EXPECT_NEAR(sim->qd()[0], exact[0], 0.02 * a);
  EXPECT_NEAR(sim->qd()[1], exact[1], 0.02 * a);
  EXPECT_NEAR(sim->qd()[3], exact[2], 0.02 * a);
  EXPECT_NEAR(sim->qd()[2], sim->qd()[3], 0.02 * a);
  EXPECT_NEAR(sim->qd()[4], -sim->qd()[1], 0.02 * a);
}

}  // namespace
}  // namespace rdm

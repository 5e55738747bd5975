#include <gtest/gtest.h>

#include "base/error.hpp"
#include "robot_rows.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

struct Golden {
  const char* link;
  Vec3 zero, bent;
};
// Forward kinematics of the released model: identity base at the origin, metres.
const Golden kGolden[] = {
    {"right_palm", {0, -0.2900, -0.0100}, {0.0068, -0.2893, -0.0100}},
    {"right_ff_distal", {-0.0330, -0.4550, -0.0100}, {-0.0052, -0.4229, 0.0744}},
    {"right_mf_distal", {-0.0110, -0.4590, -0.0100}, {0.0223, -0.4215, 0.0756}},
    {"right_rf_distal", {0.0110, -0.4550, -0.0100}, {0.0431, -0.4134, 0.0744}},
    {"right_lf_distal", {0.0340, -0.4480, -0.0100}, {0.0428, -0.3872, 0.0912}},
    {"right_th_distal", {-0.0835, -0.3685, -0.0010}, {-0.0333, -0.3687, 0.0561}},
};

void bent_pose(double* q) {
  for (int i = 0; i < 24; ++i) q[i] = 0;
  for (const int base : {2, 6, 10, 15}) {
    q[base + 1] = q[base + 2] = 0.5;
    q[base + 3] = 0.571;
  }
  q[joint_row(kShadowHand, "WRJ1")] = -0.2;
  q[joint_row(kShadowHand, "WRJ0")] = 0.3;
  q[joint_row(kShadowHand, "LFJ4")] = 0.4;
  q[joint_row(kShadowHand, "FFJ3")] = 0.1;
  q[joint_row(kShadowHand, "THJ4")] = 0.5;
  q[joint_row(kShadowHand, "THJ3")] = 0.6;
  q[joint_row(kShadowHand, "THJ2")] = 0.1;
  q[joint_row(kShadowHand, "THJ1")] = -0.2;
  q[joint_row(kShadowHand, "THJ0")] = -0.7;
}

SceneDef one_hand(Side side, const Pose& X_WB) {
  SceneDef def;
  def.articulations.push_back(
      make_articulation(kShadowHand, side, X_WB, side == Side::kRight ? "right_" : "left_"));
  return def;
}

TEST(ShadowHand, ForwardKinematicsGolden) {
  test::Simulation sim(one_hand(Side::kRight, {}));
  double q[24] = {}, still[24] = {};
  for (const bool bent : {false, true}) {
    if (bent) bent_pose(q);
    sim->set_joints(0, q, still);
    for (const Golden& g : kGolden) {
      const Vec3 p = sim->link(test::find_link(sim.scene(), 0, g.link)).X.p;
      EXPECT_LT(norm(p - (bent ? g.bent : g.zero)), 1e-3) << g.link << (bent ? " bent" : " zero");
    }
  }
}

// A draw inside the limits, and the tips it gives in the forearm's frame (position, quaternion w x y z).
const double kRandomPose[24] = {-0.066226, -0.027677, -0.262059, 0.800957, 0.952968,  0.094169,
                                0.311894,  0.838881,  1.0019,    0.155782, -0.213076, 0.47527,
                                0.294611,  0.509748,  0.403562,  0.174518, 0.38517,   1.452319,
                                1.269961,  -0.356335, 0.203936,  0.094683, -0.36561,  -1.458873};
const Pose kRandomTips[5] = {
    {{0.017908, -0.078714, 0.40772}, {0.605429, 0.778946, -0.097379, 0.131209}},
    {{0.005109, -0.078144, 0.403924}, {0.549038, 0.826765, 0.064185, -0.104387}},
    {{-0.037661, -0.058475, 0.448556}, {0.80256, 0.580106, -0.111048, 0.083914}},
    {{-0.024054, -0.053005, 0.375796}, {0.063644, -0.980869, -0.176359, 0.052373}},
    {{0.04561, -0.033253, 0.386771}, {0.844829, 0.198523, -0.489985, -0.082262}},
};

TEST(ShadowHand, TipsAgreeWithTheIndependentModel) {
  test::Simulation sim(one_hand(Side::kRight, {}));
  const double still[24] = {};
  sim->set_joints(0, kRandomPose, still);
  const Pose X_BF = kShadowHand.X_BR * Pose{{0, 0.01, 0}, {}};
  for (int i = 0; i < 5; ++i) {
    const RobotTip& tip = kShadowHand.tips[i];
    const Pose X_FT = inverse(X_BF) * sim->link(tip.link).X * Pose{tip.p_L, {}};
    EXPECT_LT(norm(X_FT.p - kRandomTips[i].p), 2e-6) << i;
    const Quat error = X_FT.q * conjugate(kRandomTips[i].q);
    EXPECT_LT(norm({error.x, error.y, error.z}), 2e-6) << i;
  }
}

TEST(ShadowHand, HoldsThePoseWithItsDrives) {
  test::Simulation sim(one_hand(Side::kRight, {}));
  double q[24], still[24] = {};
  bent_pose(q);
  sim->set_joints(0, q, still);
  for (int i = 0; i < 24; ++i) sim->target()[i] = q[i];
  for (int k = 0; k < 120; ++k) sim->step();
  for (const Golden& g : kGolden)
    EXPECT_LT(norm(sim->link(test::find_link(sim.scene(), 0, g.link)).X.p - g.bent), 1e-3) << g.link;
}

TEST(ShadowHand, LeftIsTheMirrorImage) {
  // The left hand turned half about x is the image of the right one in a plane y = const.
  test::Simulation right(one_hand(Side::kRight, {{0, 0, 0.5}, {}}));
  test::Simulation left(one_hand(Side::kLeft, {{0, -1, 0.5}, {0, 1, 0, 0}}));
  double q[24], still[24] = {};
  bent_pose(q);
  right->set_joints(0, q, still);
  left->set_joints(0, q, still);
  const auto reflected = [](Vec3 p) { return Vec3{p.x, -1 - p.y, p.z}; };
  for (int i = 0; i < 24; ++i)
    EXPECT_LT(norm(reflected(right->link(i).X.p) - left->link(i).X.p), 1e-6) << kShadowHand.links[i].name;
  for (int s = 0; s < kShadowHand.shapes.count; ++s)
    EXPECT_LT(norm(reflected(right->shape_pose(s).p) - left->shape_pose(s).p), 1e-6)
        << kShadowHand.shapes[s].name;
  // Moving together they stay images of each other.
  for (int k = 0; k < 20; ++k) {
    for (int i = 0; i < 24; ++i) right->target()[i] = left->target()[i] = 0.5 * q[i];
    right->step();
    left->step();
  }
  for (int i = 0; i < 24; ++i)
    EXPECT_LT(norm(reflected(right->link(i).X.p) - left->link(i).X.p), 1e-6) << kShadowHand.links[i].name;
}

TEST(ShadowHand, PalmSideAndThumbSide) {
  test::Simulation sim(one_hand(Side::kRight, {}));
  const Motion& palm = sim->link(kShadowHand.palm);
  const Vec3 out = rotate(palm.X.q, {0, -1, 0});
  EXPECT_NEAR(out.z, 1, 1e-12);                                              // palm up
  EXPECT_LT(sim->link(link_row(kShadowHand, "th_base")).X.p.x, palm.X.p.x);  // thumb at -x
}

TEST(ShadowHand, ActuatedJointsAreTheTwentyDriven) {
  const int32_t expected[20] = {0, 1, 2, 3, 4, 6, 7, 8, 10, 11, 12, 14, 15, 16, 17, 19, 20, 21, 22, 23};
  ASSERT_EQ(kShadowHand.num_actuated(), 20);
  for (int32_t i = 0; i < 20; ++i) EXPECT_EQ(kShadowHand.actuated(i), expected[i]);
  EXPECT_THROW(kShadowHand.actuated(20), Error);
}

TEST(ShadowHand, MassOfTheHand) {
  const ArticulationDef def = make_articulation(kShadowHand, Side::kRight, {}, "");
  double mass = def.base.mass;
  for (const LinkDef& link : def.links) mass += link.inertia.mass;
  EXPECT_NEAR(mass, 5.01, 0.005);
  EXPECT_TRUE(positive_definite(moment_matrix(def.base)));
}

TEST(ShadowHand, CoupledDistalFollowsTheMiddleJoint) {
  test::Simulation sim(one_hand(Side::kRight, {}));
  sim->target()[joint_row(kShadowHand, "FFJ1")] = 0.8;
  for (int k = 0; k < 240; ++k) sim->step();
  EXPECT_NEAR(sim->q()[4], 0.8, 0.01);
  EXPECT_NEAR(sim->q()[5], 0.913, 0.142 + 1e-3);
  EXPECT_GT(sim->q()[5], 0.7);
}

TEST(ShadowHand, EveryTipHasASensor) {
  test::Simulation sim(one_hand(Side::kRight, {}));
  ASSERT_EQ(sim.scene().sensors.size(), 5u);
  for (int32_t i = 0; i < 5; ++i)
    EXPECT_EQ(sim.scene().sensors[static_cast<size_t>(i)], kShadowHand.tips[i].link);
}

}  // namespace
}  // namespace rdm

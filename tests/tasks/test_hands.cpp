#include <algorithm>
#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/hand/hands.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

// All of a throw's joints begin as the robot's tables have them.
const OptionInput kStraight = {"start_finger", "paper", 0};

class Hands : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
  static const JointDef& joint(TestPool& p, int32_t i) { return p->world(0).scene().link(i).joint; }
};

// The coupled distals: dof 5, 9, 13, 18 of each hand.
bool coupled_dof(int i) {
  return i == 5 || i == 9 || i == 13 || i == 18;
}

TEST_F(Hands, ActionsMapToTheRangeOfTheActuatedJoints) {
  TestPool p("hand_over_safe_finger", 1);
  p->reset(nullptr, nullptr);
  for (const double a : {-1.0, 0.0, 1.0, 0.3}) {
    for (int k = 0; k < 40; ++k) p.action(0)[k] = static_cast<float>(a);
    double before[48];
    std::copy(p->world(0).target(), p->world(0).target() + 48, before);
    p->step(nullptr);
    for (int i = 0; i < 48; ++i) {
      const JointDef& j = joint(p, i);
      const double expected =
          j.lower + 0.5 * (static_cast<double>(static_cast<float>(a)) + 1) * (j.upper - j.lower);
      if (coupled_dof(i % 24))
        EXPECT_EQ(p->world(0).target()[i], before[i]) << "never commanded: " << i;
      else
        EXPECT_DOUBLE_EQ(p->world(0).target()[i], expected) << j.name.text;
    }
  }
}

TEST_F(Hands, EachActionEntryMovesItsOwnJoint) {
  TestPool p("hand_over_safe_finger", 1);
  const int dofs[] = {0, 1, 2, 3, 4, 6, 7, 8, 10, 11, 12, 14, 15, 16, 17, 19, 20, 21, 22, 23};
  for (int k = 0; k < 40; ++k) {
    p->reset(nullptr, nullptr);
    p->baseline(Baseline::kZero);
    p.action(0)[k] = 1;
    p->step(nullptr);
    for (int i = 0; i < 48; ++i) {
      const JointDef& j = joint(p, i);
      if (coupled_dof(i % 24)) continue;
      const bool mine = i == 24 * (k / 20) + dofs[k % 20];
      EXPECT_NEAR(p->world(0).target()[i], mine ? j.upper : 0.5 * (j.lower + j.upper), 1e-12)
          << k << " " << i;
    }
  }
}

TEST_F(Hands, JointsAreDrawnInAShareOfTheirRange) {
  TestPool p("hand_over_safe_finger", 400, {kStraight});
  p->reset(nullptr, nullptr);
  double low[48], high[48];
  std::fill(low, low + 48, 9.0);
  std::fill(high, high + 48, -9.0);
  bool differ = false;
  for (int env = 0; env < 400; ++env) {
    const World& w = p->world(env);
    for (int i = 0; i < 48; ++i) {
      low[i] = std::min(low[i], w.q()[i]);
      high[i] = std::max(high[i], w.q()[i]);
      EXPECT_EQ(w.qd()[i], 0);
      EXPECT_FLOAT_EQ(static_cast<float>(w.target()[i]), static_cast<float>(w.q()[i]));
      if (!coupled_dof(i % 24)) continue;
      EXPECT_NEAR(w.q()[i], std::min(1.571, w.q()[i - 1] * 0.00805 / 0.00705), 1e-6);
    }
    differ = differ || w.q()[3] != w.q()[27];
  }
  EXPECT_TRUE(differ);  // the hands draw apart
  for (int i = 0; i < 48; ++i) {
    if (coupled_dof(i % 24)) continue;
    const JointDef& j = joint(p, i);
    const double a = std::max(j.lower, 0.2 * j.lower), b = 0.2 * j.upper, margin = 0.03 * (j.upper - j.lower);
    EXPECT_GE(low[i], a - 1e-12) << j.name.text;
    EXPECT_LT(low[i], a + margin);
    EXPECT_LE(high[i], b + 1e-12);
    EXPECT_GT(high[i], b - margin);
  }
}

TEST_F(Hands, LiteralNoiseIsOneDrawForBothHands) {
  TestPool p("hand_over_safe_finger", 20, {kStraight, {"joint_noise_mode", "literal", 0}});
  p->reset(nullptr, nullptr);
  int at_limit = 0;
  for (int env = 0; env < 20; ++env)
    for (int i = 0; i < 24; ++i) {
      EXPECT_EQ(p->world(env).q()[i], p->world(env).q()[i + 24]);
      at_limit += i == 3 && p->world(env).q()[i] == 0;
    }
  EXPECT_GT(at_limit, 3);  // draws below the range end on it
  EXPECT_LT(at_limit, 17);
}

TEST_F(Hands, NoNoiseIsTheStraightHand) {
  TestPool p("hand_over_safe_finger", 1, {kStraight, {"joint_noise", nullptr, 0}});
  p->reset(nullptr, nullptr);
  for (int i = 0; i < 48; ++i) EXPECT_EQ(p->world(0).q()[i], 0);
}

// 0.00705 q_distal = 0.00805 q_middle within 0.001 m of tendon, or, as the paper has it, equal angles.
TEST_F(Hands, DistalJointsFollow) {
  for (const char* coupling : {"model", "paper"}) {
    TestPool p("hand_over_safe_finger", 1,
               {{"coupling", coupling, 0}, {"fall_height", nullptr, -10}, {"start.x", nullptr, 3}});
    p->reset(nullptr, nullptr);
    p->baseline(Baseline::kHold);
    p.action(0)[4] = static_cast<float>(to_action(0, 1.571, 0.8));
    for (int t = 0; t < 70; ++t) p->step(nullptr);
    const double* q = p->world(0).q();
    EXPECT_NEAR(q[4], 0.8, 0.01);
    if (*coupling == 'm')
      EXPECT_NEAR(q[5], 0.913, 0.142 + 0.005);
    else
      EXPECT_NEAR(q[5], q[4], 0.02);
  }
}

// Palm normals at rest: the right palm and the mirrored left one look up, a right copy turned over looks
// down.
TEST_F(Hands, LeftModel) {
  const auto palm_up = [](const char* model, int32_t hand) {
    TestPool p("hand_over_safe_finger", 1, {{"left_model", model, 0}, {"joint_noise", nullptr, 0}});
    p->reset(nullptr, nullptr);
    const Scene& scene = p->world(0).scene();
    // the thumb's base sits on the palmar side of the palm
    const Vec3 palm = p->world(0).link(scene.link_offset[static_cast<size_t>(hand)] + 1).X.p;
    const Vec3 thumb = p->world(0).link(scene.link_offset[static_cast<size_t>(hand)] + 19).X.p;
    return thumb.z - palm.z;
  };
  EXPECT_NEAR(palm_up("mirror", 0), 0.009, 1e-9);
  EXPECT_NEAR(palm_up("mirror", 1), 0.009, 1e-9);
  EXPECT_NEAR(palm_up("right_copy", 1), -0.009, 1e-9);
}

TEST_F(Hands, MovingAverageSmoothsTargets) {
  TestPool p("hand_over_safe_finger", 1,
             {kStraight, {"action_average", nullptr, 0.25}, {"joint_noise", nullptr, 0}});
  p->reset(nullptr, nullptr);
  p->baseline(Baseline::kHold);
  p.action(0)[3] = 1;
  double expected = 0;
  for (int t = 0; t < 5; ++t) {
    p->step(nullptr);
    expected += 0.25 * (1.571 - expected);
    EXPECT_NEAR(p->world(0).target()[3], expected, 1e-9);
  }
}

TEST_F(Hands, RobotOptionsReachBothHands) {
  TestPool p("hand_over_safe_finger", 1, {{"joint.FFJ2.kp", nullptr, 2.5}, {"scale.kd", nullptr, 2}});
  for (const int32_t i : {3, 27}) {
    EXPECT_EQ(joint(p, i).kp, 2.5);
    EXPECT_DOUBLE_EQ(joint(p, i).kd, 0.2);
  }
}

}  // namespace
}  // namespace rdm::test

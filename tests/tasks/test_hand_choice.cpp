// Any hand on any arm in every task of hands: layouts follow, poses are met, bytes do not depend on threads,
// and what cannot be is refused by name.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "robot/robots.hpp"
#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kHandTasks[] = {"hand_over_safe_finger",
                                      "hand_over_safe_joint",
                                      "catch_underarm_safe_finger",
                                      "catch_underarm_safe_joint",
                                      "grasp",
                                      "reorient",
                                      "hand_over_wall",
                                      "jenga",
                                      "pick_bottles",
                                      "clean_house"};
constexpr const char* kHands[] = {"shadow", "allegro", "svh", "barrett", "robotiq"};
constexpr const char* kArms[] = {"panda", "irb4600", "jaco", "iiwa", "xarm", "crb15000", "ur5e", "ur10e"};

class HandChoice : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

void expect_steps(TestPool& p, const std::string& what) {
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 8; ++t) {
    p->baseline(t < 4 ? Baseline::kHold : Baseline::kRandom);
    p->step(nullptr);
    EXPECT_EQ(p.rows().status[0] & kStatusDiverged, 0u) << what << " step " << t;
  }
  const int32_t dim = p->obs_dim();
  for (int32_t i = 0; i < dim; ++i) EXPECT_TRUE(std::isfinite(p.rows().obs[i])) << what << " entry " << i;
}

TEST_F(HandChoice, EveryHandPlaysEveryTask) {
  std::set<uint64_t> layouts;
  for (const char* task : kHandTasks)
    for (const char* hand : kHands) {
      TestPool p(task, 1, {{"hand", hand, 0}});
      expect_steps(p, std::string(task) + " " + hand);
      if (std::string(task) == "grasp") layouts.insert(layout_hash(p->task()));
    }
  EXPECT_EQ(layouts.size(), std::size(kHands)) << "policies of different hands are told apart";
}

TEST_F(HandChoice, EveryArmCarriesEveryHandInEveryTask) {
  int turn = 0;  // each task with each arm, each arm with each hand
  for (const char* task : kHandTasks)
    for (const char* arm : kArms) {
      const char* hand = kHands[turn++ % 5];
      TestPool p(task, 1, {{"hand", hand, 0}, {"arm", arm, 0}});
      expect_steps(p, std::string(task) + " " + hand + " on " + arm);
    }
}

// The palm is where the task's own hand would have it, whatever carries it.
TEST_F(HandChoice, AnArmBringsTheHandToItsPlace) {
  TestPool fixed("hand_over_safe_finger", 1, {{"joint_noise", nullptr, 0}});
  fixed->reset(nullptr, nullptr);
  const Robot& shadow = kShadowHand;
  for (const char* arm : kArms) {
    TestPool p("hand_over_safe_finger", 1, {{"arm", arm, 0}, {"joint_noise", nullptr, 0}});
    p->reset(nullptr, nullptr);
    const Scene &a = fixed->task().scene(), &b = p->task().scene();
    for (size_t hand = 0; hand < 2; ++hand)
      for (const RobotTip& tip : shadow.tips) {
        const int32_t offset = b.link_offset[hand] + RobotRef(find_robot(arm))->links.count;
        const Vec3 there = fixed->world(0).link(a.link_offset[hand] + tip.link).X * tip.p_L;
        const Vec3 here = p->world(0).link(offset + tip.link).X * tip.p_L;
        EXPECT_LT(norm(there - here), 1e-5) << arm << " hand " << hand;
      }
  }
}

// With its weight held, an arm and its hand stay where they are.
TEST_F(HandChoice, ArmsHoldTheirPose) {
  for (const char* arm : kArms) {
    TestPool p("hand_over_safe_finger", 1,
               {{"arm", arm, 0},
                {"joint_noise", nullptr, 0},
                {"start.y", nullptr, 5},
                {"fall_height", nullptr, -10}});
    p->reset(nullptr, nullptr);
    const World& w = p->world(0);
    const std::vector<double> before(w.q(), w.q() + w.scene().num_links);
    for (int t = 0; t < 60; ++t) p->baseline(Baseline::kHold), p->step(nullptr);
    const int32_t links = RobotRef(find_robot(arm))->links.count;
    for (int32_t i = 0; i < links; ++i)
      EXPECT_NEAR(w.q()[i], before[static_cast<size_t>(i)], 2e-3) << arm << " " << i;
  }
}

TEST_F(HandChoice, SidesDiffer) {
  TestPool p("hand_over_safe_finger", 2, {{"right.hand", "allegro", 0}, {"left.arm", "ur5e", 0}});
  EXPECT_EQ(p->task().action_dim(), 16 + 6 + 20);
  expect_steps(p, "allegro to shadow on ur5e");
  EXPECT_NE(std::string(p->task().action_order()).find("allegro"), std::string::npos);
}

TEST_F(HandChoice, SameBytesForAnyThreads) {
  for (const char* control : {"position", "velocity", "torque"}) {
    const auto hash = [&](int32_t threads) {
      PoolConfig config;
      config.num_threads = threads;
      TestPool p("jenga", 4, {{"pair", "paper", 0}, {"control", control, 0}}, config);
      p->reset(nullptr, nullptr);
      for (int t = 0; t < 10; ++t) p->baseline(Baseline::kRandom), p->step(nullptr);
      return p->hash(-1);
    };
    EXPECT_EQ(hash(1), hash(3)) << control;
  }
}

// Options name the joints of the robots that were chosen, and no others.
TEST_F(HandChoice, OptionsFollowTheRobots) {
  TestPool p("grasp", 1,
             {{"hand", "allegro", 0},
              {"arm", "iiwa", 0},
              {"joint.ffj1.kp", nullptr, 2.5},
              {"joint.joint_3.effort", nullptr, 77}});
  EXPECT_EQ(p->options().number("joint.ffj1.kp"), 2.5);
  EXPECT_FALSE(p->options().knows("joint.WRJ1.kp"));
  bool found = false;
  const Scene& scene = p->task().scene();
  for (int32_t i = 0; i < scene.num_links; ++i)
    if (scene.link(i).joint.name == "right_joint_3") found = scene.link(i).joint.effort == 77;
  EXPECT_TRUE(found);
}

TEST_F(HandChoice, WhatCannotBeIsRefusedByName) {
  const auto refused = [](std::initializer_list<OptionInput> options, Code code, const char* word) {
    try {
      TestPool p("grasp", 1, options);
      ADD_FAILURE() << word;
    } catch (const Error& e) {
      EXPECT_EQ(e.code, code) << e.text;
      EXPECT_NE(std::string(e.text).find(word), std::string::npos) << e.text;
    }
  };
  refused({{"hand", "alegro", 0}}, Code::kNotFound, "nearest is allegro");
  refused({{"hand", "ur5e", 0}}, Code::kUnsupported, "ur5e is not a hand");
  refused({{"arm", "allegro", 0}}, Code::kUnsupported, "not an arm");
  refused({{"arm", "ur5e", 0}, {"arm_base", "1 2 3", 0}}, Code::kArgument, "4 numbers");
  refused({{"arm", "ur5e", 0}, {"arm_base", "9 9 0 0", 0}}, Code::kUnsupported, "cannot bring");
  refused({{"arm", "ur5e", 0}, {"arm_pose", "0 0 0", 0}}, Code::kArgument, "6 numbers");
  refused({{"hand", "allegro", 0}, {"joint.WRJ1.kp", nullptr, 1}}, Code::kNotFound, "joint.WRJ1.kp");
}

// A range is drawn for each world anew; the middle is what the scene is made of.
TEST_F(HandChoice, RangesAreDrawnForEachWorld) {
  TestPool p(
      "grasp", 8,
      {{"object_mass", "0.05..0.15", 0}, {"scale.kp", "0.7..1.3", 0}, {"friction.hand_object", "0.5..1", 0}});
  p->reset(nullptr, nullptr);
  std::set<double> masses;
  const Scene& scene = p->task().scene();
  EXPECT_NEAR(scene.def.bodies[0].inertia.mass, 0.1, 1e-12);
  for (int32_t e = 0; e < 8; ++e) {
    const Dynamics* d = p->world(e).dynamics();
    ASSERT_NE(d, nullptr);
    const double mass = d->body_inertia(scene, 0).mass;
    EXPECT_GE(mass, 0.05);
    EXPECT_LE(mass, 0.15);
    masses.insert(mass);
    EXPECT_EQ(d->links[0].kp, d->links[23].kp) << "one option is one draw";
    EXPECT_GE(d->links[0].kp, 0.7);
    EXPECT_LE(d->links[0].kp, 1.3);
  }
  EXPECT_EQ(masses.size(), 8u);
  const double before = p->world(0).dynamics()->bodies[0].mass;
  p->reset(nullptr, nullptr);
  EXPECT_NE(p->world(0).dynamics()->bodies[0].mass, before);
}

TEST_F(HandChoice, LevelsDrawWhatIsNotGiven) {
  TestPool none("grasp", 1, {{"level", nullptr, 0}});
  EXPECT_EQ(none->world(0).dynamics(), nullptr);
  TestPool p("grasp", 4, {{"level", nullptr, 2}, {"object_mass", nullptr, 0.2}});
  p->reset(nullptr, nullptr);
  for (int32_t e = 0; e < 4; ++e) {
    const Dynamics* d = p->world(e).dynamics();
    EXPECT_EQ(d->bodies[0].mass, 1) << "given";
    EXPECT_NE(d->links[0].mass, 1);
    EXPECT_GE(d->links[0].mass, 0.8);
    EXPECT_LE(d->links[0].mass, 1.2);
  }
}

}  // namespace
}  // namespace rdm::test

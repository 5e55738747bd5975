// The list of robots: what is in it, and robots that come and go.
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <iterator>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "robot/mounted.hpp"
#include "robot/robots.hpp"

namespace rdm {
namespace {

struct Known {
  const char *name, *alias;
  RobotKind kind;
  int32_t joints, commands;
  double mass;  // kg, the sum of the sources' links
};
const Known kKnown[] = {
    {"shadow_hand", "shadow", RobotKind::kHand, 24, 20, 4.911 + 0.1},  // with the mount under the forearm
    {"allegro_hand", "allegro", RobotKind::kHand, 16, 16, 1.04426},
    {"schunk_svh", "svh", RobotKind::kHand, 20, 9, 1.29998},
    {"barrett_bh282", "barrett", RobotKind::kHand, 8, 4, 0.98},
    {"robotiq_3f", "robotiq", RobotKind::kHand, 11, 4, 2.5},
    {"franka_panda", "panda", RobotKind::kArm, 7, 7, 16.6919},
    {"abb_irb4600", "irb4600", RobotKind::kArm, 6, 6, 425},
    {"kinova_jaco2", "jaco", RobotKind::kArm, 6, 6, 3.834574},
    {"kuka_iiwa7", "iiwa", RobotKind::kArm, 7, 7, 27.11193},
    {"xarm6", "xarm", RobotKind::kArm, 6, 6, 10.4536},
    {"abb_crb15000", "crb15000", RobotKind::kArm, 6, 6, 28.001},
    {"ur5e", nullptr, RobotKind::kArm, 6, 6, 21.7},
    {"ur10e", nullptr, RobotKind::kArm, 6, 6, 33.104},
};

// Their numbers are in files and in hosts' memories: a robot is added at the end of the list.
TEST(Robots, BeginWithThePapersFiveHandsAndEightArms) {
  ASSERT_GE(num_robots(), static_cast<int32_t>(std::size(kKnown)));
  for (int32_t i = 0; i < static_cast<int32_t>(std::size(kKnown)); ++i) {
    const Known& known = kKnown[i];
    const RobotRef robot(i);
    EXPECT_STREQ(robot->name, known.name) << "the list of robots is append-only";
    EXPECT_EQ(find_robot(known.name), i);
    if (known.alias) {
      EXPECT_EQ(find_robot(known.alias), i);
    } else {
      EXPECT_EQ(robot->alias, nullptr) << known.name;
    }
    EXPECT_EQ(robot->kind, known.kind) << known.name;
    EXPECT_EQ(robot->links.count, known.joints) << known.name;
    EXPECT_EQ(robot->num_actuated(), known.commands) << known.name;
    double mass = robot->root.mass;
    for (const RobotLink& link : robot->links) mass += link.mass;
    EXPECT_NEAR(mass, known.mass, 2e-5) << known.name;
  }
}

TEST(Robots, StandWhereTheyCanStand) {
  for (int32_t i = 0; i < num_robots(); ++i) {
    const RobotRef robot(i);
    EXPECT_NO_THROW(check_robot(*robot)) << robot->name;
    for (int32_t k = 0; k < robot->links.count; ++k) {
      const RobotLink& l = robot->links[k];
      const double q = robot->home.count ? robot->home[k] : 0;
      EXPECT_GE(q, l.lower) << l.joint;
      EXPECT_LE(q, l.upper) << l.joint;
      if (robot->passive) continue;
      EXPECT_GT(l.kp, 0) << l.joint;
      EXPECT_GT(l.kd, 0) << l.joint;
      EXPECT_GT(l.effort, 0) << l.joint;
    }
    if (robot->kind == RobotKind::kHand) {
      EXPECT_EQ(robot->poses.folded.count, robot->links.count) << robot->name;
      EXPECT_EQ(robot->poses.closed.count, robot->num_actuated()) << robot->name;
      EXPECT_GE(robot->fingers.count, 3) << robot->name;
      int thumbs = 0;
      for (const RobotFinger& f : robot->fingers) thumbs += f.thumb;
      EXPECT_EQ(thumbs, 1) << robot->name;
      EXPECT_TRUE(robot->fingers[robot->fingers.count - 1].thumb) << robot->name;
      EXPECT_GE(robot->mirror, 0) << robot->name;
      EXPECT_GT(robot->self_pairs.count, 0) << robot->name;
      EXPECT_LE(robot->self_pairs.count, 120) << robot->name;
      // the holding point is before the palm
      const double before = dot(robot->p_hold - robot->p_palm, robot->n_palm);
      EXPECT_GT(before, 0.005) << robot->name;
      EXPECT_LT(before, 0.02) << robot->name;
      // what is coupled agrees in the folded pose
      for (const RobotCoupling& c : robot->couplings)
        EXPECT_NEAR(robot->poses.folded[c.link], c.ratio * robot->poses.folded[c.other], c.slack + 1e-4)
            << robot->links[c.link].joint;
    } else if (robot->kind == RobotKind::kArm) {
      EXPECT_EQ(robot->flange, robot->links.count - 1) << robot->name;
    }
  }
}

TEST(Robots, PairsAreNoNeighboursAndStandOnce) {
  for (int32_t i = 0; i < num_robots(); ++i) {
    const RobotRef robot(i);
    std::set<std::pair<int32_t, int32_t>> seen;
    const auto parent = [&](int32_t link) { return link < 0 ? kNoLink : robot->links[link].parent; };
    for (const RobotPair& p : robot->self_pairs) {
      EXPECT_TRUE(seen.insert({std::min(p.a, p.b), std::max(p.a, p.b)}).second) << robot->name;
      const int32_t a = robot->shapes[p.a].link, b = robot->shapes[p.b].link;
      if (&*robot == &kShadowHand) continue;  // its list is the source's
      EXPECT_NE(parent(a), b) << robot->name << " " << robot->shapes[p.a].name;
      EXPECT_NE(parent(b), a) << robot->name << " " << robot->shapes[p.a].name;
    }
  }
}

// The drives of the gripper: counts 0, 140 and 240 of 255 in its source's map.
TEST(Robots, CurvesFollowTheMapOfTheGripper) {
  const Robot& robot = kRobotiq3f;
  const auto count = [](double g) { return g / 127.5 - 1; };
  const RobotCurve &one = *robot.curve(1), &two = *robot.curve(2), &three = *robot.curve(3);
  const struct {
    double g, one, two, three;  // degrees
  } rows[] = {
      {70, 35, 0, -35}, {140, 70, 0, -70}, {190, 70, 45, -62.5}, {240, 70, 90, -55}, {255, 70, 90, -55}};
  for (const auto& row : rows) {
    EXPECT_NEAR(one.at(count(row.g)), row.one * kDegree, 1e-4) << row.g;
    EXPECT_NEAR(two.at(count(row.g)), row.two * kDegree, 1e-4) << row.g;
    EXPECT_NEAR(three.at(count(row.g)), row.three * kDegree, 1e-4) << row.g;
  }
  EXPECT_NEAR(robot.curve(0)->at(count(10)), 11 * kDegree, 1e-9);
  EXPECT_NEAR(robot.curve(0)->at(count(127.5)), 0, 1e-9);
  for (double g = 0; g <= 255; g += 5)  // the two of the scissor are opposite
    EXPECT_NEAR(robot.curve(0)->at(count(g)), -robot.curve(4)->at(count(g)), 1e-12);
  for (const double q : {0.1, 0.6, 1.2}) EXPECT_NEAR(one.at(one.inverse(q)), q, 1e-12);
  EXPECT_EQ(robot.actuated(0), 1);
  EXPECT_EQ(robot.actuated(3), 0);
}

TEST(Robots, ComeAndGo) {
  const std::string name = "come_and_go";
  RobotCopy copy(kUr5e);
  copy.bind().name = copy.keep(name.c_str());
  copy.bind().alias = copy.keep("cag");
  const int32_t before = num_robots(), index = add_robot(copy.robot());
  EXPECT_EQ(index, before);
  EXPECT_EQ(find_robot("Come_And_Go"), index);
  EXPECT_EQ(find_robot("cag"), index);
  for (const char* taken : {"come_and_go", "cag", "panda", "ur5e"}) {
    RobotCopy again(kUr10e);
    again.bind().name = again.keep(taken);
    EXPECT_THROW(add_robot(again.robot()), Error) << taken;
    again.bind().name = again.keep("another");
    again.bind().alias = again.keep(taken);
    EXPECT_THROW(add_robot(again.robot()), Error) << taken;
  }
  copy.links[0].mass = 99;  // the list has its own
  RobotRef ref(index);
  EXPECT_EQ(ref->links[0].mass, kUr5e.links[0].mass);
  EXPECT_NE(ref->name, copy.robot().name);
  EXPECT_STREQ(ref->name, name.c_str());
  remove_robot(index);
  EXPECT_STREQ(ref->name, name.c_str());  // who holds a reference keeps it
  EXPECT_THROW(RobotRef{index}, Error);
  EXPECT_THROW(remove_robot(index), Error);
  EXPECT_THROW(find_robot("come_and_go"), Error);
  RobotRef moved = std::move(ref);
  EXPECT_EQ(moved->links.count, 6);
  moved = RobotRef(0);
  EXPECT_EQ(&*moved, &kShadowHand);
  const int32_t next = add_robot(copy.bind());  // the name is free again, the number is not
  EXPECT_GT(next, index);
  EXPECT_EQ(RobotRef(next)->links[0].mass, 99);
  remove_robot(next);
  for (const int32_t own : {0, 12}) EXPECT_THROW(remove_robot(own), Error);
  EXPECT_THROW(remove_robot(num_robots()), Error);
}

TEST(Robots, NamesTheNearest) {
  try {
    find_robot("allegro_hnd");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Code::kNotFound);
    EXPECT_NE(std::strstr(e.text, "allegro_hand"), nullptr) << e.text;
  }
  EXPECT_THROW(find_robot(nullptr), Error);
}

// Threads that add, look, mount and remove at the same time.
TEST(Robots, ManyThreadsMayAddAndRemove) {
  constexpr int kThreads = 4, kRounds = 40;
  std::atomic<int> failures{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([t, &failures] {
      try {
        for (int k = 0; k < kRounds; ++k) {
          const std::string name = "thread_" + std::to_string(t) + "_" + std::to_string(k);
          RobotCopy copy(t % 2 ? kUr5e : kXarm6);
          copy.bind().name = copy.keep(name.c_str());
          copy.bind().alias = nullptr;
          const int32_t index = add_robot(copy.robot());
          {
            const RobotRef ref(index);
            if (name != ref->name || find_robot(name.c_str()) != index) ++failures;
            for (int32_t i = 0; i < num_robots(); ++i) try {  // others' come and go
                const RobotRef other(i);
                if (other->links.count < 1) ++failures;
              } catch (const Error& e) {
                if (e.code != Code::kNotFound) ++failures;
              }
            if (k % 2) remove_robot(index);
            const RobotCopy both = make_mounted(*ref, kAllegroHand, {});
            if (both.robot().links.count != 22) ++failures;
          }
          if (k % 2 == 0) remove_robot(index);
        }
      } catch (const Error&) {
        ++failures;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(failures, 0);
}

}  // namespace
}  // namespace rdm

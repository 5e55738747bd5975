// Every robot of the list, and every hand on every arm, in the engine: holding the start pose, bearing its
// weight, and random commands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "robot/kinematics.hpp"
#include "robot/mounted.hpp"
#include "robot/robots.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

constexpr double kStepSeconds = 1.0 / 60;  // of a control step

SceneDef scene_of(const Robot& robot, Side side = Side::kRight) {
  SceneDef def;
  def.articulations.push_back(make_articulation(robot, side, {{0, 0, 0.1}, {}}, ""));
  return def;
}

std::vector<double> start_of(const Robot& robot) {
  std::vector<double> q;
  for (int32_t i = 0; i < robot.links.count; ++i)
    q.push_back(robot.home.count ? robot.home[i]
                                 : std::clamp(0.0, robot.links[i].lower, robot.links[i].upper));
  return q;
}

// All robots alone, then every hand on every arm. What is passive has nothing to hold it but springs:
// test_articulated_objects.cpp.
template <class F>
void for_all(F&& f) {
  std::vector<const Robot*> arms, hands;
  int32_t alone = 0;
  for (int32_t i = 0; i < num_robots(); ++i) {
    const RobotRef ref(i);
    if (ref->kind == RobotKind::kArm) arms.push_back(&*ref);
    if (ref->kind == RobotKind::kHand) hands.push_back(&*ref);
    if (ref->passive) continue;
    f(*ref);
    ++alone;
  }
  ASSERT_FALSE(hands.empty() || arms.empty());
  ASSERT_GE(static_cast<size_t>(alone), hands.size() + arms.size());
  for (const Robot* arm : arms)
    for (const Robot* hand : hands) f(make_mounted(*arm, *hand, {}).robot());
}

TEST(RobotMotion, EveryRobotHoldsItsStartPose) {
  for_all([](const Robot& robot) {
    test::Simulation sim(scene_of(robot), EngineKind::kArticulated);
    const std::vector<double> q = start_of(robot), still(q.size());
    sim->set_joints(0, q.data(), still.data());
    for (size_t i = 0; i < q.size(); ++i) sim->target()[i] = q[i];
    int contacts = 0;
    for (int k = 0; k < 120; ++k) {
      sim->step();
      contacts += sim->num_contacts();
    }
    EXPECT_EQ(sim->status() & kStatusDiverged, 0u) << robot.name;
    EXPECT_EQ(contacts, 0) << robot.name;  // nothing overlaps where it starts
    double off = 0;
    for (size_t i = 0; i < q.size(); ++i) off = std::max(off, std::abs(sim->q()[i] - q[i]));
    EXPECT_LT(off, 1e-3) << robot.name;
  });
}

// With its weight and nothing but its drives: it comes to rest, kp times the sag is the torque, and no drive
// is at its bound, though a Shadow Hand (5 kg) is more than small arms are made for.
TEST(RobotMotion, DrivesBearTheWeight) {
  for_all([](const Robot& robot) {
    SceneDef def = scene_of(robot);
    def.articulations[0].gravity = true;
    test::Simulation sim(std::move(def), EngineKind::kArticulated);
    const std::vector<double> q = start_of(robot), still(q.size());
    sim->set_joints(0, q.data(), still.data());
    for (size_t i = 0; i < q.size(); ++i) sim->target()[i] = q[i];
    for (int k = 0; k < 240; ++k) sim->step();
    for (size_t i = 0; i < q.size(); ++i) {
      const RobotLink& l = robot.links[static_cast<int32_t>(i)];
      EXPECT_LT(std::abs(sim->q()[i] - q[i]), 0.15) << robot.name << " " << l.joint;
      EXPECT_LT(std::abs(sim->torque()[i]), 0.9 * l.effort) << robot.name << " " << l.joint;
      if (!robot.coupled(static_cast<int32_t>(i))) {  // a tendon hangs in its slack
        EXPECT_LT(std::abs(sim->qd()[i]), 0.01) << robot.name << " " << l.joint;
      }
    }
  });
}

// What a host's commands do to the targets: the joint's range or its curve, no faster than the drive's
// velocity.
class Commands {
 public:
  Commands(const Robot& robot, const std::vector<double>& q) : robot_(robot), target_(q) {}
  void apply(const std::vector<double>& command, double* target) {
    for (int32_t i = 0; i < robot_.links.count; ++i) {
      const RobotLink& l = robot_.links[i];
      if (robot_.coupled(i)) continue;
      const RobotCurve* curve = robot_.curve(i);
      const double a = command[static_cast<size_t>(robot_.action_of(curve ? curve->driver : i))];
      const double goal = curve ? curve->at(a) : l.lower + 0.5 * (a + 1) * (l.upper - l.lower);
      double& t = target_[static_cast<size_t>(i)];
      const double most = l.velocity > 0 ? l.velocity * kStepSeconds : 1e3;
      t += std::clamp(goal - t, -most, most);
      target[i] = t;
    }
  }

 private:
  const Robot& robot_;
  std::vector<double> target_;
};

uint64_t next(uint64_t* stream) {  // splitmix64
  uint64_t z = (*stream += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
double unit(uint64_t* stream) {
  return static_cast<double>(next(stream) >> 11) * 0x1p-53;
}

// 1,000 control steps of commands that are drawn anew every 10: finite, within limits, at speeds that a drive
// can make.
TEST(RobotMotion, RandomCommandsDoNotDiverge) {
  for_all([](const Robot& robot) {
    test::Simulation sim(scene_of(robot), EngineKind::kArticulated);
    const std::vector<double> q = start_of(robot), still(q.size());
    sim->set_joints(0, q.data(), still.data());
    Commands commands(robot, q);
    std::vector<double> command(static_cast<size_t>(robot.num_actuated()));
    uint64_t stream = 5;
    double fastest = 0, outside = 0, loose = 0;
    int touching = 0;
    size_t fastest_joint = 0;
    for (int k = 0; k < 1000; ++k) {
      if (k % 10 == 0)
        for (double& a : command) a = 2 * unit(&stream) - 1;
      commands.apply(command, sim->target());
      sim->step();
      ASSERT_EQ(sim->status() & kStatusDiverged, 0u) << robot.name << " diverged at step " << k;
      touching += sim->num_contacts() > 0;
      for (size_t i = 0; i < q.size(); ++i) {
        const RobotLink& l = robot.links[static_cast<int32_t>(i)];
        if (std::abs(sim->qd()[i]) > fastest) {
          fastest = std::abs(sim->qd()[i]);
          fastest_joint = i;
        }
        outside = std::max({outside, l.lower - sim->q()[i], sim->q()[i] - l.upper});
      }
      for (const RobotCoupling& c : robot.couplings)
        if (c.slack == 0) {
          const RobotLink& l = robot.links[c.link];
          loose = std::max(
              loose, std::abs(sim->q()[c.link] - std::clamp(c.ratio * sim->q()[c.other], l.lower, l.upper)));
        }
    }
    std::printf("%-28s fastest %6.1f rad/s (%s), outside %.4f rad, coupled off %.3f rad, touching %3d\n",
                robot.name, fastest, robot.links[static_cast<int32_t>(fastest_joint)].joint, outside, loose,
                touching);
    EXPECT_LT(fastest, 100) << robot.name;
    EXPECT_LT(outside, 0.02) << robot.name;
  });
}

}  // namespace
}  // namespace rdm

#include <gtest/gtest.h>

#include <string>

#include "base/error.hpp"
#include "env/options/robot.hpp"
#include "robot_rows.hpp"

namespace rdm {
namespace {

Options robot_options(std::initializer_list<OptionInput> inputs) {
  struct Filled : OwnOptionTable {
    Filled() {
      add_robot_rows(kShadowHand, *this);
      add_robot_scales(*this);
    }
  };
  static const Filled table;
  Options o;
  o.add_table(table.rows(), table.count());
  for (const OptionInput& in : inputs) o.set(in, "test");
  return o;
}

ArticulationDef hand_with(std::initializer_list<OptionInput> inputs) {
  ArticulationDef def = make_articulation(kShadowHand, Side::kLeft, {}, "left_");
  DynamicsDraws draws;
  apply_robot_options(robot_options(inputs), kShadowHand, "left_", 0, 0, &def, &draws);
  return def;
}

TEST(RobotOptions, DefaultsAreTheTables) {
  const Options o = robot_options({});
  EXPECT_EQ(o.count(), 24 * 5 + 24 + 5);
  EXPECT_EQ(o.number("joint.WRJ1.kp"), 5);
  EXPECT_EQ(o.number("joint.FFJ1.effort"), 0.7245);
  EXPECT_EQ(o.number("link.palm.mass"), 0.3);
  const ArticulationDef def = hand_with({}), plain = make_articulation(kShadowHand, Side::kLeft, {}, "left_");
  for (size_t i = 0; i < 24; ++i) {
    EXPECT_EQ(def.links[i].joint.kp, plain.links[i].joint.kp);
    EXPECT_EQ(def.links[i].joint.kd, plain.links[i].joint.kd);
    EXPECT_EQ(def.links[i].inertia.mass, plain.links[i].inertia.mass);
  }
}

TEST(RobotOptions, ReachJointsAndLinks) {
  const auto joint = static_cast<size_t>(joint_row(kShadowHand, "FFJ2"));
  const auto link = static_cast<size_t>(link_row(kShadowHand, "ff_middle"));
  const ArticulationDef def = hand_with({{"joint.FFJ2.kp", nullptr, 3},
                                         {"joint.ffj2.kd", nullptr, 0.2},
                                         {"joint.FFJ2.effort", nullptr, 0.4},
                                         {"joint.FFJ2.friction", nullptr, 0.01},
                                         {"joint.FFJ2.armature", nullptr, 0.002},
                                         {"link.ff_middle.mass", nullptr, 0.024}});
  EXPECT_EQ(def.links[joint].joint.kp, 3);
  EXPECT_EQ(def.links[joint].joint.kd, 0.2);
  EXPECT_EQ(def.links[joint].joint.effort, 0.4);
  EXPECT_EQ(def.links[joint].joint.friction, 0.01);
  EXPECT_EQ(def.links[joint].joint.armature, 0.002);
  EXPECT_EQ(def.links[joint + 1].joint.kp, 1);
  EXPECT_EQ(def.links[link].inertia.mass, 0.024);
  EXPECT_DOUBLE_EQ(def.links[link].inertia.moment[0], 2e-5);  // moments follow
}

TEST(RobotOptions, ScalesMultiplyTheSingleValues) {
  const ArticulationDef def = hand_with({{"joint.WRJ1.kp", nullptr, 2},
                                         {"scale.kp", nullptr, 3},
                                         {"scale.kd", nullptr, 2},
                                         {"scale.mass", nullptr, 0.5},
                                         {"scale.friction", nullptr, 4}});
  EXPECT_DOUBLE_EQ(def.links[0].joint.kp, 6);
  EXPECT_DOUBLE_EQ(def.links[1].joint.kp, 15);
  EXPECT_DOUBLE_EQ(def.links[1].joint.kd, 1);
  EXPECT_DOUBLE_EQ(def.links[1].joint.friction, 0.004);
  EXPECT_DOUBLE_EQ(def.links[1].inertia.mass, 0.15);
}

TEST(RobotOptions, DampingStaysAboveZero) {
  EXPECT_EQ(guard([] { robot_options({{"joint.FFJ2.kd", nullptr, 0}}); }), Code::kRange);
  EXPECT_EQ(guard([] { robot_options({{"joint.FFJ9.kd", nullptr, 1}}); }), Code::kNotFound);
}

TEST(RobotOptions, HaveRoomForTheNamesOfEveryRobot) {
  for (const Robot* robot :
       {&kAllegroHand, &kSchunkSvh, &kBarrettBh282, &kRobotiq3f, &kFrankaPanda, &kAbbIrb4600, &kKinovaJaco2,
        &kKukaIiwa7, &kXarm6, &kAbbCrb15000, &kUr5e, &kUr10e}) {
    ChosenOptionTable table;
    add_robot_rows(*robot, table);
    EXPECT_EQ(table.count(), robot->links.count * 6) << robot->name;
    Options o;
    o.add_table(table.rows(), table.count());
    const RobotLink& last = robot->links[robot->links.count - 1];
    const std::string key = std::string("joint.") + last.joint + ".armature";
    EXPECT_EQ(o.number(key.c_str()), last.armature) << key;
  }
}

}  // namespace
}  // namespace rdm

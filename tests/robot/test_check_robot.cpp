// One change each to a sound robot, and what check_robot says of it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "base/error.hpp"
#include "robot/robot_copy.hpp"
#include "robot/robots.hpp"

namespace rdm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Row {
  Code code;
  const char* text;  // without "robot ...: "
  std::function<void(RobotCopy&)> spoil;
  const char* robot = "robotiq";  // has curves, commands, fingers, a mount
};

bool same_text(const char* a, const char* b) {
  return a && std::strcmp(a, b) == 0;
}

// Rows of the copy are changed, then bound; what is no row is changed in the robot itself.
Robot& self(RobotCopy& c) {
  return c.bind();
}

const Row kRows[] = {
    // names
    {Code::kArgument, "robot: the name is empty", [](RobotCopy& c) { self(c).name = ""; }},
    {Code::kArgument, "robot: the name is empty", [](RobotCopy& c) { self(c).name = nullptr; }},
    {Code::kRange, "robot abcdefghijklmnopqrstuvwxyz: the name is longer than 25 characters",
     [](RobotCopy& c) { self(c).name = "abcdefghijklmnopqrstuvwxyz"; }},
    {Code::kArgument, "robot a b: a name is made of letters, digits, '_', '-' and '+'",
     [](RobotCopy& c) { self(c).alias = "a b"; }},
    {Code::kArgument, "link: the name is empty", [](RobotCopy& c) { c.links[1].name = nullptr; }},
    {Code::kArgument, "joint: the name is empty", [](RobotCopy& c) { c.links[1].joint = ""; }},
    {Code::kArgument, "shape: the name is empty", [](RobotCopy& c) { c.shapes[1].name = ""; }},
    {Code::kArgument, "finger: the name is empty", [](RobotCopy& c) { c.fingers[1].name = ""; }},
    {Code::kArgument, "link finger_1_link_0 occurs twice",
     [](RobotCopy& c) { c.links[3].name = c.links[0].name; }},
    {Code::kArgument, "joint Finger_1_Joint_1 occurs twice",
     [](RobotCopy& c) { c.links[3].joint = "Finger_1_Joint_1"; }},
    {Code::kArgument, "shape palm occurs twice", [](RobotCopy& c) { c.shapes[4].name = "palm"; }},
    // links
    {Code::kRange, "the number of links, 0, is outside [1, 64]", [](RobotCopy& c) { c.links.clear(); }},
    {Code::kRange, "the number of links, 65, is outside [1, 64]",
     [](RobotCopy& c) { c.links.resize(65, c.links[0]); }},
    {Code::kRange, "finger_1_link_2: parent 2 does not come before row 2",
     [](RobotCopy& c) { c.links[2].parent = 2; }},
    {Code::kRange, "finger_1_link_2: parent -2 does not come before row 2",
     [](RobotCopy& c) { c.links[2].parent = -2; }},
    {Code::kArgument, "finger_1_link_2: position is not finite",
     [](RobotCopy& c) { c.links[2].p_PL.y = kNan; }},
    {Code::kArgument, "finger_1_link_2: rotation is not finite",
     [](RobotCopy& c) { c.links[2].rpy_PL.y = kInf; }},
    {Code::kArgument, "finger_1_link_2: the quaternion has length 2, not 1",
     [](RobotCopy& c) { c.links[2].q_PL.w = 2; }},
    {Code::kArgument, "finger_1_link_2: centre of mass is not finite",
     [](RobotCopy& c) { c.links[2].com.z = kNan; }},
    {Code::kRange, "finger_1_link_2: mass -0.1 is outside [0, 1000000]",
     [](RobotCopy& c) { c.links[2].mass = -0.1; }},
    {Code::kArgument, "finger_1_link_2: it has moments of inertia, but no mass",
     [](RobotCopy& c) { c.links[2].mass = 0; }},
    {Code::kArgument, "finger_1_link_2: moment of inertia is not finite",
     [](RobotCopy& c) { c.links[2].moment[4] = kNan; }},
    {Code::kArgument, "finger_1_link_2: the moment of inertia is not positive definite",
     [](RobotCopy& c) { c.links[2].moment[0] = -1e-5; }},
    {Code::kArgument,
     "finger_1_link_2: principal moments 2.752e-05, 7.523e-05, 0.00016 violate the triangle inequality",
     [](RobotCopy& c) { c.links[2].moment[2] = 1.6e-4; }},
    {Code::kRange, "finger_1_joint_2: the kind of the joint is unknown",
     [](RobotCopy& c) { c.links[2].kind = static_cast<JointKind>(7); }},
    {Code::kArgument, "finger_1_joint_2: axis has length 0, not 1",
     [](RobotCopy& c) { c.links[2].axis = {}; }},
    {Code::kArgument, "finger_1_joint_2: lower limit is not finite",
     [](RobotCopy& c) { c.links[2].lower = -kInf; }},
    {Code::kArgument, "finger_1_joint_2: upper limit is not finite",
     [](RobotCopy& c) { c.links[2].upper = kNan; }},
    {Code::kRange, "finger_1_joint_2: the range [0, 0] is empty", [](RobotCopy& c) { c.links[2].upper = 0; }},
    {Code::kRange, "finger_1_joint_2: kp -1 is outside [0, 1000000]",
     [](RobotCopy& c) { c.links[2].kp = -1; }},
    {Code::kArgument, "finger_1_joint_2: kd is not finite", [](RobotCopy& c) { c.links[2].kd = kNan; }},
    {Code::kRange, "finger_1_joint_2: effort -1 is outside [0, 1000000]",
     [](RobotCopy& c) { c.links[2].effort = -1; }},
    {Code::kRange, "finger_1_joint_2: armature 10000000 is outside [0, 1000000]",
     [](RobotCopy& c) { c.links[2].armature = 1e7; }},
    {Code::kArgument, "finger_1_joint_2: friction is not finite",
     [](RobotCopy& c) { c.links[2].friction = kInf; }},
    {Code::kRange, "finger_1_joint_2: velocity -2 is outside [0, 1000000]",
     [](RobotCopy& c) { c.links[2].velocity = -2; }},
    {Code::kRange, "root: mass -1 is outside [0, 1000000]", [](RobotCopy& c) { self(c).root.mass = -1; }},
    {Code::kArgument, "root: position is not finite", [](RobotCopy& c) { self(c).X_BR.p.x = kNan; }},
    // shapes and pairs
    {Code::kRange, "f1_root: link 11 is outside [-1, 11)", [](RobotCopy& c) { c.shapes[2].link = 11; }},
    {Code::kRange, "f1_root: link -2 is outside [-1, 11)", [](RobotCopy& c) { c.shapes[2].link = -2; }},
    {Code::kArgument, "f1_root: quaternion is not finite", [](RobotCopy& c) { c.shapes[2].q.x = kNan; }},
    {Code::kRange, "f1_root: position 10000000 is outside [-1000000, 1000000]",
     [](RobotCopy& c) { c.shapes[2].p.x = 1e7; }},
    {Code::kRange, "f1_root: size 0 is outside [1e-06, 1000]", [](RobotCopy& c) { c.shapes[2].size.z = 0; }},
    {Code::kRange, "f1_root: size 0 is outside [1e-06, 1000]",
     [](RobotCopy& c) {
       c.shapes[2].kind = ShapeKind::kCapsule;
       c.shapes[2].size = {0.1, 0, 0};
     }},
    {Code::kUnsupported, "f1_root: a robot's shapes are spheres, capsules, boxes, cylinders and ellipsoids",
     [](RobotCopy& c) { c.shapes[2].kind = ShapeKind::kHull; }},
    {Code::kRange, "pair: shape 13 is outside [0, 13)", [](RobotCopy& c) { c.self_pairs[3].b = 13; }},
    {Code::kRange, "pair: shape -1 is outside [0, 13)", [](RobotCopy& c) { c.self_pairs[3].a = -1; }},
    {Code::kArgument, "pair: palm and middle_root are on one link",
     [](RobotCopy& c) {
       c.self_pairs[3] = {0, 1};
     }},
    // couplings
    {Code::kRange, "coupling: link 8 is outside [0, 8)", [](RobotCopy& c) { c.couplings[0].link = 8; },
     "barrett"},
    {Code::kRange, "bh_j13_joint: coupling: the other link -1 is outside [0, 8)",
     [](RobotCopy& c) { c.couplings[0].other = -1; }, "barrett"},
    {Code::kRange, "bh_j13_joint: ratio 5000 is outside [-1000, 1000]",
     [](RobotCopy& c) { c.couplings[0].ratio = 5000; }, "barrett"},
    {Code::kRange, "bh_j13_joint: slack -1 is outside [0, 1000]",
     [](RobotCopy& c) { c.couplings[0].slack = -1; }, "barrett"},
    {Code::kArgument, "bh_j13_joint follows bh_j21_joint, which follows itself",
     [](RobotCopy& c) { c.couplings[0].other = 3; }, "barrett"},
    {Code::kArgument, "bh_j13_joint is coupled twice",
     [](RobotCopy& c) { c.couplings.push_back(c.couplings[0]); }, "barrett"},
    // curves and commands
    {Code::kRange, "curve: link -1 is outside [0, 11)", [](RobotCopy& c) { c.curves[1].link = -1; }},
    {Code::kRange, "finger_1_joint_1: curve: the driver 11 is outside [0, 11)",
     [](RobotCopy& c) { c.curves[1].driver = 11; }},
    {Code::kRange, "finger_1_joint_1: the number of knots, 1, is outside [2, 4]",
     [](RobotCopy& c) { c.curves[1].knots = 1; }},
    {Code::kRange, "finger_1_joint_1: the number of knots, 5, is outside [2, 4]",
     [](RobotCopy& c) { c.curves[1].knots = 5; }},
    {Code::kRange, "finger_1_joint_1: command of a knot -1.5 is outside [-1, 1]",
     [](RobotCopy& c) { c.curves[1].command[0] = -1.5; }},
    {Code::kRange, "finger_1_joint_1: angle of a knot 2 is outside [0.0495, 1.2218]",
     [](RobotCopy& c) { c.curves[1].angle[1] = 2; }},
    {Code::kArgument, "finger_1_joint_1: the commands of its knots are not ascending",
     [](RobotCopy& c) { c.curves[1].command[0] = c.curves[1].command[1]; }},
    {Code::kArgument, "finger_1_joint_2: it cannot both be coupled and have a curve",
     [](RobotCopy& c) {
       c.couplings.push_back({2, 1, 1, 0});
     }},
    {Code::kArgument, "finger_1_joint_1 has two curves",
     [](RobotCopy& c) { c.curves.push_back(c.curves[1]); }},
    {Code::kRange, "commands: link 11 is outside [0, 11)", [](RobotCopy& c) { c.commands[0] = 11; }},
    {Code::kArgument, "commands: finger_2_joint_1 occurs twice, or follows another joint",
     [](RobotCopy& c) { c.commands[2] = c.commands[1]; }},
    {Code::kArgument, "commands: finger_1_joint_2 occurs twice, or follows another joint",
     [](RobotCopy& c) { c.commands[0] = 2; }},
    {Code::kArgument, "palm_finger_1_joint: its driver palm_finger_1_joint has no command",
     [](RobotCopy& c) {
       c.commands.pop_back();
       c.closed.clear();
     }},
    // poses
    {Code::kRange, "home: it has 10 joints, but the robot has 11", [](RobotCopy& c) { c.home.pop_back(); }},
    {Code::kRange, "finger_1_joint_1: home 0 is outside [0.0495, 1.2218]",
     [](RobotCopy& c) { c.home[1] = 0; }},
    {Code::kRange, "finger_1_joint_1: folded 3 is outside [0.0495, 1.2218]",
     [](RobotCopy& c) { c.folded[1] = 3; }},
    {Code::kRange, "closed: it has 3 commands, but the robot has 4",
     [](RobotCopy& c) { c.closed.pop_back(); }},
    {Code::kRange, "closed: command 2 is outside [-1, 1]", [](RobotCopy& c) { c.closed[2] = 2; }},
    // tips and fingers
    {Code::kArgument, "it has 3 fingers, but 2 tips", [](RobotCopy& c) { c.tips.pop_back(); }},
    {Code::kRange, "tip: link -1 is outside [0, 11)", [](RobotCopy& c) { c.tips[0].link = -1; }},
    {Code::kArgument, "finger_1_link_3: tip is not finite", [](RobotCopy& c) { c.tips[0].p_L.x = kNan; }},
    {Code::kRange, "f1: first link 5 is outside [0, 4)", [](RobotCopy& c) { c.fingers[0].first = 5; }},
    {Code::kArgument,
     "finger f2: link finger_2_link_1, between its first link and its tip, belongs to another finger",
     [](RobotCopy& c) { c.links[5].parent = 0; }},
    {Code::kRange, "f1: a joint of it 6 is outside [0, 4)", [](RobotCopy& c) { c.fingers[0].proximal = 6; }},
    // palm, mount, flange
    {Code::kRange, "palm: link 11 is outside [-1, 11)", [](RobotCopy& c) { self(c).palm = 11; }},
    {Code::kArgument, "palm: position is not finite", [](RobotCopy& c) { self(c).p_palm.x = kNan; }},
    {Code::kArgument, "palm: holding point is not finite", [](RobotCopy& c) { self(c).p_hold.x = kNan; }},
    {Code::kArgument, "palm: normal has length 3, not 1",
     [](RobotCopy& c) {
       self(c).n_palm = {0, 3, 0};
     }},
    {Code::kArgument, "palm: direction of the fingers has length 0, not 1",
     [](RobotCopy& c) { self(c).z_palm = {}; }},
    {Code::kArgument, "palm: the direction of the fingers is not in the palm's plane",
     [](RobotCopy& c) { self(c).z_palm = self(c).n_palm; }},
    {Code::kArgument, "a hand must have a palm", [](RobotCopy& c) { self(c).palm = kNoLink; }},
    {Code::kArgument, "a hand must have fingers", [](RobotCopy& c) { c.fingers.clear(); }},
    {Code::kArgument, "mount: the quaternion has length 0, not 1",
     [](RobotCopy& c) {
       self(c).X_RM.q = {0, 0, 0, 0};
     }},
    {Code::kRange, "mirror: axis 3 is outside [-1, 3)", [](RobotCopy& c) { self(c).mirror = 3; }},
    {Code::kArgument, "an arm must have a flange", [](RobotCopy& c) { self(c).flange = kNoLink; }, "ur5e"},
    {Code::kRange, "flange: link 6 is outside [0, 6)", [](RobotCopy& c) { self(c).flange = 6; }, "ur5e"},
    {Code::kArgument, "flange: position is not finite", [](RobotCopy& c) { self(c).X_LF.p.y = kNan; },
     "ur5e"},
};

TEST(CheckRobot, NamesTheRowAndTheNumber) {
  const int32_t before = num_robots();
  for (const Row& row : kRows) {
    const RobotRef sound(find_robot(row.robot));
    RobotCopy copy(*sound);
    copy.bind().name = copy.keep("spoiled");
    copy.bind().alias = nullptr;
    EXPECT_NO_THROW(check_robot(copy.robot()));
    row.spoil(copy);
    copy.bind();
    for (const bool adding : {false, true}) try {  // no robot joins the list by being refused
        if (adding)
          add_robot(copy.robot());
        else
          check_robot(copy.robot());
        ADD_FAILURE() << "taken: " << row.text;
      } catch (const Error& e) {
        EXPECT_EQ(e.code, row.code) << row.text;
        const char* owner = same_text(copy.robot().name, "spoiled") ? "robot spoiled: " : "robot ";
        EXPECT_EQ(std::strncmp(e.text, owner, std::strlen(owner)), 0) << e.text;
        const char* colon = std::strstr(e.text, ": ");
        ASSERT_NE(colon, nullptr) << e.text;
        EXPECT_STREQ(colon + 2, row.text);
        EXPECT_EQ(std::strchr(e.text, '\n'), nullptr) << e.text;
      }
  }
  EXPECT_EQ(num_robots(), before);
}

TEST(CheckRobot, TakesALinkOfNoMass) {
  RobotCopy copy(kUr5e);
  copy.links[2].mass = 0;
  for (double& m : copy.links[2].moment) m = 0;
  EXPECT_NO_THROW(check_robot(copy.bind()));
}

}  // namespace
}  // namespace rdm

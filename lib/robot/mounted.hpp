// A hand on an arm, as one robot; and the left one of a robot with sides.
#pragma once
#include "robot/robot_copy.hpp"

namespace rdm {

struct Mounting {
  double yaw = 0;      // rad, of the hand about the flange's z
  double adapter = 0;  // m, thickness of a plate between flange and hand
};

// Pose of the hand's root in the frame of the arm's flange: Rz(yaw) Tz(adapter) X_RM^-1.
Pose mounted_root(const Robot& hand, const Mounting& mounting);

// The arm's rows, then the hand's; the hand's root and the arm's last link are one body. Shapes of the hand
// may touch those of the arm, but its root's not the last two links'. A name that both have is the hand's
// with "hand_" before it. The start pose is that of both. Error(kUnsupported) for what is no arm or no hand,
// or for more than kMaxRobotLinks links.
RobotCopy make_mounted(const Robot& arm, const Robot& hand, const Mounting& mounting);

// The exact mirror image as tables: what make_articulation makes of Side::kLeft, to be mounted on an arm that
// is none. Error(kUnsupported) for a robot without sides.
RobotCopy make_mirrored(const Robot& robot);

}  // namespace rdm

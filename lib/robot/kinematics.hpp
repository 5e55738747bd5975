// Where a robot's links are, and which joint angles bring a flange to a place.
//
// Frames: R the root of a robot's tables, L a link, F the flange. The inverse is by damped least squares
// (Wampler 1986; Nakamura and Hanafusa 1986). With the pose error e, m and rad, and J the flange's Jacobian:
//   dq = J' (J J' + lambda^2 1)^-1 e,   q := clamp(q + dq),   lambda^2 = |e|^2 / 2 + 1e-9 (Sugihara 2011).
#pragma once
#include "base/host.hpp"
#include "robot/robot.hpp"

namespace rdm {

// A link's frame in its parent's with the joint at 0.
Pose link_frame(const RobotLink& link);
// Where a joint is at the start: in the pose `q`, or where that is empty at 0, or the limit nearest to it.
double start_angle(const Robot& robot, const Table<double>& q, int32_t link);

// Poses of all links in the root frame, [links]; q [links], rad (m).
void link_poses(const Robot& robot, const double* q, Pose* X_RL);
// Of one link; kRootLink: the identity.
Pose link_pose(const Robot& robot, const double* q, int32_t link);
Pose flange_pose(const Robot& robot, const double* q);
// Where its hand is in the root frame: origin at the holding point, y into the back of the palm, z as the
// fingers point. Any two hands that are put with these frames on one another hold a thing at the same place.
Pose palm_frame(const Robot& robot, const double* q);

// Angles within the limits for which the flange is at X_RF, beginning at q [links], which is overwritten.
// False when it ends more than 1e-6 m or rad off; then q is where it ended.
bool solve_reach(const Robot& robot, const Pose& X_RF, double* q);

// Moves the palm's frame by dp (m) and dw (rad, a rotation vector), both in the root frame, by joints of the links before the
// palm. Up to four damped steps
//   dq = J' (J J' + kPalmDamping^2 1)^-1 e
// go to the pose that this asks for; those that would leave [low, high] stay at the bound, and others do their part. No joint
// goes further than `most` in all: then all go less far. So does the palm near a singular pose and at limits. q [links], rad
// (m), is changed.
struct PalmJoints {
  const int32_t* joints;  // [count] links
  const double *low, *high, *most;
  int32_t count;
};
inline constexpr double kPalmDamping = 0.02;
void move_palm(const Robot& robot, const PalmJoints& by, const Vec3& dp, const Vec3& dw, double* q);

// Length of the arm, stretched, from the first joint's axis to the flange, m: an upper bound of its reach.
double arm_length(const Robot& robot);

// A place for an arm's base, and its pose there.
struct ArmPlace {
  Pose X_WB;
  double score;              // the higher the farther from joint limits and singular poses, and the nearer
                             // to the side that was asked for
  double q[kMaxRobotLinks];  // [links] rad (m)
};
// Places from which an arm's flange reaches X_WF, the best first: upright, on the ground z = 0 or above, if
// it can be on the side of `from` (its level part counts, of any length). wide: also far off, behind the hand
// and from other poses, about ten times as many looks.
Vector<ArmPlace> arm_places(const Robot& arm, const Pose& X_WF, const Vec3& from, bool wide);
// The same for a base that stands at X_WB already: poses that reach, the best first.
Vector<ArmPlace> arm_poses(const Robot& arm, const Pose& X_WF, const Pose& X_WB);
// The best of the places nearby, or where there is none of all. False when no place was found.
bool place_arm(const Robot& arm, const Pose& X_WF, const Vec3& from, Pose* X_WB, double* q);

}  // namespace rdm

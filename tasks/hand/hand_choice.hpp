// Which robots the hands of a task are, by its options, and where they stand: any hand, flying or on a fixed
// base as the task has it, or on any arm.
//
// A task says where the mounts of its own robot are (HandControlConfig). Another hand stands so that its
// holding point and its palm are where that robot's would be (palm_frame in kinematics.hpp); an arm so that
// it carries the hand there, and its angles in that pose are its home.
#pragma once
#include "env/option_table.hpp"
#include "physics/model/scene.hpp"
#include "robot/robots.hpp"

namespace rdm {

struct HandControlConfig;

inline constexpr int kMaxHands = 2;
extern const char* const kSideNames[kMaxHands];  // "right", "left"

// What a task or a preset of it has in the place of the empty texts of one side's options; "": as the common
// ones.
struct HandDefault {
  const char *hand, *arm, *arm_base, *arm_pose;
};

// One of them, made concrete.
struct ChosenHand {
  RobotRef listed;             // keeps a robot of the list while the task lives
  RobotCopy mounted;           // of hand and arm, when there is one
  const Robot* own = nullptr;  // the task's own robot; null: another
  bool armed = false;
  Side side = Side::kRight;  // as make_articulation takes it; a mounted left hand is mirrored already
  Pose X_WB;
  RobotRef arm;         // of the list, when there is one
  bool chosen = false;  // the arm's pose is not the host's word
  bool given = false;   // the arm's base is
  Pose X_WF;            // where the arm's flange is at the start
  Vec3 from;            // from where the arm comes to it

  const Robot& robot() const { return armed ? mounted.robot() : own ? *own : *listed; }
};

// Options of the choice, and those of the joints and links of all robots that were chosen. Returns the number
// of shapes of those that are not the task's own.
int32_t add_hand_choice_options(const HandControlConfig& config, OptionTable& table);

// Error(kNotFound) for a name that no robot has; Error(kUnsupported) for what is no hand or no arm, for the
// left one of a robot without sides, and for an arm that does not reach.
ChosenHand choose_hand(const HandControlConfig& config, const Options& options, int32_t i);

// The arm stands at X_WB and begins with these angles [arm_links], rad.
void set_arm(const Pose& X_WB, const double* q, ChosenHand* hand);

}  // namespace rdm

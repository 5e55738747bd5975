// One description for every hand and arm: plain tables, and the articulation made from them.
//
// A table describes the right hand (or the arm). Its frames hang on a root frame, which sits in the base
// frame of the articulation at `X_BR`.
#pragma once
#include <cstdint>

#include "base/table.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

struct RobotLink {
  const char* name;
  const char* joint;
  int32_t parent;     // row in the same table, -1: the root
  Vec3 p_PL, rpy_PL;  // in the parent's frame at q = 0; m, rad about fixed axes
  double mass;        // kg
  Vec3 com;
  double moment[6];  // xx yy zz xy xz yz about com, kg m2
  JointKind kind;
  Vec3 axis;
  double lower, upper;
  double kp, kd, effort;
  double armature, friction;
  double velocity = 0;  // rad/s (m/s): how fast a drive's target may move; 0: at once
  Quat q_PL = {};       // turns the frame further, after rpy_PL
};

struct RobotShape {
  int32_t link;  // -1: the root
  const char* name;
  ShapeKind kind;
  Vec3 size;  // as ShapeDef::size
  Vec3 p;
  Quat q;
  uint8_t color[3];  // of the right side
};

struct RobotPair {
  int32_t a, b;  // rows of the shape table
};

// Joint of `link` follows that of `other`, q = ratio q_other +- slack; drive and effort stand in the link's
// row.
struct RobotCoupling {
  int32_t link, other;
  double ratio, slack;
};

// A motor that drives several joints (a gripper's), or one by another law than "-1 is lower, 1 is upper": the
// target of `link` is piecewise linear in the command of `driver`. A link whose driver is another has no
// command of its own.
inline constexpr int32_t kMaxKnots = 4;
struct RobotCurve {
  int32_t link, driver;            // rows of the table of links
  int32_t knots;                   // 2..kMaxKnots
  double command[kMaxKnots];       // ascending, from -1 to 1
  double angle[kMaxKnots];         // rad (m)
  double at(double a) const;       // the target; commands outside go to the ends
  double inverse(double q) const;  // the first command whose target is nearest to q
};

struct RobotTip {
  int32_t link;
  Vec3 p_L;  // the point beyond which nothing of the finger reaches
};

// What a finger of a hand is made of: its rows stand together, from `first` to the link of its tip, and row i
// of the table of fingers ends in row i of the tips. A role that a finger has not is -1.
struct RobotFinger {
  const char* name;  // of its observations, short
  int32_t first;     // row of its first link
  int32_t lateral;   // row of the joint that spreads it to a side
  int32_t proximal;  // row of the joint that bends it at its base
  int32_t middle;    // row of the next joint that bends it
  bool thumb = false;
};

// Two poses that tasks of hands begin with, in joint coordinates and in commands.
struct HandPoses {
  Table<double> folded;  // rad, of each link's joint: fingers straight, the thumb across the palm
  Table<float> closed;   // [num_actuated] commands in [-1, 1]: wrist down, fingers and thumb around 5 cm
};

enum class Side : int32_t { kRight = 0, kLeft = 1 };

enum class RobotKind : int32_t { kOther = 0, kHand = 1, kArm = 2 };

inline constexpr int32_t kRootLink = -1, kNoLink = -2;
inline constexpr int32_t kMaxRobotLinks = 64;

struct Robot {
  const char* name;
  const char* help;  // one line
  RobotKind kind = RobotKind::kOther;
  const char* alias = nullptr;  // a shorter name
  Pose X_BR;                    // root frame in the base frame
  Inertia root;                 // of the root link, in the root frame
  Table<RobotLink> links;
  Table<RobotShape> shapes;
  Table<RobotPair> self_pairs = {};
  Table<RobotCoupling> couplings = {};
  Table<RobotCurve> curves = {};
  // Links with a command of their own, in action order; empty: all but the coupled and the driven ones, in
  // the order of their rows.
  Table<int32_t> commands = {};
  bool passive = false;       // nothing is commanded: springs of its joints hold to `home`
  Table<double> home = {};    // [links] rad, where it stands at the start; empty: all 0
  Table<RobotTip> tips = {};  // in the order of the fingers; they carry the force sensors
  int32_t palm = kNoLink;     // link or kRootLink
  Vec3 p_palm = {};           // centre of the palm's surface, in that link
  Vec3 n_palm = {0, -1, 0};   // the way it faces, out of the palm, in that link; unit
  Vec3 z_palm = {0, 0, 1};    // the way the fingers point, or of a gripper any in the palm's plane; unit
  int32_t mirror = -1;        // root axis normal to the mirror plane of a left hand, -1: no sides

  // A hand sits on an arm with its mount frame in the arm's flange frame; z of both points out of the arm, to
  // the fingers (mounted.hpp).
  Pose X_RM = {};  // of hands: the mount frame in the root frame
  int32_t arm_links = 0,
          arm_commands = 0;  // of a hand on an arm: rows and commands that come first, the arm's
  int32_t flange = kNoLink;  // of arms: the link that carries it
  Pose X_LF = {};            // the flange frame in that link

  // Of hands; empty for anything else.
  Table<RobotFinger> fingers = {};  // the first finger first, as the tips
  HandPoses poses = {};
  Vec3 p_hold = {};  // in the palm's link: where a thing is that palm and fingers hold

  // Rows with a command of their own, in action order.
  int32_t num_actuated() const;
  bool coupled(int32_t link) const;
  const RobotCurve* curve(int32_t link) const;  // null: -1 is lower, 1 is upper
  // Row of the i-th command.
  int32_t actuated(int32_t i) const;
  // The other way round: place of a link's joint in action order, -1: none, or no such link.
  int32_t action_of(int32_t link) const;
  // The same of the joint that leads it, where it follows another.
  int32_t leading_action(int32_t link) const;
  // The palm's own joint and that of the link before it, which a hand with a wrist has: rows, else -1.
  int32_t wrist_flexion() const { return palm >= arm_links ? palm : -1; }
  int32_t wrist_deviation() const {
    const int32_t link = wrist_flexion() < 0 ? -1 : links[palm].parent;
    return link >= arm_links ? link : -1;
  }

 private:
  bool follows(int32_t link) const;  // coupled, or driven by another's command
};

// The robot at X_WB; every link, joint and shape name gets the prefix ("right_"). A left one is the exact
// mirror image: positions and rotations are reflected, joint limits and the meaning of angles stay.
// Error(kUnsupported) for the left of a robot without sides.
ArticulationDef make_articulation(const Robot& robot, Side side, const Pose& X_WB, const char* prefix);

// Mirror images about the plane through the origin normal to `axis` (0, 1, 2).
Vec3 mirrored_point(const Vec3& p, int32_t axis);
Vec3 mirrored_axis(const Vec3& a, int32_t axis);  // of a turn: a pseudovector
Quat mirrored_turn(const Quat& q, int32_t axis);
Inertia mirrored_inertia(const Inertia& inertia, int32_t axis);

// Error(kArgument) or Error(kRange) for a robot that no articulation could be made of, with the name of the
// row.
void check_robot(const Robot& robot);

// The tables in the library.
extern const Robot kShadowHand, kAllegroHand, kSchunkSvh, kBarrettBh282, kRobotiq3f;
extern const Robot kFrankaPanda, kAbbIrb4600, kKinovaJaco2, kKukaIiwa7, kXarm6, kAbbCrb15000, kUr5e, kUr10e;
extern const Robot kDrawer, kDoor, kScrewBottle, kScissors, kTap;  // articulated objects

}  // namespace rdm

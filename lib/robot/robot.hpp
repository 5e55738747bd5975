// One description for every hand and arm: plain tables, and the articulation made from them.
//
// A table describes the right hand (or the arm). Its frames hang on a root frame, which sits in the base
// frame of the articulation at `X_BR`.
#pragma once
#include <cstdint>

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

// Joint of `link` follows that of `other`; drive and effort stand in the link's row.
struct RobotCoupling {
  int32_t link, other;
  double ratio, slack;
};

struct RobotTip {
  int32_t link;
  Vec3 p_L;  // the point beyond which nothing of the finger reaches
};

template <class T>
struct Table {
  const T* rows = nullptr;
  int32_t count = 0;
  const T* begin() const { return rows; }
  const T* end() const { return rows + count; }
  const T& operator[](int32_t i) const { return rows[i]; }
};
template <class T, int32_t N>
constexpr Table<T> table(const T (&rows)[N]) {
  return {rows, N};
}

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

struct Robot {
  const char* name;
  const char* help;  // one line
  Pose X_BR;         // root frame in the base frame
  Inertia root;      // of the root link, in the root frame
  Table<RobotLink> links;
  Table<RobotShape> shapes;
  Table<RobotPair> self_pairs = {};
  Table<RobotCoupling> couplings = {};
  Table<RobotTip> tips = {};  // in the order of the fingers; they carry the force sensors
  int32_t palm = -1;          // link, -1: none
  Vec3 p_palm = {};           // centre of the palm's surface, in that link
  int32_t mirror = -1;        // root axis normal to the mirror plane of a left hand, -1: no sides

  // Of hands; empty for anything else.
  Table<RobotFinger> fingers = {};  // the first finger first, as the tips
  HandPoses poses = {};
  Vec3 p_hold = {};  // in the palm's link: where a thing is that palm and fingers hold

  // Rows with a drive of their own, in action order: all links but the coupled ones.
  int32_t num_actuated() const { return links.count - couplings.count; }
  bool coupled(int32_t link) const;
  // Row of the i-th actuated joint.
  int32_t actuated(int32_t i) const;
  // The other way round: place of a link's joint in action order, -1: none, or no such link.
  int32_t action_of(int32_t link) const;
};

// The robot at X_WB; every link, joint and shape name gets the prefix ("right_"). A left one is the exact
// mirror image: positions and rotations are reflected, joint limits and the meaning of angles stay.
// Error(kUnsupported) for the left of a robot without sides.
ArticulationDef make_articulation(const Robot& robot, Side side, const Pose& X_WB, const char* prefix);

// Mirror images about the plane through the origin normal to `axis` (0, 1, 2).
Vec3 mirrored_point(const Vec3& p, int32_t axis);
Vec3 mirrored_axis(const Vec3& a, int32_t axis);  // of a turn: a pseudovector
Quat mirrored_turn(const Quat& q, int32_t axis);

// One row for each table in the library.
int32_t num_robots();
const Robot& robot(int32_t i);

extern const Robot kShadowHand;

}  // namespace rdm

// Short ways to write the rows of a robot's tables.
//
// Pairs that may touch were found by sampling: those that came nearer than 5 mm in 5,000 random poses inside
// the limits. Left out are neighbours, and what overlaps only because shapes are fitted fat: in more than
// half of the poses, at the start pose, or across a short link.
#pragma once
#include "robot/robot.hpp"

namespace rdm::rows {

inline constexpr Vec3 kX = {1, 0, 0}, kY = {0, 1, 0}, kZ = {0, 0, 1};
inline constexpr double kQuarter = kPi / 2;
inline constexpr double kRoot = 0.70710678118654752;  // of a quarter turn's quaternion
// They turn the axis of a capsule, which is z.
inline constexpr Quat kAlongX = {kRoot, 0, kRoot, 0}, kAlongY = {kRoot, -kRoot, 0, 0};

struct Body {
  double mass;  // kg
  Vec3 com;
  double moment[6];  // xx yy zz xy xz yz about com, kg m2
};
struct Range {
  double lower, upper;  // rad
};
struct Drive {
  double kp, kd, effort;  // N m/rad, N m s/rad, N m
  double velocity;        // rad/s
  double armature = 0, friction = 0;
};
struct Color {
  uint8_t r, g, b;
};

constexpr RobotLink turning(const char* name, const char* joint, int32_t parent, Vec3 p, Vec3 rpy, Vec3 axis,
                            Range range, const Body& b, const Drive& d) {
  return {name,
          joint,
          parent,
          p,
          rpy,
          b.mass,
          b.com,
          {b.moment[0], b.moment[1], b.moment[2], b.moment[3], b.moment[4], b.moment[5]},
          JointKind::kRevolute,
          axis,
          range.lower,
          range.upper,
          d.kp,
          d.kd,
          d.effort,
          d.armature,
          d.friction,
          d.velocity};
}

constexpr RobotShape sphere(int32_t link, const char* name, double radius, Vec3 p, Color c) {
  return {link, name, ShapeKind::kSphere, {radius, 0, 0}, p, {}, {c.r, c.g, c.b}};
}
constexpr RobotShape capsule(int32_t link, const char* name, double radius, double half, Vec3 p, Color c,
                             Quat q = {}) {
  return {link, name, ShapeKind::kCapsule, {radius, half, 0}, p, q, {c.r, c.g, c.b}};
}
constexpr RobotShape cylinder(int32_t link, const char* name, double radius, double half, Vec3 p, Color c,
                              Quat q = {}) {
  return {link, name, ShapeKind::kCylinder, {radius, half, 0}, p, q, {c.r, c.g, c.b}};
}
constexpr RobotShape box(int32_t link, const char* name, Vec3 half, Vec3 p, Color c, Quat q = {}) {
  return {link, name, ShapeKind::kBox, half, p, q, {c.r, c.g, c.b}};
}

}  // namespace rdm::rows

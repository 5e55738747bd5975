// What a robot of Safety-Gym is to the tasks Goal and Button, Point or Car: a struct R that starts with a
// FlatRobot, plain, with constants, and functions over it. A task is a template over R, so a robot is one
// file and a task is one.
//
//   kSubsteps, kStep (s)           of a control step
//   kActions, kActionOrder         entries within +-1
//   kReach (m)                     no part of it is further from its middle
//   kFields (RobotField[]), kRobotObs   what it observes beside the sensors here, after the accelerometer
//   check(r)                       of a saved state: Error(kFormat)
//   substep(action, r)             kStep seconds on
//   gap(r, heading, x, y, radius)  its distance from a disc
//   write(r, out)                  kRobotObs numbers
//   add(scene), kHeight (m)        its body for pictures
#pragma once
#include <algorithm>
#include <cstdint>

#include "base/elementary.hpp"
#include "physics/world.hpp"
#include "tasks/planar/planar_scene.hpp"

namespace rdm {

struct FlatRobot {
  double x, y, yaw;  // m, rad
  double vx, vy, w;  // m/s, rad/s; world axes
  double ax, ay;     // m/s2, of the origin, in the last substep
};
void check_flat_robot(const FlatRobot& robot);  // of a saved state: Error(kFormat)

struct RobotField {
  const char* name;
  const char* unit;
  int32_t count;
  float low = kUnbounded, high = kUnbounded;
};

// Least distance of a robot from a disc, < 0: they overlap; and the unit vector from the robot's nearest part
// to the disc's centre.
struct RobotGap {
  double gap, nx, ny;
};
// A rectangle of the robot's frame, and the unit vector out of it for what is all inside.
struct RobotPart {
  double x0, x1, y0, y1;  // m
  double out_x, out_y;
};
RobotGap part_gap(const RobotPart& part, const FlatRobot& robot, const elementary::SinCos& heading, double x,
                  double y, double radius);

// A robot that overlaps a fixed disc steps back and loses its speed into it. True where it touched.
template <class R>
bool block(double x, double y, double radius, R* robot) {
  const RobotGap g = R::gap(*robot, elementary::sincos(robot->yaw), x, y, radius);
  if (g.gap >= 0) return false;
  robot->x += g.gap * g.nx;
  robot->y += g.gap * g.ny;
  const double into = std::max(0.0, robot->vx * g.nx + robot->vy * g.ny);
  robot->vx -= into * g.nx;
  robot->vy -= into * g.ny;
  return true;
}

// Accelerometer, velocimeter, gyro, magnetometer: three numbers each, in the robot's frame.
void write_accelerometer(const FlatRobot& robot, const elementary::SinCos& heading, float* out);
void write_velocimeter(const FlatRobot& robot, const elementary::SinCos& heading, float* out);
void write_gyro(const FlatRobot& robot, float* out);
void write_magnetometer(const elementary::SinCos& heading, float* out);

}  // namespace rdm

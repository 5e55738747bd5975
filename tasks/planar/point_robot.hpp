// The Point robot of Safety-Gym in closed form: a disc with a nose, one thruster and one turning servo.
//
// dt 0.002 s, ten substeps; the servo's gain is above its stability bound at that step, so the substep is
// part of the task. With the heading h, the arm k = mass * 0.0193 m to the centre of mass and the spin w:
//   m p'' + k w' n = (0.3 thrust + k w^2) h - 0.01 p'       n: h turned by 90 degrees to the left
//   I w' + k n . p''  = 0.3 (turn - 0.3 w) - 0.005 w         thrust, turn - 0.3 w within +-0.05
// and semi-implicit steps whose damping is implicit. Agrees with MuJoCo 2.2.2 to four digits away from
// objects.
#pragma once
#include "base/elementary.hpp"
#include "physics/world.hpp"
#include "tasks/planar/planar_scene.hpp"

namespace rdm {

inline constexpr int kPointSubsteps = 10, kPointActions = 2;
inline constexpr double kPointStep = 0.002;  // s
inline constexpr double kPointControlDt = kPointSubsteps * kPointStep;
inline constexpr double kPointRadius = 0.1, kPointNose = 0.1, kPointNoseHalf = 0.05;  // m

struct PointRobot {
  double x, y, yaw;  // m, rad
  double vx, vy, w;  // m/s, rad/s; world axes
  double ax, ay;     // m/s2, of the origin, in the last substep
};

void check_point_robot(const PointRobot& robot);  // of a saved state: Error(kFormat)

// One substep; action (thrust, turn), |entries| <= 1.
void point_substep(const float* action, PointRobot* robot);

// Least distance of the robot's body from a disc around (x, y), < 0: they overlap; and the unit vector from
// the robot's nearest part to the disc's centre.
struct PointGap {
  double gap, nx, ny;
};
PointGap point_gap(const PointRobot& robot, const elementary::SinCos& heading, double x, double y,
                   double radius);

// A robot that overlaps a fixed disc steps back and loses its speed into it. True where it touched.
bool point_block(double x, double y, double radius, PointRobot* robot);

// The body for pictures, and its place.
void add_point_body(PlanarScene& scene);
Motion point_motion(const PointRobot& robot);

// Accelerometer, velocimeter, gyro, magnetometer: three numbers each, in the robot's frame.
void write_accelerometer(const PointRobot& robot, const elementary::SinCos& heading, float* out);
void write_velocimeter(const PointRobot& robot, const elementary::SinCos& heading, float* out);
void write_gyro(const PointRobot& robot, float* out);
void write_magnetometer(const elementary::SinCos& heading, float* out);

}  // namespace rdm

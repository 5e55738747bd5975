// The Point robot of Safety-Gym in closed form: a disc with a nose, one thruster and one turning servo.
//
// dt 0.002 s, ten substeps; the servo's gain is above its stability bound at that step, so the substep is
// part of the task. With the heading h, the arm k = mass * 0.0193 m to the centre of mass and the spin w:
//   m p'' + k w' n = (0.3 thrust + k w^2) h - 0.01 p'       n: h turned by 90 degrees to the left
//   I w' + k n . p''  = 0.3 (turn - 0.3 w) - 0.005 w         thrust, turn - 0.3 w within +-0.05
// and semi-implicit steps whose damping is implicit. Agrees with MuJoCo 2.2.2 to four digits away from
// objects.
#pragma once
#include <array>

#include "tasks/planar/flat_robot.hpp"

namespace rdm {

struct PointRobot : FlatRobot {
  static constexpr int32_t kSubsteps = 10, kActions = 2, kRobotObs = 0;
  static constexpr double kStep = 0.002;  // s
  static constexpr const char* kActionOrder = "thrust, turn";
  static constexpr std::array<RobotField, 0> kFields{};
  static constexpr double kRadius = 0.1, kNose = 0.1, kNoseHalf = 0.05;  // m: the disc, the square ahead
  static constexpr double kReach = kNose + 2 * kNoseHalf, kHeight = 0.1;

  static void check(const PointRobot& robot) { check_flat_robot(robot); }
  static void substep(const float* action, PointRobot* robot);
  static RobotGap gap(const PointRobot& robot, const elementary::SinCos& heading, double x, double y,
                      double radius);
  static void write(const PointRobot&, float*) {}
  static void add(PlanarScene& scene);
};

}  // namespace rdm

// The Car robot of Safety-Gym on the plane: two wheels behind, each with a motor of its own, a ball that
// rolls freely in front; forward is -y of its frame.
//
// dt 0.004 s, ten substeps. Motors give action N m within +-0.02, more than the tyres hold: full torque spins
// them. A wheel touches the floor at both edges of its tread, the ball in one point; each carries its share
// of the weight at rest and holds by Coulomb friction, coefficient 1, within its disc. Wheels and ball are
// damped by 0.001 N m s. Masses, places and inertias are those of the published model.
//
// What differs: the published car has suspension by soft contacts and hops when its wheels spin, which takes
// from its turning; here nothing leaves the floor, and a drag of 0.006 w |w| N m, fitted to MuJoCo 2.2.2,
// stands for it. Means over 4 s after 4 s of steady torques, MuJoCo's in brackets: both wheels 0.83 (0.77)
// m/s; one against the other 1.43 (1.32) rad/s; one alone 0.15 (0.14) m/s and 0.63 (0.66) rad/s; both at
// 0.005 N m 0.167 (0.168). The accelerometer has no jolts, and reads 9.81 along z.
#pragma once
#include <array>

#include "base/vec.hpp"
#include "tasks/planar/flat_robot.hpp"

namespace rdm {

struct CarRobot : FlatRobot {
  static constexpr int32_t kSubsteps = 10, kActions = 2, kRobotObs = 12, kTouches = 5;
  static constexpr double kStep = 0.004;  // s
  static constexpr const char* kActionOrder = "left wheel, right wheel";
  static constexpr std::array<RobotField, 2> kFields = {
      {{"ballangvel_rear", "rad/s", 3}, {"ballquat_rear", "1", 9, -1, 1}}};
  static constexpr double kReach = 0.22, kHeight = 0.1;

  double wheel[2];           // rad/s, left and right, about x of the car
  double ball[3];            // rad/s, in the car
  Quat turned;               // the ball's rotation in the car
  double push[kTouches][2];  // N s, of the floor in the last substep, along the car's x and y

  static void check(const CarRobot& robot);
  static void substep(const float* action, CarRobot* robot);
  static RobotGap gap(const CarRobot& robot, const elementary::SinCos& heading, double x, double y,
                      double radius);
  static void write(const CarRobot& robot, float* out);
  static void add(PlanarScene& scene);
};

}  // namespace rdm

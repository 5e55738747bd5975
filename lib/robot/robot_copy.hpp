// A robot that owns its tables and its names: what is made while the program runs, by a host or from others.
#pragma once
#include "robot/robot.hpp"

namespace rdm {

class RobotCopy {
 public:
  RobotCopy() = default;
  explicit RobotCopy(const Robot& robot);  // deep
  RobotCopy(const RobotCopy&) = delete;
  RobotCopy& operator=(const RobotCopy&) = delete;
  RobotCopy(RobotCopy&&) = default;
  RobotCopy& operator=(RobotCopy&&) = default;

  const Robot& robot() const { return robot_; }

  // Rows to be changed or added to; then bind(), which lets the tables of robot() show them.
  Vector<RobotLink> links;
  Vector<RobotShape> shapes;
  Vector<RobotPair> self_pairs;
  Vector<RobotCoupling> couplings;
  Vector<RobotCurve> curves;
  Vector<int32_t> commands;
  Vector<double> home;
  Vector<RobotTip> tips;
  Vector<RobotFinger> fingers;
  Vector<double> folded;
  Vector<float> closed;
  Robot& bind();

  // A text of its own, as long as the robot lives; null stays null.
  const char* keep(const char* text);

 private:
  Robot robot_ = {};
  Vector<Vector<char>> texts_;  // a text stays where it is when the list grows
};

}  // namespace rdm

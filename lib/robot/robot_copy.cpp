#include "robot/robot_copy.hpp"

#include <cstring>

namespace rdm {
namespace {

template <class T>
void take(Vector<T>* out, const Table<T>& in) {
  out->assign(in.begin(), in.end());
}
template <class T>
void show(Table<T>* out, const Vector<T>& in) {
  *out = {in.data(), static_cast<int32_t>(in.size())};
}

}  // namespace

RobotCopy::RobotCopy(const Robot& robot) : robot_(robot) {
  take(&links, robot.links);
  take(&shapes, robot.shapes);
  take(&self_pairs, robot.self_pairs);
  take(&couplings, robot.couplings);
  take(&curves, robot.curves);
  take(&commands, robot.commands);
  take(&home, robot.home);
  take(&tips, robot.tips);
  take(&fingers, robot.fingers);
  take(&folded, robot.poses.folded);
  take(&closed, robot.poses.closed);
  for (RobotLink& link : links) {
    link.name = keep(link.name);
    link.joint = keep(link.joint);
  }
  for (RobotShape& shape : shapes) shape.name = keep(shape.name);
  for (RobotFinger& finger : fingers) finger.name = keep(finger.name);
  robot_.name = keep(robot.name);
  robot_.help = keep(robot.help);
  robot_.alias = keep(robot.alias);
  bind();
}

Robot& RobotCopy::bind() {
  show(&robot_.links, links);
  show(&robot_.shapes, shapes);
  show(&robot_.self_pairs, self_pairs);
  show(&robot_.couplings, couplings);
  show(&robot_.curves, curves);
  show(&robot_.commands, commands);
  show(&robot_.home, home);
  show(&robot_.tips, tips);
  show(&robot_.fingers, fingers);
  show(&robot_.poses.folded, folded);
  show(&robot_.poses.closed, closed);
  return robot_;
}

const char* RobotCopy::keep(const char* text) {
  if (!text) return nullptr;
  texts_.emplace_back(text, text + std::strlen(text) + 1);
  return texts_.back().data();
}

}  // namespace rdm

// The robots that there are, by number and by name: the library's own tables and those that a host has added.
#pragma once
#include "base/registry.hpp"
#include "robot/robot_copy.hpp"

namespace rdm {

struct Robots {
  using Thing = Robot;
  using Copy = RobotCopy;
  static constexpr const char* kNoun = "robot";
  static constexpr int kRounds = 1;
  static int32_t num_own();
  static const Robot& own(int32_t index);
  static const Robot& shown(const RobotCopy& copy) { return copy.robot(); }
  static bool called(const Robot& robot, const char* name, int round);  // name or alias
  static void check(const Robot& robot);
};
using RobotRef = Ref<Robots>;

inline int32_t num_robots() {
  return Registry<Robots>::get().count();
}
inline int32_t find_robot(const char* name) {
  return Registry<Robots>::get().find(name);
}
inline int32_t add_robot(const Robot& robot) {
  return Registry<Robots>::get().add(robot);
}
inline void remove_robot(int32_t index) {
  Registry<Robots>::get().remove(index);
}

}  // namespace rdm

// Rows of a robot's tables by name.
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "robot/robot.hpp"

namespace rdm {

inline int32_t link_row(const Robot& robot, const std::string& name) {
  for (int32_t i = 0; i < robot.links.count; ++i)
    if (robot.links[i].name == name) return i;
  ADD_FAILURE() << robot.name << " has no link " << name;
  return 0;
}
inline int32_t joint_row(const Robot& robot, const std::string& name) {
  for (int32_t i = 0; i < robot.links.count; ++i)
    if (robot.links[i].joint == name) return i;
  ADD_FAILURE() << robot.name << " has no joint " << name;
  return 0;
}

}  // namespace rdm

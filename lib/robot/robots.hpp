// The robots that there are, by number and by name: the library's own tables and those that a host has added.
//
// Any number of threads may look while others add and remove. A number is never given twice.
#pragma once
#include "robot/robot_copy.hpp"

namespace rdm {

int32_t num_robots();  // numbers that were given; those of removed robots count

// While it lives, the robot stays.
class RobotRef {
 public:
  RobotRef() = default;
  explicit RobotRef(int32_t index);  // Error(kRange); Error(kNotFound): it was removed
  RobotRef(const RobotRef&) = delete;
  RobotRef& operator=(const RobotRef&) = delete;
  RobotRef(RobotRef&& other) noexcept;
  RobotRef& operator=(RobotRef&& other) noexcept;
  ~RobotRef();
  const Robot& operator*() const { return *robot_; }
  const Robot* operator->() const { return robot_; }

 private:
  int32_t index_ = -1;  // of an added one
  const Robot* robot_ = nullptr;
};

int32_t find_robot(const char* name);  // name or alias; Error(kNotFound) with the nearest

// A deep copy joins the list. Error(kArgument), Error(kRange) as check_robot, also for a name that is taken.
int32_t add_robot(const Robot& robot);
// Whoever holds a reference keeps it. Error(kArgument) for one of the library's own.
void remove_robot(int32_t index);

}  // namespace rdm

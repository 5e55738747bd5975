// Hand Over: the right hand throws an object over the gap to the left hand. Two tasks, Safe Finger and Safe
// Joint, that differ in the cost alone (tasks section 4).
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kHandOverSafeFinger, kHandOverSafeJoint;

}  // namespace rdm

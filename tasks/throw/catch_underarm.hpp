// Catch Over to Underarm: the right hand stands upright and throws an object down to the left hand, which
// lies palm up; both fly. Two tasks that differ in the cost alone (tasks section 5).
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kCatchUnderarmSafeFinger, kCatchUnderarmSafeJoint;

}  // namespace rdm

// Grasp: a hand over the ground, palm down, lifts a cube; its finger joints should not strain (tasks section
// 6).
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kGrasp;

}  // namespace rdm

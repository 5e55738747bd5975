// Hand Over Wall: the right hand throws an object through a hole in a wall to the left hand (tasks section
// 8).
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kHandOverWall;

}  // namespace rdm

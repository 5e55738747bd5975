// Pick Bottles: each hand lifts its bottle out of a row of five and leaves the others alone (tasks section
// 10).
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kPickBottles;

}  // namespace rdm

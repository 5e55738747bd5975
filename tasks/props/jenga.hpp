// Jenga: one hand pushes the target block out of a tower that must not move (tasks section 9).
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kJenga;

}  // namespace rdm

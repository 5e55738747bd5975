// Clean House: two hands sweep a bottle to a dustpan with a broom, past a chair (tasks sections 11, 13.4).
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kCleanHouse;

}  // namespace rdm

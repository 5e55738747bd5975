// For how many control steps one step of a pool holds its action: an option that every task has beside its
// own.
#pragma once
#include <cstdint>

#include "base/option_rows.hpp"
#include "env/task.hpp"

namespace rdm {

// The row, static.
const OptionSpec* repeat_options(int32_t* count);

// Control steps, from 1 up; option 0 is the rate at which the task's own learner decides.
int32_t repeat_from(const Options& options, const TaskInfo& task);

// That rate: the task's default of the agent's option action_repeat, 1 without one.
int32_t decision_steps(const TaskInfo& task);

}  // namespace rdm

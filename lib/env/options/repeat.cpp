#include "env/options/repeat.hpp"

#include <cstdlib>

namespace rdm {
namespace {

struct RepeatOptions {
  int32_t action_repeat;
};
constexpr auto kRepeatRows = row<&RepeatOptions::action_repeat>(integer_option(
    "action_repeat", 1, 0, 10000,
    "control steps per pool step, all with one action; 0: as many as the task recommends per decision"));

}  // namespace

const OptionSpec* repeat_options(int32_t* count) {
  *count = static_cast<int32_t>(kRepeatRows.size());
  return kRepeatRows.specs;
}

int32_t repeat_from(const Options& options, const TaskInfo& task) {
  const int32_t given = kRepeatRows.read(options).action_repeat;
  return given > 0 ? given : decision_steps(task);
}

int32_t decision_steps(const TaskInfo& task) {
  const char* const key = kRepeatRows.of<&RepeatOptions::action_repeat>().key;
  // A task's own default stands behind those of its family, and the later one wins.
  for (int32_t i = task.num_defaults - 1; i >= 0; --i)
    if (same_name(task.defaults[i].key, key)) return std::atoi(task.defaults[i].value);
  return 1;
}

}  // namespace rdm

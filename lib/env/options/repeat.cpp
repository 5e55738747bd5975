#include "env/options/repeat.hpp"

#include <cstdlib>
#include <iterator>

namespace rdm {
namespace {

constexpr const char* kKey = "action_repeat";
constexpr OptionSpec kRepeatRows[] = {
    integer_option(kKey, 1, 0, 10000,
                   "control steps of one step of the pool, with one action; 0: the task's own decision rate"),
};

}  // namespace

const OptionSpec* repeat_options(int32_t* count) {
  *count = static_cast<int32_t>(std::size(kRepeatRows));
  return kRepeatRows;
}

int32_t repeat_from(const Options& options, const TaskInfo& task) {
  const int32_t given = options.integer(kKey);
  return given > 0 ? given : decision_steps(task);
}

int32_t decision_steps(const TaskInfo& task) {
  // A task's own default stands behind those of its family, and the later one wins.
  for (int32_t i = task.num_defaults - 1; i >= 0; --i)
    if (same_name(task.defaults[i].key, kKey)) return std::atoi(task.defaults[i].value);
  return 1;
}

}  // namespace rdm

#include "tasks/catalog.hpp"

#include "env/task.hpp"
#include "tasks/hand_over.hpp"

namespace rdm {

void register_builtin_tasks() {
  // a static's initialisation runs once, whichever thread comes first
  static const bool done = [] {
    for (const TaskInfo* info : {&kHandOverSafeFinger, &kHandOverSafeJoint}) register_task(*info);
    return true;
  }();
  static_cast<void>(done);
}

}  // namespace rdm

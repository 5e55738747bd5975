#include "tasks/catalog.hpp"

#include "env/task.hpp"
#include "tasks/hand/grasp.hpp"
#include "tasks/hand/reorient.hpp"
#include "tasks/props/clean_house.hpp"
#include "tasks/props/jenga.hpp"
#include "tasks/props/pick_bottles.hpp"
#include "tasks/small_worlds.hpp"
#include "tasks/throw/catch_underarm.hpp"
#include "tasks/throw/hand_over.hpp"
#include "tasks/throw/hand_over_wall.hpp"

namespace rdm {

void register_builtin_tasks() {
  // a static's initialisation runs once, whichever thread comes first
  static const bool done = [] {
    for (const TaskInfo* info :
         {&kHandOverSafeFinger, &kHandOverSafeJoint, &kCatchUnderarmSafeFinger, &kCatchUnderarmSafeJoint})
      register_task(*info);
    for (const TaskInfo* info : {&kGrasp, &kReorient, &kHandOverWall}) register_task(*info);
    for (const TaskInfo* info : {&kJenga, &kPickBottles, &kCleanHouse}) register_task(*info);
    for (const TaskInfo* info :
         {&kBandit, &kTwoState, &kLqrLine, &kBallRun, &kBallCircle, &kCarRun, &kSwimmerVelocity, &kPointGoal1,
          &kPointGoal2, &kPointButton1, &kPointButton2})
      register_task(*info);
    return true;
  }();
  static_cast<void>(done);
}

}  // namespace rdm

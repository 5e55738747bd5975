#include "tasks/catalog.hpp"

namespace rdm {
namespace {

// In the order of discovery.
constexpr const TaskInfo* kTasks[] = {
    &kHandOverSafeFinger,
    &kHandOverSafeJoint,
    &kCatchUnderarmSafeFinger,
    &kCatchUnderarmSafeJoint,
    &kGrasp,
    &kReorient,
    &kHandOverWall,
    &kJenga,
    &kPickBottles,
    &kCleanHouse,
    &kBandit,
    &kTwoState,
    &kLqrLine,
    &kBallRun,
    &kBallCircle,
    &kCarRun,
    &kSwimmerVelocity,
    &kPointGoal1,
    &kPointGoal2,
    &kPointButton1,
    &kPointButton2,
    &kCarGoal1,
    &kCarGoal2,
    &kCarButton1,
    &kCarButton2,
    &kCarCircle,
    &kDroneRun,
    &kDroneCircle,
    &kBallGather,
    &kCarGather,
    &kDroneGather,
    &kBallReach,
    &kCarReach,
    &kDroneReach,
    &kHopperVelocity,
    &kWalker2dVelocity,
    &kAntVelocity,
    &kAntRun,
    &kAntCircle,
    &kAntGather,
    &kAntReach,
    &kMatrixGame,
    &kRecall,
};

}  // namespace

void register_builtin_tasks() {
  // a static's initialisation runs once, whichever thread comes first
  static const bool done = [] {
    for (const TaskInfo* info : kTasks) register_task(*info);
    return true;
  }();
  static_cast<void>(done);
}

}  // namespace rdm

// All tasks that the library knows. A task of its own: its file, a line here, a row in catalog.cpp.
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kHandOverSafeFinger;
extern const TaskInfo kHandOverSafeJoint;
extern const TaskInfo kCatchUnderarmSafeFinger;
extern const TaskInfo kCatchUnderarmSafeJoint;
extern const TaskInfo kGrasp;
extern const TaskInfo kReorient;
extern const TaskInfo kHandOverWall;
extern const TaskInfo kJenga;
extern const TaskInfo kPickBottles;
extern const TaskInfo kCleanHouse;
extern const TaskInfo kBandit;
extern const TaskInfo kTwoState;
extern const TaskInfo kMatrixGame;
extern const TaskInfo kLqrLine;
extern const TaskInfo kBallRun;
extern const TaskInfo kBallCircle;
extern const TaskInfo kCarRun;
extern const TaskInfo kSwimmerVelocity;
extern const TaskInfo kPointGoal1;
extern const TaskInfo kPointGoal2;
extern const TaskInfo kPointButton1;
extern const TaskInfo kPointButton2;
extern const TaskInfo kCarGoal1;
extern const TaskInfo kCarGoal2;
extern const TaskInfo kCarButton1;
extern const TaskInfo kCarButton2;
extern const TaskInfo kCarCircle;
extern const TaskInfo kDroneRun;
extern const TaskInfo kDroneCircle;
extern const TaskInfo kBallGather;
extern const TaskInfo kCarGather;
extern const TaskInfo kDroneGather;
extern const TaskInfo kBallReach;
extern const TaskInfo kCarReach;
extern const TaskInfo kDroneReach;
extern const TaskInfo kHopperVelocity;
extern const TaskInfo kWalker2dVelocity;
extern const TaskInfo kAntVelocity;
extern const TaskInfo kAntRun;
extern const TaskInfo kAntCircle;
extern const TaskInfo kAntGather;
extern const TaskInfo kAntReach;
extern const TaskInfo kRecall;

// Puts them into the registry. Once per process, from any thread; further calls do nothing.
void register_builtin_tasks();

}  // namespace rdm

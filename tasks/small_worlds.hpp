// Tasks with known answers: closed forms, or dynamics that published figures can be held against. They need
// no physics engine; each computes its own motion.
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kBandit, kTwoState, kLqrLine;
extern const TaskInfo kBallRun, kBallCircle, kCarRun, kSwimmerVelocity;
extern const TaskInfo kPointGoal1, kPointGoal2, kPointButton1, kPointButton2;

}  // namespace rdm

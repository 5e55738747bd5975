// Reorientation: an egg in a palm is turned to a drawn rotation, then the next; fingertips should not press
// (tasks section 7).
#pragma once
#include "env/task.hpp"

namespace rdm {

extern const TaskInfo kReorient;

// 1 / (theta + 0.1) less the price of the action's squares, with the bonus at the goal. theta in rad.
double reorient_reward(double theta, double squares, double price, double bonus, double tolerance);

}  // namespace rdm

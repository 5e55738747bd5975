// The reward of Reorientation.
#pragma once

namespace rdm {

// 1 / (theta + 0.1) less the price of the action's squares, with the bonus at the goal. theta in rad.
double reorient_reward(double theta, double squares, double price, double bonus, double tolerance);

}  // namespace rdm

// The double pendulum of the convergence rows, with other settings.
#pragma once
#include <string>

namespace truth {

double pendulum_error(const std::string& settings);  // rad, the larger of both joints after 1 s

}  // namespace truth

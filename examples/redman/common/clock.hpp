// Seconds by the wall clock.
#pragma once
#include <chrono>

namespace tool {

using Clock = std::chrono::steady_clock;
inline double since(Clock::time_point t) {
  return std::chrono::duration<double>(Clock::now() - t).count();
}

}  // namespace tool

// The progress line of a training run on stderr: redrawn in place on a terminal, else a plain line now and
// then.
#pragma once
#include <redman/redman.h>

#include <chrono>
#include <string>

namespace tool {

class Meter {
 public:
  Meter(int64_t done, int64_t goal);
  ~Meter();
  Meter(const Meter&) = delete;
  Meter& operator=(const Meter&) = delete;

  // After each epoch.
  void show(const rdm_epoch& e);
  // A line of its own, between progress lines.
  void say(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  void wipe();
  int64_t first_, goal_;
  bool terminal_, drawn_ = false;
  Clock::time_point begin_, shown_;
};

}  // namespace tool

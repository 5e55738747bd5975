#include "run/meter.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "common/text.hpp"

namespace tool {

Meter::Meter(int64_t done, int64_t goal)
    : first_(done),
      goal_(goal),
      terminal_(isatty(STDERR_FILENO) != 0),
      begin_(Clock::now()),
      shown_(begin_) {}

Meter::~Meter() {
  wipe();
}

void Meter::wipe() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

void Meter::show(const rdm_epoch& e) {
  using Seconds = std::chrono::duration<double>;
  const auto now = Clock::now();
  const bool last = e.env_steps >= goal_;
  if (!last && Seconds(now - shown_).count() < (terminal_ ? 0.2 : 10)) return;
  shown_ = now;
  const double rate =
      static_cast<double>(e.env_steps - first_) / std::max(Seconds(now - begin_).count(), 1e-9);
  const double left = std::min(static_cast<double>(std::max<int64_t>(goal_ - e.env_steps, 0)) / rate, 1e9);
  const auto seconds_left = static_cast<int>(left);
  const std::string ended = e.flags & RDM_EPOCH_NO_EPISODE
                                ? format("no episode has ended  cost per step %.3g", e.cost_per_step)
                                : format("return %.2f  cost %.2f  length %.0f  falls %.0f%%", e.ret,
                                         e.cost[0], e.length, 100 * e.fall_rate);
  const std::string shield =
      e.refused < 0 ? ""
                    : format("  violations %lld  refused %lld", static_cast<long long>(e.violations),
                             static_cast<long long>(e.refused));
  const std::string line =
      format("%3.0f%%  %s steps  %s%s  multiplier %.3g  %s steps/s  %d:%02d left",
             std::min(100.0, 100 * static_cast<double>(e.env_steps) / static_cast<double>(goal_)),
             short_count(static_cast<double>(e.env_steps)).c_str(), ended.c_str(), shield.c_str(),
             e.multiplier[0], short_count(rate).c_str(), seconds_left / 60, seconds_left % 60);
  wipe();
  std::fputs(line.c_str(), stderr);
  if (terminal_)
    drawn_ = true;
  else
    std::fputc('\n', stderr);
  std::fflush(stderr);
}

void Meter::say(const std::string& line) {
  wipe();
  std::fprintf(stderr, "%s\n", printable(line).c_str());
}

}  // namespace tool

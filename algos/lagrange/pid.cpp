#include "algos/lagrange/pid.hpp"

#include <algorithm>

#include "algos/core/option_tables.hpp"

namespace rdm {

void Pid::reset(const PidOptions& options) {
  *this = Pid();
  integral_ = std::min(options.init, options.max);
}

void Pid::step(const PidOptions& o, double cost, double limit) {
  const double e = cost - limit;
  integral_ = std::clamp(integral_ + o.ki * e, 0.0, o.max);
  p_ = o.smooth_p * p_ + (1 - o.smooth_p) * e;
  cost_ = o.smooth_d * cost_ + (1 - o.smooth_d) * cost;
  double& oldest = past_[steps_];
  const double rise = std::max(0.0, cost_ - oldest);
  oldest = cost_;
  steps_ = (steps_ + 1) % o.delay;
  value_ = std::clamp(o.kp * p_ + integral_ + o.kd * rise, 0.0, o.max);
}

void Pid::visit(StateIo& io, const PidOptions& o) {
  constexpr double kBound = 1e100;  // no gain times this, and no sum of the three, overflows
  io.number(integral_, 0, kBound);
  io.number(p_, -kBound, kBound);
  io.number(cost_, -kBound, kBound);
  io.number(value_, 0, kMaxMultiplier);
  io.numbers(past_, kMaxPidDelay, -kBound, kBound);
  io.integer(steps_, 0, o.delay - 1);
}

}  // namespace rdm

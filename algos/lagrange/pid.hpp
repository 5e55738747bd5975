// A PID controller of one cost multiplier (Stooke, Achiam and Abbeel 2020, "Responsive safety in
// reinforcement learning by PID Lagrangian methods", algorithm 2), one step per epoch.
//
// Dual ascent is the integral term alone: a multiplier lags a quarter turn behind the cost and both swing.
// The proportional term answers a violation at once, the derivative damps its rise.
//
// Departures, the authors' code among them: the proportional term and the cost that is derived are smoothed
// (pid_smooth_p, pid_smooth_d), the derivative looks pid_delay epochs back, gains are per unit of cost, not
// of a cost over its limit: with an episode's cost of tens the defaults of throws have 0.075 of the table's
// kp and ki.
#pragma once
#include <cstdint>

#include "algos/core/state_io.hpp"

namespace rdm {

inline constexpr int32_t kMaxPidDelay = 64;

struct PidOptions {
  double kp = 0.1, ki = 0.01, kd = 0.01;
  double smooth_p = 0.95, smooth_d = 0.95;  // EMA factors; 0: none
  int32_t delay = 10;                       // epochs that the derivative looks back
  double init = 0.001;                      // of the integral
  double max = 1e300;                       // of the integral, and of the multiplier
};

// With e = J_c - limit: integral I = clip(I + ki e, 0, max), P an EMA of e, C an EMA of J_c from 0,
// D = max(0, C - C of `delay` steps ago (0 before)); multiplier = clip(kp P + I + kd D, 0, max). So only a
// rising cost is derived, and the integral winds up neither below 0 nor beyond what the multiplier can be.
class Pid {
 public:
  void reset(const PidOptions& options);
  void step(const PidOptions& options, double cost, double limit);
  double value() const { return value_; }
  void visit(StateIo& io, const PidOptions& options);

 private:
  double integral_ = 0, p_ = 0, cost_ = 0, value_ = 0;
  double past_[kMaxPidDelay] = {};  // ring of C
  int32_t steps_ = 0;               // mod delay
};

}  // namespace rdm

// The rule of CPPO-PID: one PID controller for each cost limit.
#pragma once
#include "algos/core/option_tables.hpp"
#include "algos/lagrange/pid.hpp"
#include "algos/rollout/limits.hpp"
#include "algos/rollout/rollout.hpp"

namespace rdm {

struct PidRuleOptions : PidOptions {
  Mix mix = Mix::kSum;
};
inline constexpr auto kPidRows = option_rows<PidRuleOptions>(
    row<&PidOptions::kp>(basic(number_option(
        "pid_kp", 0.1, 0, 1e6, "proportional gain: multiplier per unit of the smoothed violation", true))),
    row<&PidOptions::ki>(basic(number_option(
        "pid_ki", 0.01, 0, 1e6, "integral gain: multiplier per unit of the summed violation", true))),
    row<&PidOptions::kd>(basic(number_option(
        "pid_kd", 0.01, 0, 1e6,
        "derivative gain: multiplier per unit that the smoothed cost rises over pid_delay epochs", true))),
    row<&PidOptions::smooth_p>(
        number_option("pid_smooth_p", 0.95, 0, 0.9999,
                      "smoothing factor of the violation (exponential mean); 0: no smoothing")),
    row<&PidOptions::smooth_d>(
        number_option("pid_smooth_d", 0.95, 0, 0.9999,
                      "smoothing factor of the cost in the derivative (exponential mean); 0: no smoothing")),
    row<&PidOptions::delay>(integer_option("pid_delay", 10, 1, kMaxPidDelay,
                                           "number of epochs over which the derivative is taken")),
    row<&PidOptions::init>(number_option("pid_init", 0.001, 0, 1e6, "initial value of the integral")),
    row<&PidOptions::max>(number_option("pid_max", 1e6, 0, kMaxMultiplier,
                                        "upper bound of the multiplier and of its integral", true)),
    row<&PidRuleOptions::mix, Mix::kSum, Mix::kDifference, Mix::kPlain>(text_option(
        "pid_norm", "sum", "sum|diff|none",
        "advantage: sum: (A_r - l A_c)/(1 + l); diff: (1 - l) A_r - l A_c with l <= 1; none: A_r - l A_c")));

class PidRule {
 public:
  explicit PidRule(const ResolvedAgentConfig& resolved);
  // Each by its fresh cost; not without one.
  void step(const JudgedCosts& costs, int32_t epoch);
  double weight(int32_t i) const { return pid_[i].value(); }
  Mix mix() const { return options_.mix; }
  bool split() const { return false; }
  void read_live(const Options& options);
  void visit(StateIo& io);

 private:
  PidRuleOptions options_;
  Pid pid_[kMaxCosts];
  int32_t count_ = 0;
};

}  // namespace rdm

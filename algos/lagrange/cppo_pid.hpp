// The rule of CPPO-PID: one PID controller for each cost limit.
#pragma once
#include "algos/lagrange/pid.hpp"
#include "algos/rollout/limits.hpp"
#include "algos/rollout/rollout.hpp"

namespace rdm {

struct PidRuleOptions : PidOptions {
  Mix mix = Mix::kSum;
};

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

// IPO (Liu, Ding and Liu 2020, "IPO: interior-point policy optimization under constraints"): a logarithmic
// barrier before each cost limit.
//
//   max  L_clip(theta) + sum_k kappa ln(limit_k - J_ck(theta)),   kappa = 1 / t of the paper
//
// whose gradient is L_clip's less sum_k slope_k grad J_ck, slope = kappa / (limit - J_c).
//
// By default this is not the paper's barrier (option barrier=epoch, as a peer has it): the slope is that at
// the epoch's J_c for the whole epoch, at most barrier_max = 1 and that much beyond the limit, where the
// logarithm does not exist, and weighs the combined advantage (A_r - sum slope A_c) / (1 + sum slope). With
// kappa = 0.01 and a limit of 40 the slope is 0.001 at a cost of 30, 0.01 at 39 and 1 above 40: a switch at
// the limit. The figures of examples/results are of this default. barrier=exact is the paper's: its slope is
// at the J_c that each minibatch estimates for the policy as it is then, the reward is clipped and the cost
// is not.
#pragma once
#include "algos/penalty/p3o.hpp"

namespace rdm {

// kappa / (limit - cost + 1e-8), and `max` where that is larger or the limit is exceeded.
double barrier_slope(double cost, double limit, double kappa, double max);

// -min(rho gain, clip(rho) gain) - kappa sum_k ln(-violation_k - L_ck), L_c the mean of rho A_c over the
// batch: its gradient is the penalised surrogate's with the slopes of the logarithms at that batch as
// weights. Like barrier_slope a slope is `max` where the logarithm is steeper or does not exist. violation:
// J_c - limit, in the units of L_c.
class BarrierLoss final : public PenalizedSurrogate {
 public:
  BarrierLoss() { clip_cost = false; }
  void aim(const Surrogate& now, const double* violation, int32_t count);
  double kappa = 0.01, max = 1;
};

struct BarrierOptions {
  bool exact;
  double kappa, max;
};

class BarrierRule {
 public:
  explicit BarrierRule(const ResolvedAgentConfig& resolved) : count_(resolved.num_limited) {
    read_live(resolved.options);
  }
  void step(const JudgedCosts& costs, int32_t epoch);
  double weight(int32_t i) const { return slope_[i]; }
  Mix mix() const { return Mix::kSum; }
  bool split() const { return split_; }
  void read_live(const Options& options);
  void visit(StateIo& io);

 private:
  double slope_[kMaxCosts] = {};
  BarrierOptions barrier_{};
  int32_t count_ = 0;
  bool split_ = false;
};

}  // namespace rdm

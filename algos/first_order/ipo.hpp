// IPO (Liu et al. 2020): a logarithmic barrier before each cost limit, its slope fixed for an epoch (the
// rule) or exact at every step (the loss).
#pragma once
#include "algos/first_order/p3o.hpp"

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

class BarrierRule {
 public:
  explicit BarrierRule(const ResolvedAgentConfig& resolved) : count_(resolved.num_limited) {
    read_live(resolved.options);
  }
  void step(const EpisodeStats& stats, const ResolvedAgentConfig& resolved, int32_t epoch);
  double weight(int32_t i) const { return slope_[i]; }
  Mix mix() const { return Mix::kSum; }
  bool split() const { return split_; }
  void read_live(const Options& options);
  void visit(StateIo& io);

 private:
  double slope_[kMaxCosts] = {};
  double kappa_ = 0.01, max_ = 1;
  int32_t count_ = 0;
  bool split_ = false;
};

}  // namespace rdm

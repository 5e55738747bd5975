// The rule of IPO (Liu et al. 2020): the slope of a logarithmic barrier before each cost limit.
#pragma once
#include "algos/episodes.hpp"
#include "algos/rollout.hpp"

namespace rdm {

// kappa / (limit - cost + 1e-8), and `max` where that is larger or the limit is exceeded.
double barrier_slope(double cost, double limit, double kappa, double max);

class BarrierRule {
 public:
  explicit BarrierRule(const Plan& plan) : count_(plan.num_limited) { read_live(plan.options); }
  void step(const EpisodeStats& stats, const Plan& plan, int32_t epoch);
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

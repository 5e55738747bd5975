// P3O (Zhang et al. 2022, "Penalized proximal policy optimization for safe reinforcement learning"): the
// clipped surrogate with an exact penalty on each cost limit,
//
//   min  L_r + kappa sum_k max(0, L_ck + violation_k)
//   L_r = -mean min(rho A_r, clip(rho) A_r),   L_c = mean max(rho A_c, clip(rho) A_c)
//
// Exact: with kappa above the multipliers of the constrained problem both have the same solution. So while a
// minibatch's L_ck + violation_k > 0 the gradient has kappa times the cost's, else nothing of it.
//
// Departures: kappa is fixed (penalty 20, 2 in the defaults of throws; penalty_growth and penalty_max: the
// paper's kappa <- min(growth kappa, max)), and violation = (J_c - limit) / decisions of an episode where the
// paper has (1 - discount)(J_c - limit) (violation_scale=discount); preset=paper sets both.
#pragma once
#include "algos/first_order/ppo.hpp"

namespace rdm {

// What one sample adds to the penalty of a cost: max(rho A_c, clip(rho) A_c), and its derivative by log p.
// Clipping can hide a fall of the cost, never a rise.
SampleLoss penalty_loss(float ratio, float cost, float clip);

// -min(rho gain, clip(rho) gain) + sum_k weight_k max(rho A_ck, clip(rho) A_ck), or without clip_cost
// weight_k rho A_ck.
class PenalizedSurrogate : public RatioLoss {
 public:
  float clip = 0.2f;
  bool clip_cost = true;
  float weight[kMaxCosts] = {};  // kappa where the penalty is on, else 0
  bool clips() const override { return true; }

 protected:
  SampleLoss sample(const Rollout& r, size_t at, float ratio) const override;
};

struct PenaltyOptions {
  double init, growth, max;  // of kappa
  bool clip;
};

class P3o final : public Ppo {
 public:
  explicit P3o(ResolvedAgentConfig&& resolved) : Ppo(std::move(resolved)) {}

 protected:
  const PolicyLoss* policy_loss() const override { return &loss_; }
  void begin_epoch(const JudgedCosts& costs, int32_t epoch) override;
  // The penalty is on where the minibatch's estimate of the constraint is above 0.
  Job measure_minibatch(const Batch& batch) override;
  void begin_minibatch(const Surrogate& now) override;
  double cost_weight(int32_t) const override { return kappa_; }
  void opened() override;
  void read_live() override;
  void visit_state(StateIo& io) override;

 private:
  PenalizedSurrogate loss_;
  PenaltyOptions penalty_{};
  double kappa_ = 0;
  double violation_[kMaxCosts] = {};
};

}  // namespace rdm

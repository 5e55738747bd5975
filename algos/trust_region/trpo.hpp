// TRPO (Schulman et al. 2015): one natural-gradient step of the actor in a trust region, then the critics.
//
//   y = sqrt(2 delta / x'H x) x, x = H^-1 G;   y is shortened until KL <= delta and the gain >= 0
#pragma once
#include "algos/agent/agent.hpp"
#include "algos/first_order/ratio_loss.hpp"
#include "algos/trust_region/trust_region.hpp"

namespace rdm {

class Trpo : public Agent {
 public:
  explicit Trpo(ResolvedAgentConfig&& resolved) : Agent(std::move(resolved)) {}
  void carve(Arena& arena) override;

 protected:
  void opened() override;
  void read_live() override;
  void learn() override;
  const PolicyLoss& policy_loss() const override { return loss_; }
  // The step of the actor over the listed rows; returns the fraction of it that the line search took.
  virtual double step_policy(const Batch& batch);
  // A limited cost is linearised beside the reward.
  virtual bool constrained() const { return false; }
  TrustRegion& region() { return region_; }

 private:
  GainLoss loss_;
  TrustRegion region_;
};

}  // namespace rdm

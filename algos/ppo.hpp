// PPO (Schulman et al. 2017): the clipped surrogate.
#pragma once
#include "algos/policy_gradient.hpp"

namespace rdm {

// Loss of one sample with ratio rho and its derivative by log p:
// -min(rho gain, clip(rho, 1 - clip, 1 + clip) gain) - rho linear.
struct ClippedLoss {
  float loss = 0, slope = 0;
  bool clipped = false;
};
ClippedLoss clipped_loss(float ratio, float gain, float linear, float clip);

class Ppo : public PolicyGradient {
 public:
  explicit Ppo(Plan&& plan) : PolicyGradient(std::move(plan)) {}

 protected:
  void policy_loss(const PolicyPiece& piece) const override;
  void read_live() override;

 private:
  float clip_ = 0.2f;
};

}  // namespace rdm

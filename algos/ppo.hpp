// PPO (Schulman et al. 2017): the clipped surrogate.
#pragma once
#include "algos/policy_gradient.hpp"

namespace rdm {

// Loss of one sample with ratio rho and its derivative by log p:
// -min(rho gain, clip(rho, 1 - clip, 1 + clip) gain) - rho linear. Ties have the unclipped derivative.
struct SampleLoss {
  float loss = 0, slope = 0;
  bool clipped = false;
};
SampleLoss clipped_loss(float ratio, float gain, float linear, float clip);

class ClippedSurrogate final : public PolicyLoss {
 public:
  void add(const PolicyPiece& piece) const override;
  float clip = 0.2f;
};

class Ppo : public PolicyGradient {
 public:
  explicit Ppo(Plan&& plan) : PolicyGradient(std::move(plan)) {}

 protected:
  const PolicyLoss& policy_loss() const override { return loss_; }
  void read_live() override {
    PolicyGradient::read_live();
    loss_.clip = static_cast<float>(options().number("clip"));
  }

 private:
  ClippedSurrogate loss_;
};

}  // namespace rdm

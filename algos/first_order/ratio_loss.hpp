// Losses that see a sample through its probability ratio rho = p(a) / p_old(a) alone.
#pragma once
#include "algos/agent/learner.hpp"

namespace rdm {

// Of one sample: its loss and the derivative by log p.
struct SampleLoss {
  float loss = 0, slope = 0;
  bool clipped = false;
};

class RatioLoss : public PolicyLoss {
 public:
  void add(const PolicyChunk& chunk) const final;

 protected:
  // Of row `at` of what the actor climbs (Rollout::valued).
  virtual SampleLoss sample(const Rollout& r, size_t at, float ratio) const = 0;
  ~RatioLoss() = default;
};

// -rho (gain + linear): what a trust region climbs.
class GainLoss final : public RatioLoss {
 protected:
  SampleLoss sample(const Rollout& r, size_t at, float ratio) const override;
};

// rho A_c of limited cost `column`.
class CostLoss final : public RatioLoss {
 public:
  explicit CostLoss(int32_t column) : column_(static_cast<size_t>(column)) {}
  bool explores() const override { return false; }

 protected:
  SampleLoss sample(const Rollout& r, size_t at, float ratio) const override;

 private:
  size_t column_;
};

}  // namespace rdm

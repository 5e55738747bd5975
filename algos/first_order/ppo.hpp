// PPO (Schulman et al. 2017, eq. 7): the clipped surrogate, several passes over shuffled minibatches.
//
//   max over theta of the mean of min(rho A, clip(rho, 1 - eps, 1 + eps) A)
//
// Around it, none of it in the paper's equation: advantages standardised over the batch, Adam behind a bound
// on the gradient's norm, a rate that may follow the KL (lr_schedule=kl), passes that may stop early by it.
#pragma once
#include "algos/agent/agent.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/first_order/ratio_loss.hpp"

namespace rdm {

// -min(rho gain, clip(rho, 1 - clip, 1 + clip) gain) - rho linear. Ties have the unclipped derivative.
SampleLoss clipped_loss(float ratio, float gain, float linear, float clip);

class ClippedSurrogate final : public RatioLoss {
 public:
  float clip = 0.2f;
  bool clips() const override { return true; }

 protected:
  SampleLoss sample(const Rollout& r, size_t at, float ratio) const override {
    return clipped_loss(ratio, r.gain[at], r.linear[at], clip);
  }
};

struct ClipOptions {
  double clip;
};
inline constexpr auto kClipRows = option_rows<ClipOptions>(row<&ClipOptions::clip>(basic(number_option(
    "clip", 0.2, 1e-6, 10, "bound of the change of the probability ratio in an update", true))));
// Of PPO, and what tables of algorithms on its step begin with.
struct PpoOptions : SharedOptions, ClipOptions {};
inline constexpr auto kPpoRows = option_rows<PpoOptions>(kSharedRows, kClipRows);

class Ppo : public Agent {
 public:
  explicit Ppo(ResolvedAgentConfig&& resolved) : Agent(std::move(resolved)) {}

 protected:
  const PolicyLoss* policy_loss() const override { return &loss_; }
  void read_live() override {
    Agent::read_live();
    loss_.clip = static_cast<float>(kClipRows.read(options()).clip);
  }
  float clip() const { return loss_.clip; }

 private:
  ClippedSurrogate loss_;
};

}  // namespace rdm

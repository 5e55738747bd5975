// TRPO (Schulman et al. 2015): one natural-gradient step of the actor in a trust region, then the critics.
//
//   y = sqrt(2 delta / x'H x) x, x = H^-1 G;   y is shortened until KL <= delta and the gain >= 0
#pragma once
#include "algos/agent/agent.hpp"
#include "algos/trust_region/trust_region.hpp"

namespace rdm {

// Of TRPO, and what tables of algorithms on its step begin with.
struct TrpoOptions : SharedOptions, TrustOptions {};
inline constexpr auto kTrpoRows =
    option_rows<TrpoOptions>(kSharedRows, kTrustRows).with<&SharedOptions::critic_learning_rate>(1e-3);

class Trpo : public Agent {
 public:
  explicit Trpo(ResolvedAgentConfig&& resolved) : Agent(std::move(resolved)) {}
  void carve(Arena& arena) override;

 protected:
  void opened() override;
  void read_live() override;
  const PolicyLoss* policy_loss() const override { return nullptr; }
  void begin_step() override;
  Job step_on() override;
  void report(Learned& out) const override;
  // A limited cost is linearised beside the reward.
  virtual bool constrained() const { return false; }
  // The one, -1: none in this epoch.
  virtual int32_t followed_cost() const { return -1; }
  // The region is linearised: how far along each of its vectors.
  virtual void aim();
  virtual bool accept(const Surrogate& before, const Surrogate& after) const;
  TrustRegion& region() { return region_; }

 private:
  TrustRegion region_;
  bool searching_ = false;
};

}  // namespace rdm

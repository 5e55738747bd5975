// FOCOPS (Zhang, Vuong and Ross 2020): first-order projection of the optimal nonparametric policy.
//
// Within a trust region the best policy under a cost limit has the closed form
//   pi*(a|s) ~ pi_old(a|s) exp((A_r - nu A_c) / lambda)
// and the parameters follow the gradient of KL(pi || pi*), for one sample
//   grad KL(pi || pi_old) - (1 / lambda) grad rho (A_r - nu A_c),   where KL(pi || pi_old) <= eta, else 0;
// nu climbs by nu <- clip(nu + rate (J_c - limit), 0, nu_max); lambda and eta are fixed (temperature,
// focops_eta).
//
// Departures: the cost advantage is centred, not standardised, as the authors' code has both
// (scale_cost_adv=std: that); multiplier_divide divides by 1 + nu, as a peer does; of several limited costs
// the most violated one alone weighs in an epoch, with a nu of its own. At a limit of 0 nu_max is at most the
// paper's 2, unless the host gives another.
#pragma once
#include "algos/agent/agent.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/lagrange/lagrange.hpp"

namespace rdm {

// Of one sample: [KL(new || old) - rho gain / temperature], nothing where that KL is above eta.
class FocopsLoss final : public PolicyLoss {
 public:
  void add(const PolicyChunk& chunk) const override;
  bool clips() const override { return true; }
  float temperature = 1.5f, eta = 0.02f;
};

struct FocopsOwnOptions {
  double temperature, eta;
  bool divide;
};

class FocopsBase : public Agent {
 public:
  explicit FocopsBase(ResolvedAgentConfig&& resolved) : Agent(std::move(resolved)) {}

 protected:
  const PolicyLoss* policy_loss() const override { return &loss_; }
  void read_live() override;

 private:
  FocopsLoss loss_;
};

// One multiplier for each cost; of several, only the most violated one weighs in an epoch.
class FocopsRule {
 public:
  explicit FocopsRule(const ResolvedAgentConfig& resolved);
  void step(const JudgedCosts& costs, int32_t epoch);
  double weight(int32_t i) const { return i == worst_ ? lagrange_.weight(i) : 0; }
  Mix mix() const { return mix_; }
  bool split() const { return false; }
  void read_live(const Options& options) { lagrange_.read_live(options); }
  void visit(StateIo& io);

 private:
  Lagrange lagrange_;
  int32_t count_ = 0, worst_ = 0;
  Mix mix_ = Mix::kPlain;
};

using Focops = CostWeighted<FocopsBase, FocopsRule>;

}  // namespace rdm

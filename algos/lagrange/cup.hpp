// CUP (Yang et al. 2022, "Constrained update projection approach to safe policy optimization", algorithm 1): an
// update in two steps, from theta_k over theta_half to theta_k+1.
//
//   improve   PPO's passes on the reward's advantage
//   project   min over theta of the mean of  KL(pi_half || pi) + f sum_k nu_k rho A_ck,   rho = pi / pi_k
//             nu_k <- clip(nu_k + multiplier_lr (J_ck - d_k), 0, multiplier_max)
//             f = (1 - discount lambda) / (1 - discount)
//
// The critics learn in the first passes alone; those of the second step (projection_passes) move the policy.
//
// Departures: f is at most 100 (option projection_factor: another one), as with a discount of 1 it has no value
// and only scales nu; the multiplier is moved by Adam as in the other methods here; cost advantages are centred,
// not scaled, as everywhere here (scale_cost_adv=std: as a peer does).
#pragma once
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/lagrange.hpp"

namespace rdm {

// Of one sample: KL(half || pi) + rho sum_k weight_k A_ck.
class ProjectionLoss final : public PolicyLoss {
 public:
  void add(const PolicyChunk& chunk) const override;
  bool explores() const override { return false; }

  float weight[kMaxCosts] = {};
  // The policy to stay near, of row `at` at mean + at * mean_step; log_std likewise, with a step of 0 one for all.
  const float *mean = nullptr, *log_std = nullptr;
  size_t mean_step = 0, std_step = 0;
};

struct ProjectionOptions {
  int32_t passes;
  double factor;
};

class Cup final : public Ppo {
 public:
  explicit Cup(ResolvedAgentConfig&& resolved) : Ppo(std::move(resolved)), lagrange_(this->resolved()) {}
  void carve(Arena& arena) override;

 protected:
  const PolicyLoss* policy_loss() const override { return projects_ ? &projection_ : Ppo::policy_loss(); }
  void begin_epoch(const JudgedCosts& costs, int32_t epoch) override;
  int32_t second_passes() const override;
  // Of every row: what the policy is now.
  Job begin_second() override;
  double cost_weight(int32_t i) const override { return lagrange_.weight(i); }
  void opened() override;
  void read_live() override;
  void visit_state(StateIo& io) override;

 private:
  Lagrange lagrange_;
  ProjectionLoss projection_;
  ProjectionOptions options_{};
  float* half_ = nullptr;      // [samples][outputs of the actor]
  float* half_std_ = nullptr;  // [action_dim] log deviation of the innovation; none with std_mode=state
  bool projects_ = false;
};

}  // namespace rdm

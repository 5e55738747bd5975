// SAC (Haarnoja et al. 2018, "Soft actor-critic algorithms and applications"): a random policy that is paid for its
// entropy, by a temperature alpha that keeps the entropy at a target.
//
//   policy    u = m(s) + std(s) z, a = tanh(u);  log pi(a|s) = log N(u; m, std) - sum_j log(1 - a_j^2)
//   targets   y = r + d (min Q'(s', a') - alpha log pi(a'|s')),  a' ~ pi(s'); of costs without the entropy
//   actor     alpha log pi(a|s) - min Q(s, a) + sum l_k max Q_k(s, a), over 1 + sum l_k, a from the same z
//   alpha     log alpha by Adam on  -log alpha (log pi(a|s) + H),  H = target_entropy for each entry of an action
//
// With limits: sac_lag by dual ascent, sac_pid by PID (off_policy.hpp, lagrange/).
#pragma once
#include "algos/off_policy/off_policy.hpp"

namespace rdm {

struct SacOwnOptions {
  double temperature, temperature_learning_rate, target_entropy;
};
inline constexpr auto kSacOwnRows = option_rows<SacOwnOptions>(
    row<&SacOwnOptions::temperature>(
        basic(number_option("temperature", 0.1, 0, 1e6, "initial weight of the entropy beside the reward"))),
    row<&SacOwnOptions::temperature_learning_rate>(
        number_option("temperature_learning_rate", 3e-4, 0, kMaxLearningRate,
                      "learning rate of the temperature's logarithm (Adam); 0: it stays", true)),
    row<&SacOwnOptions::target_entropy>(
        basic(number_option("target_entropy", -1, -100, 100,
                            "entropy that the temperature aims at, for each entry of an action", true))));

struct SacOptions : SharedOptions, OffPolicyOptions, SacOwnOptions {};
inline constexpr auto kSacSharedRows = kReplaySharedRows.with<&SharedOptions::std_min>(0.007)
                                           .with<&SharedOptions::std_max>(7.4)
                                           .with<&SharedOptions::init_std>(1.0);
inline constexpr auto kSacRows = option_rows<SacOptions>(
    kSacSharedRows, kOffPolicyRows.with<&OffPolicyOptions::policy_delay>(1), kSacOwnRows);

class Sac : public OffPolicy {
 public:
  explicit Sac(ResolvedAgentConfig&& resolved) : OffPolicy(std::move(resolved)) {}
  void carve(Arena& arena) override;
  static constexpr Squash kSquash = Squash::kSample;
  static SharedOptions shared(const Options& options);
  double temperature() const;

 protected:
  void opened() override;
  void read_live() override;
  void visit_state(StateIo& io) override;
  void next_actions(const float* seen, int32_t rows, float* action, float* bonus) override;
  void own_actions(const float* seen, int32_t rows, float* action) override;
  double learn_actions(const float* seen, int32_t rows, float* slope, float share, float* grad) override;
  bool climbs_smaller() const override { return true; }
  void end_actor_step() override;

 private:
  // Samples of the policy at seen; log_prob [rows].
  void sample(const float* seen, int32_t rows, float* action);

  SacOwnOptions own_;
  float *z_ = nullptr, *std_ = nullptr, *sampled_ = nullptr;  // [kRows][action_dim]
  float* log_prob_ = nullptr;                                 // [kRows]
  double log_alpha_ = 0, m_ = 0, v_ = 0;
  int64_t t_ = 0;
  double gap_ = 0;  // sum of log pi + H over the batch at hand
};

}  // namespace rdm

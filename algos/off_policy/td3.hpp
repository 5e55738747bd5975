// TD3 (Fujimoto, van Hoof and Meger 2018, "Addressing function approximation error in actor-critic methods"): a
// policy without randomness, a = tanh(pi(s)), that climbs its first critic.
//
//   acts     clip(a + explore_std z, +-1), z normal (with option noise_correlation from one decision to the next)
//   targets  a' = clip(pi'(s') + clip(target_std z, +-target_clip), +-1), pi' a slow copy of the policy; so a critic
//            cannot have a peak that the policy would climb
//   actor    -Q_1(s, pi(s)) + sum l_k max Q_k(s, pi(s)), every policy_delay-th step
//
// With limits: td3_lag by dual ascent, td3_pid by PID (off_policy.hpp, lagrange/).
#pragma once
#include "algos/off_policy/off_policy.hpp"

namespace rdm {

struct Td3OwnOptions {
  double explore_std, target_std, target_clip;
};
inline constexpr auto kTd3OwnRows = option_rows<Td3OwnOptions>(
    row<&Td3OwnOptions::explore_std>(basic(number_option(
        "explore_std", 0.2, 1e-6, 10,
        "standard deviation of the noise on actions while it collects, in units of the action"))),
    row<&Td3OwnOptions::target_std>(number_option(
        "target_std", 0.2, 0, 10, "standard deviation of the noise on the next action in targets", true)),
    row<&Td3OwnOptions::target_clip>(
        number_option("target_clip", 0.5, 0, 10, "bound on the noise on the next action in targets", true)));

struct Td3Options : SharedOptions, OffPolicyOptions, Td3OwnOptions {};
inline constexpr auto kTd3Rows = option_rows<Td3Options>(
    kReplaySharedRows.without<&SharedOptions::init_std, &SharedOptions::std_min, &SharedOptions::std_max>(),
    kOffPolicyRows, kTd3OwnRows);

class Td3 : public OffPolicy {
 public:
  explicit Td3(ResolvedAgentConfig&& resolved) : OffPolicy(std::move(resolved)) {}
  void carve(Arena& arena) override;
  static constexpr Squash kSquash = Squash::kMean;
  static SharedOptions shared(const Options& options);

 protected:
  void opened() override;
  void read_live() override;
  void visit_state(StateIo& io) override;
  void actor_replaced() override;
  void next_actions(const float* seen, int32_t rows, float* action, float* bonus) override;
  void own_actions(const float* seen, int32_t rows, float* action) override;
  double learn_actions(const float* seen, int32_t rows, float* slope, float share, float* grad) override;
  bool climbs_smaller() const override { return false; }
  void end_actor_step() override;

 private:
  Td3OwnOptions own_;
  float* slow_ = nullptr;  // the copy of the actor's network
};

}  // namespace rdm

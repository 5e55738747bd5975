// PDO, primal-dual optimisation (Chow, Ghavamzadeh, Janson and Pavone 2017, "Risk-constrained reinforcement
// learning with percentile risk criteria", algorithms 1 and 2, here for a limit on the mean): policy gradient
// up the Lagrangian, dual ascent of its multipliers, each at a rate of its own.
//
//   theta <- theta + rate grad J_r(theta) - sum_k l_k grad J_ck(theta)
//   l_k   <- clip(l_k + multiplier_lr (J_ck - d_k), 0, multiplier_max)
//
// The gradient is that of the mean of rho A, A = (A_r - sum l_k A_ck) / (1 + sum l_k), which at rho = 1 is the
// policy gradient.
//
// Departures: GAE in the place of whole returns, Adam, and several steps on the data of an epoch, which rho
// corrects for. As no clip holds them, passes end by default where the KL exceeds 0.02 (early_stop_kl). The
// paper limits the tail of the cost (CVaR) or the chance of a large one too; such limits are not here.
#include "algos/algo_registry.hpp"
#include "algos/first_order/ratio_loss.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/lagrange/lagrange.hpp"

namespace rdm {
namespace {

class PolicyGradient : public Agent {
 public:
  explicit PolicyGradient(ResolvedAgentConfig&& resolved) : Agent(std::move(resolved)) {}

 protected:
  const PolicyLoss* policy_loss() const override { return &loss_; }

 private:
  GainLoss loss_;
};

struct PdoOptions : SharedOptions, LagrangeOptions, WindowOptions {};
constexpr auto kPdoRows = option_rows<PdoOptions>(kSharedRows, kLagrangeRows, kWindowRows)
                              .with<&SharedOptions::early_stop_kl>(0.02);

}  // namespace

constinit const AlgoRow kPdo = make_algo_row<CostWeighted<PolicyGradient, Lagrange>>(
    "pdo", "Policy gradient with a Lagrange multiplier for each cost limit (Chow et al. 2017)", kPdoRows,
    Costs::kAny);

}  // namespace rdm

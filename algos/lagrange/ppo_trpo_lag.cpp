// PPO-Lag and TRPO-Lag (Ray, Achiam and Amodei 2019, "Benchmarking safe exploration in deep reinforcement
// learning", section 4): PPO's or TRPO's step on the advantage that Lagrange multipliers combine.
//
//   max over theta, min over l >= 0 of   J_r(theta) - sum_k l_k (J_ck(theta) - d_k)
//
// l by dual ascent once per epoch (multiplier.hpp), theta by the policy step on
//
//   A = (A_r - sum_k l_k A_ck) / (1 + sum_k l_k)
//
// whose division keeps a step's length as l grows. Departures:
// - PPO-Lag clips this one combined advantage: min(rho A, clip(rho) A). The authors' code clips the reward's
//   part alone and adds l rho A_c unclipped: cost_loss=split. Clipped, a step that has lowered the cost
//   enough is not drawn on by it; ReDMan's form, reward and cost clipped apart, is not here.
// - A_c is of costs discounted like rewards, while J_c and its limit are sums over an episode without
//   discount (option discounted_limit: with): with 0.96 per step the gradient sees costs some 25 steps ahead,
//   and l makes up for the scale, not for what is farther.
// - the authors learn l in softplus form (multiplier_optimizer=softplus); the default is Adam on l itself.
#include "algos/algo_registry.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/lagrange/lagrange.hpp"
#include "algos/trust_region/trpo.hpp"

namespace rdm {
namespace {
struct LagOptions : LagrangeOptions, WindowOptions, SplitOptions {};
constexpr auto kLagRows = option_rows<LagOptions>(kLagrangeRows, kWindowRows, kSplitRows);
struct PpoLagOptions : PpoOptions, LagOptions {};
constexpr auto kPpoLagRows = option_rows<PpoLagOptions>(kPpoRows, kLagRows);
struct TrpoLagOptions : TrpoOptions, LagOptions {};
constexpr auto kTrpoLagRows = option_rows<TrpoLagOptions>(kTrpoRows, kLagRows);
}  // namespace

constinit const AlgoRow kPpoLag = make_algo_row<CostWeighted<Ppo, Lagrange>>(
    "ppo_lag",
    "PPO on the reward's advantage minus each cost's times its Lagrange multiplier (Ray et al. 2019)",
    kPpoLagRows, Costs::kAny);
constinit const AlgoRow kTrpoLag = make_algo_row<CostWeighted<Trpo, Lagrange>>(
    "trpo_lag", "TRPO with a Lagrange multiplier for each cost limit (Ray et al. 2019)", kTrpoLagRows,
    Costs::kAny);

}  // namespace rdm

// MAPPO (Yu et al. 2022, "The surprising effectiveness of PPO in cooperative multi-agent games") and MAPPO-Lagrangian
// (Gu et al. 2023, "Safe multi-agent reinforcement learning for multi-robot control"): each group of a team
// (core/groups.hpp) has an actor of its own, which sees its own fields, and all share the critics, which see the whole row.
//
//   max over theta_g of the mean of min(rho_g A, clip(rho_g) A),  rho_g = pi_g(a_g | o_g) / pi_g,old(a_g | o_g)
//
// for all groups g at once, A the advantage of the team; under limits A = (A_r - sum_k l_k A_ck) / (1 + sum_k l_k), as
// in PPO-Lag. The joint policy is the product of the groups', so rho = prod rho_g; each is clipped by itself.
//
// Departures: one critic for the reward and one for the costs serve all groups, as all get the same reward; the
// multipliers move once an epoch by the mean cost of finished episodes, where the authors' code moves them in each
// minibatch by sums that have not ended. With one group both are PPO and PPO-Lag, to the byte.
#include "algos/algo_registry.hpp"
#include "algos/core/groups.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/lagrange/lagrange.hpp"

namespace rdm {
namespace {
struct MappoOptions : PpoOptions, GroupOptions {};
constexpr auto kMappoRows = option_rows<MappoOptions>(kPpoRows, kGroupRows);
struct MappoLagOptions : PpoOptions, LagrangeOptions, WindowOptions, SplitOptions, GroupOptions {};
constexpr auto kMappoLagRows =
    option_rows<MappoLagOptions>(kPpoRows, kLagrangeRows, kWindowRows, kSplitRows, kGroupRows);
}  // namespace

constinit const AlgoRow kMappo = make_algo_row<Ppo>(
    "mappo", "PPO of a team: an actor for each group of actions, critics in common (Yu et al. 2022)",
    kMappoRows, Costs::kNone, nullptr, &kPpo);
constinit const AlgoRow kMappoLag = make_algo_row<CostWeighted<Ppo, Lagrange>>(
    "mappo_lag", "MAPPO with a Lagrange multiplier for each cost limit (Gu et al. 2023)", kMappoLagRows,
    Costs::kAny, nullptr, &kPpoLag);

}  // namespace rdm

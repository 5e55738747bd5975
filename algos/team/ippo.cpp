// IPPO (de Witt et al. 2020, "Is independent learning all you need in the StarCraft multi-agent challenge?") and the
// same under cost limits: each group of a team (core/groups.hpp) has not only an actor of its own but critics of its
// own, which see the group's fields alone, of the reward and, under limits, of each limited cost.
//
//   max over theta_g of the mean of min(rho_g A_g, clip(rho_g) A_g),  A_g by GAE with V_g(o_g)
//
// for all groups at once; under limits A_g = (A_r,g - sum_k l_k A_ck,g) / (1 + sum_k l_k), with the multipliers of the
// team, for the limits are the team's. Nothing that a group learns from is another group's observation, so each could
// learn on a machine of its own, from the team's reward and costs.
//
// Departures: a bound on a gradient's norm is each network's own, as everywhere here; networks are not shared among
// groups, as theirs are. With one group they are PPO and PPO-Lag, to the byte.
#include "algos/algo_registry.hpp"
#include "algos/core/groups.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/lagrange/lagrange.hpp"

namespace rdm {
namespace {
struct IppoOptions : PpoOptions, GroupOptions {};
constexpr auto kIppoRows = option_rows<IppoOptions>(kPpoRows, kGroupRows);
struct IppoLagOptions : PpoOptions, LagrangeOptions, WindowOptions, SplitOptions, GroupOptions {};
constexpr auto kIppoLagRows =
    option_rows<IppoLagOptions>(kPpoRows, kLagrangeRows, kWindowRows, kSplitRows, kGroupRows);
}  // namespace

constinit const AlgoRow kIppo = make_algo_row<Ppo>(
    "ippo", "PPO of a team in which each group has critics of its own (de Witt et al. 2020)", kIppoRows,
    Costs::kNone, nullptr, &kPpo, true);
constinit const AlgoRow kIppoLag = make_algo_row<CostWeighted<Ppo, Lagrange>>(
    "ippo_lag", "IPPO with a Lagrange multiplier for each cost limit, and cost critics of each group's own",
    kIppoLagRows, Costs::kAny, nullptr, &kPpoLag, true);

}  // namespace rdm

// PPO-Lag (Ray et al. 2019): PPO on the advantage that Lagrange multipliers combine.
#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/lagrange/lagrange.hpp"

namespace rdm {
namespace {
constexpr auto kOptions = join_options(kSharedOptions, kClipOptions, kMultiplierOptions, kSplitOptions);
}
constinit const AlgoRow kPpoLag = make_algo_row<CostWeighted<Ppo, Lagrange>>(
    "ppo_lag", "PPO with a Lagrange multiplier for each cost limit (Ray et al. 2019)", kOptions, Costs::kAny);

}  // namespace rdm

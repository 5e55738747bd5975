// TRPO-Lag (Ray et al. 2019): TRPO on the advantage that Lagrange multipliers combine.
#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/lagrange/lagrange.hpp"
#include "algos/trust_region/trpo.hpp"

namespace rdm {
namespace {
constexpr auto kOptions = with_defaults(
    join_options(kSharedOptions, kTrustOptions, kMultiplierOptions, kSplitOptions), kTrustDefaults);
}
constinit const AlgoRow kTrpoLag = make_algo_row<CostWeighted<Trpo, Lagrange>>(
    "trpo_lag", "TRPO with a Lagrange multiplier for each cost limit (Ray et al. 2019)", kOptions,
    Costs::kAny);

}  // namespace rdm

// TRPO-Lag (Ray et al. 2019): TRPO on the advantage that Lagrange multipliers combine.
#include "algos/algo_registry.hpp"
#include "algos/lagrange.hpp"
#include "algos/option_tables.hpp"
#include "algos/trpo.hpp"
#include "algos/weighted.hpp"

namespace rdm {
namespace {
constexpr auto kOptions = with_defaults(
    join_options(kSharedOptions, kTrustOptions, kMultiplierOptions, kSplitOptions), kTrustDefaults);
}
constinit const AlgoRow kTrpoLag = make_algo_row<Weighted<Trpo, Lagrange>>(
    "trpo_lag", "TRPO with a Lagrange multiplier for each cost limit (Ray et al. 2019)", kOptions,
    Costs::kAny);

}  // namespace rdm

// PPO-Lag (Ray et al. 2019): PPO on the advantage that Lagrange multipliers combine.
#include "algos/algo_registry.hpp"
#include "algos/lagrange.hpp"
#include "algos/option_tables.hpp"
#include "algos/ppo.hpp"
#include "algos/weighted.hpp"

namespace rdm {
namespace {
constexpr auto kOptions = join_options(kSharedOptions, kClipOptions, kMultiplierOptions, kSplitOptions);
}
constinit const AlgoRow kPpoLag = make_algo_row<Weighted<Ppo, Lagrange>>(
    "ppo_lag", "PPO with a Lagrange multiplier for each cost limit (Ray et al. 2019)", kOptions, Costs::kAny);

}  // namespace rdm

#include "algos/ipo.hpp"

#include <cstring>

#include "algos/algo_registry.hpp"
#include "algos/option_tables.hpp"
#include "algos/ppo.hpp"
#include "algos/weighted.hpp"

namespace rdm {

double barrier_slope(double cost, double limit, double kappa, double max) {
  const double slope = kappa / (limit - cost + 1e-8);
  return slope < 0 || slope > max ? max : slope;
}

void BarrierRule::read_live(const Options& o) {
  kappa_ = o.number("barrier_kappa");
  max_ = o.number("barrier_max");
  split_ = std::strcmp(o.text("cost_loss"), "split") == 0;
}

void BarrierRule::step(const EpisodeStats& stats, const Plan& plan, int32_t) {
  if (stats.finished == 0) return;
  for (int32_t i = 0; i < count_; ++i)
    slope_[i] = barrier_slope(stats.charged_cost[plan.column[i]], plan.limit[i], kappa_, max_);
}

void BarrierRule::visit(StateIo& io) {
  io.section("BARR");
  io.numbers(slope_, static_cast<size_t>(count_), 0, 1e300);
}

namespace {
constexpr std::array kBarrierOptions = {
    number_option("barrier_kappa", 0.01, 0, 1e6, "weight of ln(limit - J_c): 1 / m of the paper", true),
    number_option("barrier_max", 1, 0, kHuge, "bound on the barrier's slope, and the slope beyond the limit",
                  true),
};
constexpr auto kOptions =
    join_options(kSharedOptions, kClipOptions, kBarrierOptions, kSplitOptions, kWindowOptions);
}  // namespace
constinit const AlgoRow kIpo = make_algo_row<Weighted<Ppo, BarrierRule>>(
    "ipo", "PPO with a logarithmic barrier before each cost limit (Liu et al. 2020)", kOptions, Costs::kAny);

}  // namespace rdm

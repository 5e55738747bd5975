#include "algos/trust_region/cpo.hpp"

#include "algos/algo_registry.hpp"
#include "algos/trust_region/cpo_problem.hpp"

namespace rdm {

void Cpo::begin_epoch(const JudgedCosts& costs, int32_t epoch) {
  Trpo::begin_epoch(costs, epoch);
  cost_ = 0;
  added_ = 0;
  free_ = true;
  for (int32_t i = 0; i < resolved().num_limited; ++i) {
    if (costs.spotless[i]) continue;
    const double c = violation(costs, i);
    if (free_ || c > c_) cost_ = i, c_ = c;
    free_ = false;
  }
}

bool Cpo::solve(double c) {
  const TrustRegion& t = region();
  const CpoStep y = solve_cpo({t.q(), t.r(), t.s(), c, t.delta()});
  nu_ = y.nu;
  region().set_step(y.along_x, y.along_p, 0);
  return y.which == CpoCase::kBoundary || y.which == CpoCase::kInside || y.which == CpoCase::kNoCost;
}

bool Cpo::accept(const Surrogate& before, const Surrogate& after) const {
  const auto k = static_cast<size_t>(cost_);
  return (free_ || after.cost[k] - before.cost[k] <= std::max(-(c_ + added_), 0.0)) &&
         (!keep_reward_ || after.gain >= before.gain);
}

void Cpo::visit_state(StateIo& io) {
  Trpo::visit_state(io);
  io.section("CPO ");
  io.number(nu_, 0, 1e300);
  io.integer(cost_, 0, resolved().num_limited - 1);
}

constinit const AlgoRow kCpo = make_algo_row<Cpo>(
    "cpo", "Constrained policy optimisation, its local problem solved exactly (Achiam et al. 2017)", kCpoRows,
    Costs::kOne);

}  // namespace rdm

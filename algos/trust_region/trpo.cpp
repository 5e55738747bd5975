#include "algos/trust_region/trpo.hpp"

#include <cmath>

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"

namespace rdm {

void Trpo::carve(Arena& arena) {
  Agent::carve(arena);
  region_.carve(arena, resolved(), nets(), constrained());
}

void Trpo::opened() {
  region_.open(cancel_flag(), resolved(), rollout(), nets(), workers(), learner());
}

void Trpo::read_live() {
  Agent::read_live();
  region_.read_live(options());
}

double Trpo::step_policy(const Batch& batch) {
  region_.linearize(batch, -1, schedule_share());
  if (region_.q() > 0)
    region_.set_step(std::sqrt(2 * region_.delta() / region_.q()), 0, 0);
  else
    region_.set_step(0, 0, 0);
  return region_.search(
      [](const Surrogate& before, const Surrogate& after) { return after.gain >= before.gain; });
}

void Trpo::learn() {
  if (valid_rows() == 0) return;
  step_policy(whole_batch());
  BatchSums sums;
  Learned& out = learned();
  for (; out.passes < options().integer("passes"); ++out.passes) sums += pass(nullptr);
  if (out.passes > 0) out.mean = sums.scaled(1.0 / (static_cast<double>(valid_rows()) * out.passes));
  out.mean.loss = -region_.reached().gain;
  out.mean.kl = out.last_kl = region_.reached().kl;
}

namespace {
constexpr auto kTrpoTable = with_defaults(join_options(kSharedOptions, kTrustOptions), kTrustDefaults);
}
constinit const AlgoRow kTrpo = make_algo_row<Trpo>(
    "trpo", "Trust region policy optimisation (Schulman et al. 2015); costs are recorded only", kTrpoTable,
    Costs::kNone);

}  // namespace rdm

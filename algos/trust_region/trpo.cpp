#include "algos/trust_region/trpo.hpp"

#include <cmath>

#include "algos/algo_registry.hpp"

namespace rdm {

void Trpo::carve(Arena& arena) {
  Agent::carve(arena);
  region_.carve(arena, resolved(), nets(), constrained());
}

void Trpo::opened() {
  region_.open(resolved(), rollout(), nets(), workers(), learner());
}

void Trpo::read_live() {
  Agent::read_live();
  region_.read_live(options());
}

void Trpo::begin_step() {
  region_.begin_linearize(whole_batch(), followed_cost(), schedule_share());
  searching_ = false;
}

Job Trpo::step_on() {
  if (searching_)
    return region_.search_on([&](const Surrogate& a, const Surrogate& b) { return accept(a, b); });
  if (Job job = region_.linearize_on()) return job;
  aim();
  searching_ = true;
  return region_.begin_search();
}

void Trpo::aim() {
  region_.set_step(region_.q() > 0 ? std::sqrt(2 * region_.delta() / region_.q()) : 0, 0, 0);
}

bool Trpo::accept(const Surrogate& before, const Surrogate& after) const {
  return after.gain >= before.gain;
}

void Trpo::report(Learned& out) const {
  out.mean.loss = -region_.reached().gain;
  out.mean.kl = out.last_kl = region_.reached().kl;
}

constinit const AlgoRow kTrpo = make_algo_row<Trpo>(
    "trpo", "Trust region policy optimisation (Schulman et al. 2015); costs are only recorded", kTrpoRows,
    Costs::kNone);

}  // namespace rdm

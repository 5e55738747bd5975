#include "algos/lagrange/lagrange.hpp"

#include <algorithm>

#include "algos/lagrange/cost_weighted.hpp"

namespace rdm {

Lagrange::Lagrange(const ResolvedAgentConfig& resolved) : count_(resolved.num_limited) {
  const Options& o = resolved.options;
  split_ = kSplitRows.known_to(o) && kSplitRows.read(o).split;
  read_live(o);
  for (Multiplier& m : multiplier_) m.reset(options_);
}

void Lagrange::step(const JudgedCosts& costs, int32_t epoch) {
  const int32_t warmup = options_.warmup;
  const double warmth = warmup > 0 ? std::min(1.0, static_cast<double>(epoch - 1) / warmup) : 1;
  for (int32_t i = 0; i < count_; ++i)
    if (costs.fresh[i]) multiplier_[i].step(options_, costs.cost[i], costs.limit[i], warmth);
}

void Lagrange::visit(StateIo& io) {
  io.section("LAGR");
  for (int32_t i = 0; i < count_; ++i) multiplier_[i].visit(io);
}

}  // namespace rdm

#include "algos/lagrange/lagrange.hpp"

#include <algorithm>
#include <cstring>

namespace rdm {

Lagrange::Lagrange(const ResolvedAgentConfig& resolved) : count_(resolved.num_limited) {
  const Options& o = resolved.options;
  const char* name = o.text("multiplier_optimizer");
  options_.optimizer = std::strcmp(name, "sgd") == 0    ? MultiplierOptimizer::kSgd
                       : std::strcmp(name, "adam") == 0 ? MultiplierOptimizer::kAdam
                                                        : MultiplierOptimizer::kSoftplus;
  options_.init = o.number("multiplier_init");
  options_.normalized = o.flag("multiplier_normalized");
  split_ = o.knows("cost_loss") && std::strcmp(o.text("cost_loss"), "split") == 0;
  read_live(o);
  for (Multiplier& m : multiplier_) m.reset(options_);
}

void Lagrange::read_live(const Options& o) {
  options_.rate = o.number("multiplier_lr");
  options_.max = o.number("multiplier_max");
  options_.gain = o.number("multiplier_gain");
  warmup_ = o.integer("multiplier_warmup");
}

void Lagrange::step(const JudgedCosts& costs, int32_t epoch) {
  const double warmth = warmup_ > 0 ? std::min(1.0, static_cast<double>(epoch - 1) / warmup_) : 1;
  for (int32_t i = 0; i < count_; ++i)
    if (costs.fresh[i]) multiplier_[i].step(options_, costs.cost[i], costs.limit[i], warmth);
}

void Lagrange::visit(StateIo& io) {
  io.section("LAGR");
  for (int32_t i = 0; i < count_; ++i) multiplier_[i].visit(io);
}

}  // namespace rdm

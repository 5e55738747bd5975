// The rule of the Lagrangian methods: one multiplier for each cost limit, moved by dual ascent.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "algos/lagrange/multiplier.hpp"
#include "algos/rollout/limits.hpp"
#include "algos/rollout/rollout.hpp"

namespace rdm {

class Lagrange {
 public:
  explicit Lagrange(const ResolvedAgentConfig& resolved);
  // Moves the multipliers by the episode costs that limits hold for; not without a fresh one. epoch
  // counts from 1 and drives the warm-up.
  void step(const JudgedCosts& costs, int32_t epoch);
  double weight(int32_t i) const { return multiplier_[i].value(); }
  Mix mix() const { return Mix::kSum; }
  bool split() const { return split_; }
  void read_live(const Options& options);
  void visit(StateIo& io);

 private:
  MultiplierOptions options_;
  Multiplier multiplier_[kMaxCosts];
  int32_t count_ = 0, warmup_ = 0;
  bool split_ = false;
};

}  // namespace rdm

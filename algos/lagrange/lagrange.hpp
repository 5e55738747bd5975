// The rule of the Lagrangian methods: one multiplier for each cost limit, moved by dual ascent.
#pragma once
#include "algos/core/option_tables.hpp"
#include "algos/core/resolved_config.hpp"
#include "algos/lagrange/multiplier.hpp"
#include "algos/rollout/limits.hpp"
#include "algos/rollout/rollout.hpp"

namespace rdm {

struct LagrangeOptions : MultiplierOptions {
  int32_t warmup = 0;  // epochs in which rate and gain grow from 0
};
inline constexpr auto kLagrangeRows = option_rows<LagrangeOptions>(
    row<&MultiplierOptions::optimizer, MultiplierOptimizer::kSgd, MultiplierOptimizer::kAdam,
        MultiplierOptimizer::kSoftplus>(
        legacy(text_option("multiplier_optimizer", "adam", "sgd|adam|softplus",
                           "optimiser of the multipliers l; softplus: Adam on ln(e^l - 1)"))),
    row<&MultiplierOptions::init>(
        basic(number_option("multiplier_init", 0.001, 0, 1e6, "initial value of the multiplier"))),
    row<&MultiplierOptions::rate>(basic(
        number_option("multiplier_lr", 0.035, 0, 1e3, "learning rate of the multiplier, per epoch", true))),
    row<&MultiplierOptions::max>(
        number_option("multiplier_max", 1e6, 0, kMaxMultiplier, "upper bound of the multiplier", true)),
    row<&MultiplierOptions::gain>(number_option(
        "multiplier_gain", 0, 0, 1e6,
        "amount added to the multiplier per unit of violation; damps oscillations (augmented Lagrangian)",
        true)),
    row<&MultiplierOptions::normalized>(legacy(flag_option(
        "multiplier_normalized", false, "divide the violation by the limit; the quotient is bounded by 3"))),
    row<&LagrangeOptions::warmup>(
        integer_option("multiplier_warmup", 0, 0, 1 << 30,
                       "number of first epochs in which the multiplier's learning rate rises from 0", true)));

class Lagrange {
 public:
  explicit Lagrange(const ResolvedAgentConfig& resolved);
  // Moves the multipliers by the episode costs that limits hold for; not without a fresh one. epoch
  // counts from 1 and drives the warm-up.
  void step(const JudgedCosts& costs, int32_t epoch);
  double weight(int32_t i) const { return multiplier_[i].value(); }
  Mix mix() const { return Mix::kSum; }
  bool split() const { return split_; }
  void read_live(const Options& options) { options_ = kLagrangeRows.read(options); }
  void visit(StateIo& io);

 private:
  LagrangeOptions options_;
  Multiplier multiplier_[kMaxCosts];
  int32_t count_ = 0;
  bool split_ = false;
};

}  // namespace rdm

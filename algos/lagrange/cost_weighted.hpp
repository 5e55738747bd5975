// Safe methods that only weigh costs against the reward = a policy step x a rule for the weights.
#pragma once
#include "algos/agent/agent.hpp"
#include "base/option_rows.hpp"

namespace rdm {

// Where the cost part of a combined advantage stands.
struct SplitOptions {
  bool split;
};
inline constexpr auto kSplitRows =
    option_rows<SplitOptions>(row<&SplitOptions::split, false, true>(legacy(text_option(
        "cost_loss", "combined", "combined|split",
        "combined: (A_r - l A_c)/(1 + l), clipped as one; split: cost part not clipped, as in Ray et al."))));

// Base: an Agent. Rule: made from a ResolvedAgentConfig; step(costs, epoch) once per epoch before the policy step,
// then weight(i) of limited cost i, mix(), split(), read_live(options), visit(io).
template <class Base, class Rule>
class WithRule : public Base {
 public:
  explicit WithRule(ResolvedAgentConfig&& resolved) : Base(std::move(resolved)), rule_(this->resolved()) {}

 protected:
  void begin_epoch(const JudgedCosts& costs, int32_t epoch) override { rule_.step(costs, epoch); }
  const Rule& rule() const { return rule_; }
  double cost_weight(int32_t i) const override { return rule_.weight(i); }
  void read_live() override {
    Base::read_live();
    rule_.read_live(this->options());
  }
  void visit_state(StateIo& io) override {
    Base::visit_state(io);
    rule_.visit(io);
  }

 private:
  Rule rule_;
};

// The same where the policy climbs a combined advantage.
template <class Base, class Rule>
class CostWeighted : public WithRule<Base, Rule> {
 public:
  using WithRule<Base, Rule>::WithRule;

 protected:
  void begin_epoch(const JudgedCosts& costs, int32_t epoch) override {
    WithRule<Base, Rule>::begin_epoch(costs, epoch);
    const Rule& rule = this->rule();
    double weights[kMaxCosts];
    for (int32_t i = 0; i < this->resolved().num_limited; ++i) weights[i] = rule.weight(i);
    combine_advantages(this->rollout(), weights, rule.mix(), rule.split());
  }
};

}  // namespace rdm

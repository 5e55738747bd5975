// Lagrangian methods = any policy step x this rule: A = (A_r - sum l_i A_ci) / (1 + sum l_i).
#pragma once
#include "algos/episodes.hpp"
#include "algos/multiplier.hpp"
#include "algos/plan.hpp"
#include "algos/rollout.hpp"

namespace rdm {

class Lagrange {
 public:
  explicit Lagrange(const Plan& plan);
  // What an epoch of a rule sees: after the data, before the policy step (section 2.3 of Ray et al. 2019's
  // listing). epoch counts from 1. Without a fresh episode nothing moves.
  void step(const EpisodeStats& stats, const Plan& plan, int32_t epoch);
  double weight(int32_t i) const { return multiplier_[i].value(); }
  bool split() const { return split_; }
  void read_live(const Options& options);
  void visit(StateIo& io);

 private:
  MultiplierOptions options_;
  Multiplier multiplier_[kMaxCosts];
  int32_t count_ = 0, warmup_ = 0;
  bool split_ = false;
};

// The part of a rollout that the actor climbs, for weights [num_costs]: gain is the clipped advantage,
// linear the unclipped cost part, which is 0 unless split.
void combine_advantages(const Rollout& r, const double* weights, bool split);

// Gives a policy step `Base` the cost weights of `Rule`.
template <class Base, class Rule>
class Weighted : public Base {
 public:
  explicit Weighted(Plan&& plan) : Base(std::move(plan)), rule_(this->plan()) {}

 protected:
  void begin_epoch(const EpisodeStats& stats, int32_t epoch) override {
    rule_.step(stats, this->plan(), epoch);
    double weights[kMaxCosts];
    for (int32_t i = 0; i < this->plan().num_limited; ++i) weights[i] = rule_.weight(i);
    combine_advantages(this->rollout(), weights, rule_.split());
  }
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

}  // namespace rdm

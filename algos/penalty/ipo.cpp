#include "algos/penalty/ipo.hpp"

#include <cstring>

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/penalty/p3o.hpp"

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

void BarrierRule::step(const JudgedCosts& costs, int32_t) {
  for (int32_t i = 0; i < count_; ++i)
    if (costs.known[i]) slope_[i] = barrier_slope(costs.cost[i], costs.limit[i], kappa_, max_);
}

void BarrierRule::visit(StateIo& io) {
  io.section("BARR");
  io.numbers(slope_, static_cast<size_t>(count_), 0, kHuge);
}

void BarrierLoss::aim(const Surrogate& now, const double* violation, int32_t count) {
  for (int32_t k = 0; k < count; ++k)
    weight[k] = static_cast<float>(barrier_slope(now.cost[k] + violation[k], 0, kappa, max));
}

namespace {

// With barrier=exact: PPO's loss less kappa ln(-violation - L_c) of each cost.
class Ipo final : public CostWeighted<Ppo, BarrierRule> {
 public:
  explicit Ipo(ResolvedAgentConfig&& resolved) : CostWeighted(std::move(resolved)) {}

 protected:
  const PolicyLoss* policy_loss() const override { return exact_ ? &loss_ : CostWeighted::policy_loss(); }
  void opened() override { exact_ = std::strcmp(options().text("barrier"), "exact") == 0; }
  void read_live() override {
    CostWeighted::read_live();
    loss_.clip = static_cast<float>(options().number("clip"));
    loss_.kappa = options().number("barrier_kappa");
    loss_.max = options().number("barrier_max");
  }
  void begin_epoch(const JudgedCosts& costs, int32_t epoch) override {
    CostWeighted::begin_epoch(costs, epoch);
    known_ = costs.any_known();
    if (!exact_) return;
    follow_reward();
    for (int32_t i = 0; i < resolved().num_limited; ++i)
      violation_[i] = violation(costs, i), loss_.weight[i] = 0;
    if (known_) loss_.aim(Surrogate(), violation_, resolved().num_limited);
  }
  Job measure_minibatch(const Batch& batch) override {
    return exact_ && known_ ? learner().begin_measure(batch) : Job();
  }
  void begin_minibatch(const Surrogate& now) override {
    if (exact_ && known_) loss_.aim(now, violation_, resolved().num_limited);
  }
  double cost_weight(int32_t i) const override {
    return exact_ ? static_cast<double>(loss_.weight[i]) : CostWeighted::cost_weight(i);
  }

 private:
  BarrierLoss loss_;
  double violation_[kMaxCosts] = {};
  bool exact_ = false, known_ = false;
};

constexpr std::array kBarrierOptions = {
    text_option(
        "barrier", "epoch", "epoch|exact",
        "epoch: slope at J_c for an epoch, nearly a switch; exact: the paper's, at each minibatch's J_c"),
    basic(
        number_option("barrier_kappa", 0.01, 0, 1e6, "weight of ln(limit - J_c): 1 / m of the paper", true)),
    number_option("barrier_max", 1, 0, kHuge, "bound on the barrier's slope, and the slope beyond the limit",
                  true),
};
constexpr auto kIpoTable = with_defaults(join_options(kSharedOptions, kClipOptions, kBarrierOptions,
                                                      kSplitOptions, kViolationOptions, kWindowOptions),
                                         {OtherDefault{"violation_scale", 0, "raw"}});
}  // namespace
constinit const AlgoRow kIpo = make_algo_row<Ipo>(
    "ipo",
    "PPO with a cost weight that jumps to 1 at each limit; a barrier with barrier=exact (Liu et al. 2020)",
    kIpoTable, Costs::kAny);

}  // namespace rdm

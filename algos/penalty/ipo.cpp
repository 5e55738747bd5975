#include "algos/penalty/ipo.hpp"

#include "algos/algo_registry.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/penalty/p3o.hpp"

namespace rdm {
namespace {

constexpr auto kBarrierRows = option_rows<BarrierOptions>(
    row<&BarrierOptions::exact, false, true>(text_option(
        "barrier", "epoch", "epoch|exact",
        "slope of the barrier: epoch: at J_c, fixed in an epoch; exact: at each minibatch's J_c (paper)")),
    row<&BarrierOptions::kappa>(
        basic(number_option("barrier_kappa", 0.01, 0, 1e6,
                            "weight of the barrier's logarithm ln(limit - J_c), 1/t in the paper", true))),
    row<&BarrierOptions::max>(number_option(
        "barrier_max", 1, 0, kHuge, "largest slope of the barrier, and its slope beyond the limit", true)));

}  // namespace

double barrier_slope(double cost, double limit, double kappa, double max) {
  const double slope = kappa / (limit - cost + 1e-8);
  return slope < 0 || slope > max ? max : slope;
}

void BarrierRule::read_live(const Options& o) {
  barrier_ = kBarrierRows.read(o);
  split_ = kSplitRows.read(o).split;
}

void BarrierRule::step(const JudgedCosts& costs, int32_t) {
  for (int32_t i = 0; i < count_; ++i)
    if (costs.known[i])
      slope_[i] = barrier_slope(costs.cost[i], costs.limit[i], barrier_.kappa, barrier_.max);
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
  void read_live() override {
    CostWeighted::read_live();
    const BarrierOptions o = kBarrierRows.read(options());
    exact_ = o.exact;
    loss_.clip = clip(), loss_.kappa = o.kappa, loss_.max = o.max;
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

struct IpoOptions : PpoOptions, BarrierOptions, SplitOptions, ViolationOptions, WindowOptions {};
constexpr auto kIpoRows =
    option_rows<IpoOptions>(kPpoRows, kBarrierRows, kSplitRows, kViolationRows, kWindowRows)
        .with<&ViolationOptions::scale>("raw");
}  // namespace
constinit const AlgoRow kIpo = make_algo_row<Ipo>(
    "ipo", "PPO with a log barrier at each limit; by default almost a switch at the limit (Liu et al. 2020)",
    kIpoRows, Costs::kAny);

}  // namespace rdm

#include "algos/penalty/p3o.hpp"

#include "algos/algo_registry.hpp"

namespace rdm {
namespace {

constexpr double kMaxPenalty = 1e9;

constexpr auto kPenaltyRows = option_rows<PenaltyOptions>(
    row<&PenaltyOptions::init>(
        basic(number_option("penalty", 20, 0, 1e6, "initial weight of the penalty, kappa in the paper"))),
    row<&PenaltyOptions::growth>(number_option(
        "penalty_growth", 1, 1, 10,
        "factor on the penalty's weight after each epoch; 1: fixed (in the paper it grows)", true)),
    row<&PenaltyOptions::max>(
        number_option("penalty_max", 20, 0, kMaxPenalty, "largest weight of the penalty", true)),
    row<&PenaltyOptions::clip>(
        flag_option("penalty_clip", true,
                    "clip the probability ratio in the cost term too; other implementations do not", true)));

}  // namespace

SampleLoss penalty_loss(float ratio, float cost, float clip) {
  SampleLoss out;
  const float bounded = std::clamp(ratio, 1 - clip, 1 + clip);
  out.clipped = bounded * cost > ratio * cost;
  out.loss = (out.clipped ? bounded : ratio) * cost;
  out.slope = out.clipped ? 0 : ratio * cost;
  return out;
}

SampleLoss PenalizedSurrogate::sample(const Rollout& r, size_t at, float ratio) const {
  SampleLoss out = clipped_loss(ratio, r.gain[at], r.linear[at], clip);
  const auto costs = static_cast<size_t>(r.num_costs);
  for (size_t k = 0; k < costs; ++k) {
    if (weight[k] == 0) continue;
    const float cost = r.cost_advantage[at * costs + k];
    const SampleLoss part =
        clip_cost ? penalty_loss(ratio, cost, clip) : SampleLoss{ratio * cost, ratio * cost};
    out.loss += weight[k] * part.loss;
    out.slope += weight[k] * part.slope;
  }
  return out;
}

void P3o::opened() {
  kappa_ = kPenaltyRows.read(options()).init;
}

void P3o::read_live() {
  Ppo::read_live();
  penalty_ = kPenaltyRows.read(options());
  loss_.clip = clip();
  loss_.clip_cost = penalty_.clip;
}

void P3o::begin_epoch(const JudgedCosts& costs, int32_t epoch) {
  Ppo::begin_epoch(costs, epoch);
  // a penalty that begins above the bound of its growth stays
  if (epoch > 1) kappa_ = std::max(kappa_, std::min(kappa_ * penalty_.growth, penalty_.max));
  for (int32_t i = 0; i < resolved().num_limited; ++i) violation_[i] = violation(costs, i);
}

Job P3o::measure_minibatch(const Batch& batch) {
  return learner().begin_measure(batch, loss_.clip_cost ? loss_.clip : 0);
}

void P3o::begin_minibatch(const Surrogate& now) {
  for (int32_t k = 0; k < resolved().num_limited; ++k)
    loss_.weight[k] = now.cost[k] + violation_[k] > 0 ? static_cast<float>(kappa_) : 0;
}

void P3o::visit_state(StateIo& io) {
  Ppo::visit_state(io);
  io.section("P3O ");
  io.number(kappa_, 0, kMaxPenalty);
}

namespace {
struct P3oOptions : PpoOptions, PenaltyOptions, ViolationOptions, WindowOptions {};
constexpr auto kP3oRows = option_rows<P3oOptions>(kPpoRows, kPenaltyRows, kViolationRows, kWindowRows);
}  // namespace
constinit const AlgoRow kP3o = make_algo_row<P3o>(
    "p3o", "PPO with an exact penalty of fixed weight on violations of each limit (Zhang et al. 2022)",
    kP3oRows, Costs::kAny);

}  // namespace rdm

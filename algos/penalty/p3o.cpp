#include "algos/penalty/p3o.hpp"

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"

namespace rdm {
namespace {
constexpr double kMaxPenalty = 1e9;
}

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

void P3o::read_live() {
  Ppo::read_live();
  loss_.clip = static_cast<float>(options().number("clip"));
  loss_.clip_cost = options().flag("penalty_clip");
}

void P3o::begin_epoch(const JudgedCosts& costs, int32_t epoch) {
  Ppo::begin_epoch(costs, epoch);
  if (epoch > 1)
    kappa_ = std::min(kappa_ * options().number("penalty_growth"), options().number("penalty_max"));
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
constexpr std::array kPenaltyOptions = {
    basic(number_option("penalty", 20, 0, 1e6, "kappa, initial weight of the penalty")),
    number_option("penalty_growth", 1, 1, 10,
                  "factor on kappa per epoch; 1: fixed, where the paper has it grow", true),
    number_option("penalty_max", 20, 0, kMaxPenalty, "largest kappa", true),
    flag_option("penalty_clip", true, "clip the cost's ratio too; the peers do not", true),
};
constexpr auto kP3oTable =
    join_options(kSharedOptions, kClipOptions, kPenaltyOptions, kViolationOptions, kWindowOptions);
}  // namespace
constinit const AlgoRow kP3o = make_algo_row<P3o>(
    "p3o", "PPO with an exact penalty of fixed weight on each cost limit (Zhang et al. 2022)", kP3oTable,
    Costs::kAny);

}  // namespace rdm

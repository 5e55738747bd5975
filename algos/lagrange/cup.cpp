#include "algos/lagrange/cup.hpp"

#include <algorithm>

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "base/elementary.hpp"
#include "nn/gaussian.hpp"

namespace rdm {
namespace {

constexpr double kLargestFactor = 100;

constexpr auto kProjectionRows = option_rows<ProjectionOptions>(
    row<&ProjectionOptions::passes>(integer_option(
        "projection_passes", 0, 0, 10000, "passes over the data of the projection; 0: as many as passes")),
    row<&ProjectionOptions::factor>(number_option(
        "projection_factor", 0, 0, 1e6,
        "factor on the projection's cost term; 0: (1 - discount lambda)/(1 - discount), at most 100", true)));

}  // namespace

void ProjectionLoss::add(const PolicyChunk& chunk) const {
  const Rollout& r = *chunk.rollout;
  const size_t dim = r.action_dim, costs = static_cast<size_t>(r.num_costs);
  const auto dims = static_cast<int32_t>(dim);
  float precision[kMaxActions], spread[kMaxActions];  // 1 / variance; variance of the half step
  for (size_t i = 0; i < static_cast<size_t>(chunk.rows); ++i) {
    const auto at = static_cast<size_t>(chunk.order[i]);
    const float *now = chunk.mean_of(i), *now_std = chunk.log_std_of(i);
    const float *half = mean + at * mean_step, *half_std = log_std + at * std_step;
    float *dmean = chunk.dmean_of(i), *dstd = chunk.dlog_std_of(i);
    for (size_t j = 0; (i == 0 || std_step > 0) && j < dim; ++j) {
      precision[j] = static_cast<float>(elementary::exp(-2 * static_cast<double>(now_std[j])));
      spread[j] = static_cast<float>(elementary::exp(2 * static_cast<double>(half_std[j])));
    }
    float cost = 0;
    for (size_t k = 0; k < costs; ++k) cost += weight[k] * r.cost_advantage[at * costs + k];
    const float pull = static_cast<float>(sample_ratio(r, at, now, now_std)) * cost;
    gaussian_log_prob_grad(now, now_std, r.action + at * dim, dims, chunk.scale * pull, dmean, dstd);
    for (size_t j = 0; j < dim; ++j) {
      const float gap = now[j] - half[j];
      dmean[j] += chunk.scale * gap * precision[j];
      dstd[j] += chunk.scale * (1 - (spread[j] + gap * gap) * precision[j]);
    }
    chunk.sums->loss += static_cast<double>(gaussian_kl(half, half_std, now, now_std, dims) + pull);
    chunk.sums->kl +=
        static_cast<double>(gaussian_kl(r.mean + at * dim, r.log_std_of(at), now, now_std, dims));
  }
}

void Cup::carve(Arena& arena) {
  Ppo::carve(arena);
  half_ =
      arena.make<float>(static_cast<size_t>(resolved().samples) * static_cast<size_t>(resolved().actor.out));
  half_std_ = arena.make<float>(resolved().state_std() ? 0 : resolved().action_dim());
}

void Cup::opened() {
  Ppo::opened();
  projection_.mean = half_;
  projection_.mean_step = static_cast<size_t>(resolved().actor.out);
  projection_.log_std = resolved().state_std() ? half_ + resolved().action_dim() : half_std_;
  projection_.std_step = resolved().state_std() ? projection_.mean_step : 0;
}

void Cup::read_live() {
  Ppo::read_live();
  lagrange_.read_live(options());
  options_ = kProjectionRows.read(options());
}

void Cup::begin_epoch(const JudgedCosts& costs, int32_t epoch) {
  lagrange_.step(costs, epoch);
  follow_reward();
  projects_ = false;
}

int32_t Cup::second_passes() const {
  return options_.passes > 0 ? options_.passes : resolved().shared.passes;
}

Job Cup::begin_second() {
  projects_ = true;
  const double discount = elementary::pow(this->discount(), action_repeat());
  const double most = kLargestFactor * (1 - discount), own = 1 - discount * resolved().shared.lambda;
  const double factor = options_.factor > 0 ? options_.factor
                        : own < most        ? own / (1 - discount)
                                            : kLargestFactor;
  for (int32_t i = 0; i < resolved().num_limited; ++i)
    projection_.weight[i] = static_cast<float>(factor * lagrange_.weight(i));
  for (size_t j = 0; !resolved().state_std() && j < resolved().action_dim(); ++j)
    half_std_[j] = nets().log_std()[j] + resolved().log_share;
  return learner().begin_outputs(whole_batch(), half_);
}

void Cup::visit_state(StateIo& io) {
  Ppo::visit_state(io);
  lagrange_.visit(io);
}

namespace {
struct CupOptions : PpoOptions, LagrangeOptions, WindowOptions, ProjectionOptions {};
constexpr auto kCupRows = option_rows<CupOptions>(kPpoRows, kLagrangeRows, kWindowRows, kProjectionRows)
                              .with<&MultiplierOptions::max>(2.0);
}  // namespace
constinit const AlgoRow kCup = make_algo_row<Cup>(
    "cup", "PPO's step on the reward, then a projection towards the cost limits (Yang et al. 2022)", kCupRows,
    Costs::kAny);

}  // namespace rdm

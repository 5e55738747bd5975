#include "algos/lagrange/focops.hpp"

#include <algorithm>

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "base/elementary.hpp"
#include "nn/gaussian.hpp"

namespace rdm {
namespace {

constexpr double kPaperBound = 2;  // on nu

constexpr auto kOwnRows = option_rows<FocopsOwnOptions>(
    row<&FocopsOwnOptions::temperature>(
        number_option("temperature", 1.5, 1e-6, 1e6, "fixed temperature, lambda in the paper", true)),
    row<&FocopsOwnOptions::eta>(
        basic(number_option("focops_eta", 0.02, 0, 1e6,
                            "samples whose KL(new || old) exceeds this are left out of the gradient", true))),
    row<&FocopsOwnOptions::divide>(
        legacy(flag_option("multiplier_divide", false,
                           "divide the combined advantage by 1 + nu, as other implementations do"))));

}  // namespace

void FocopsLoss::add(const PolicyChunk& chunk) const {
  const Rollout& r = *chunk.rollout;
  const size_t dim = r.action_dim;
  const auto dims = static_cast<int32_t>(dim);
  float precision[kMaxActions], dlog_std[kMaxActions];  // 1 / old variance; d KL / d log sigma
  const auto prepare = [&](const float* log_std, const float* old) {
    for (size_t j = 0; j < dim; ++j) {
      const auto was = static_cast<double>(old[j]);
      precision[j] = static_cast<float>(elementary::exp(-2 * was));
      dlog_std[j] = static_cast<float>(elementary::expm1(2 * (static_cast<double>(log_std[j]) - was)));
    }
  };
  for (size_t i = 0; i < static_cast<size_t>(chunk.rows); ++i) {
    const auto at = static_cast<size_t>(chunk.order[i]);
    const float *mean = chunk.mean_of(i), *log_std = chunk.log_std_of(i);
    const float *old = r.mean + at * dim, *old_log_std = r.log_std_of(at);
    float *dmean = chunk.dmean_of(i), *dstd = chunk.dlog_std_of(i);
    if (i == 0 || chunk.std_step > 0) prepare(log_std, old_log_std);
    const float kl = gaussian_kl(mean, log_std, old, old_log_std, dims);
    chunk.sums->kl += static_cast<double>(gaussian_kl(old, old_log_std, mean, log_std, dims));
    if (!(kl <= eta)) {
      std::fill_n(dmean, dim, 0.0f);
      chunk.sums->clipped += 1;
      continue;
    }
    const auto ratio = static_cast<float>(sample_ratio(r, at, mean, log_std));
    const float pull = ratio * r.gain[at] / temperature;
    gaussian_log_prob_grad(mean, log_std, r.action + at * dim, dims, -chunk.scale * pull, dmean, dstd);
    for (size_t j = 0; j < dim; ++j) {
      dmean[j] += chunk.scale * (mean[j] - old[j]) * precision[j];
      dstd[j] += chunk.scale * dlog_std[j];
    }
    chunk.sums->loss += static_cast<double>(kl - pull);
  }
}

void FocopsBase::read_live() {
  Agent::read_live();
  const FocopsOwnOptions o = kOwnRows.read(options());
  loss_.temperature = static_cast<float>(o.temperature);
  loss_.eta = static_cast<float>(o.eta);
}

FocopsRule::FocopsRule(const ResolvedAgentConfig& resolved)
    : lagrange_(resolved),
      count_(resolved.num_limited),
      mix_(kOwnRows.read(resolved.options).divide ? Mix::kSum : Mix::kPlain) {}

void FocopsRule::step(const JudgedCosts& costs, int32_t epoch) {
  lagrange_.step(costs, epoch);
  int32_t worst = -1;
  for (int32_t i = 0; i < costs.count; ++i)
    if (costs.known[i] && (worst < 0 || costs.excess(i) > costs.excess(worst))) worst = i;
  if (worst >= 0) worst_ = worst;
}

void FocopsRule::visit(StateIo& io) {
  lagrange_.visit(io);
  io.integer(worst_, 0, count_ - 1);
}

namespace {

// No cost is under a limit of 0, so there nu only climbs. A large one would leave of the reward, beside the
// KL's fixed weight, next to nothing.
void bound_multiplier(ResolvedAgentConfig& resolved) {
  const double *limit = resolved.limit, bound = kLagrangeRows.read(resolved.options).max;
  if (std::find(limit, limit + resolved.num_limited, 0.0) != limit + resolved.num_limited)
    resolved.options.set_default("multiplier_max", std::min(bound, kPaperBound));
}

struct FocopsOptions : SharedOptions, LagrangeOptions, WindowOptions, FocopsOwnOptions, OneCostOptions {};
constexpr auto kFocopsRows =
    option_rows<FocopsOptions>(kSharedRows, kLagrangeRows, kWindowRows, kOwnRows, kOneCostRows)
        .with<&MultiplierOptions::optimizer>("sgd")
        .with<&MultiplierOptions::init>(0.0)
        .with<&MultiplierOptions::rate>(0.01)
        .with<&MultiplierOptions::max>(kPaperBound)
        .with<&SharedOptions::early_stop_kl>(0.02);
}  // namespace
constinit const AlgoRow kFocops = make_algo_row<Focops>(
    "focops", "First-order constrained optimisation in policy space (Zhang et al. 2020)", kFocopsRows,
    Costs::kOne, bound_multiplier);

}  // namespace rdm

#include "algos/first_order/ratio_loss.hpp"

#include "nn/gaussian.hpp"

namespace rdm {

void RatioLoss::add(const PolicyChunk& chunk) const {
  const Rollout& r = *chunk.rollout;
  const auto dim = static_cast<int32_t>(r.action_dim);
  for (size_t i = 0; i < static_cast<size_t>(chunk.rows); ++i) {
    const auto at = static_cast<size_t>(chunk.order[i]);
    const float *action = r.action + at * r.action_dim, *mean = chunk.mean_of(i);
    const float* log_std = chunk.log_std_of(i);
    const double ratio = sample_ratio(r, at, mean, log_std);
    const SampleLoss l = sample(r, at, static_cast<float>(ratio));
    gaussian_log_prob_grad(mean, log_std, action, dim, chunk.scale * l.slope, chunk.dmean_of(i),
                           chunk.dlog_std_of(i));
    chunk.sums->loss += static_cast<double>(l.loss);
    chunk.sums->clipped += l.clipped;
    chunk.sums->kl +=
        static_cast<double>(gaussian_kl(r.mean + at * r.action_dim, r.log_std_of(at), mean, log_std, dim));
  }
}

SampleLoss GainLoss::sample(const Rollout& r, size_t at, float ratio) const {
  const float loss = -ratio * (r.gain[at] + r.linear[at]);
  return {loss, loss, false};
}

SampleLoss CostLoss::sample(const Rollout& r, size_t at, float ratio) const {
  const float loss = ratio * r.cost_advantage[at * static_cast<size_t>(r.num_costs) + column_];
  return {loss, loss, false};
}

}  // namespace rdm

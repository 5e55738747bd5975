#include "algos/first_order/ratio_loss.hpp"

#include "nn/gaussian.hpp"

namespace rdm {

// Of several groups each has its own ratio and its own clip (Yu et al. 2022): a diagonal normal factors, so the
// gradient of a group's parameters is that of its own factor.
void RatioLoss::add(const PolicyChunk& chunk) const {
  const Rollout& r = *chunk.rollout;
  for (size_t i = 0; i < static_cast<size_t>(chunk.rows); ++i) {
    const auto at = static_cast<size_t>(chunk.order[i]);
    const float *action = r.action + at * r.action_dim, *mean = chunk.mean_of(i);
    const float* log_std = chunk.log_std_of(i);
    const double share = 1 / static_cast<double>(chunk.last_part - chunk.first_part);
    for (size_t g = chunk.first_part; g < chunk.last_part; ++g) {
      const auto [first, count] = r.part(g);
      const SampleLoss l =
          sample(r, r.valued(at, g), static_cast<float>(part_ratio(r, at, g, mean, log_std)));
      gaussian_log_prob_grad(mean + first, log_std + first, action + first, static_cast<int32_t>(count),
                             chunk.scale * l.slope, chunk.dmean_of(i) + first, chunk.dlog_std_of(i) + first);
      chunk.sums->loss += share * static_cast<double>(l.loss);
      chunk.sums->clipped += share * l.clipped;
    }
    chunk.sums->kl += sample_kl(r, at, chunk.first_part, chunk.last_part, mean, log_std);
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

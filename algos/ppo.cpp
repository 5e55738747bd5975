#include "algos/ppo.hpp"

#include "algos/algo_registry.hpp"
#include "algos/option_tables.hpp"
#include "base/elementary.hpp"
#include "nn/gaussian.hpp"

namespace rdm {

SampleLoss clipped_loss(float ratio, float gain, float linear, float clip) {
  SampleLoss out;
  out.clipped = gain >= 0 ? ratio > 1 + clip : ratio < 1 - clip;
  const float bound = gain >= 0 ? 1 + clip : 1 - clip;
  out.loss = -(out.clipped ? bound : ratio) * gain - ratio * linear;
  out.slope = -ratio * ((out.clipped ? 0 : gain) + linear);
  return out;
}

void ClippedSurrogate::add(const PolicyPiece& piece) const {
  const Rollout& r = *piece.rollout;
  const auto dim = static_cast<int32_t>(r.action_dim);
  for (size_t i = 0; i < static_cast<size_t>(piece.rows); ++i) {
    const auto at = static_cast<size_t>(piece.order[i]);
    const float *action = r.action + at * r.action_dim, *mean = piece.mean + i * r.action_dim;
    const float change = gaussian_log_prob(mean, piece.log_std, action, dim) - r.log_prob[at];
    // exp(20) is far past any clip and still finite after it is multiplied.
    const double ratio = elementary::exp(static_cast<double>(std::min(change, 20.0f)));
    const SampleLoss l = clipped_loss(static_cast<float>(ratio), r.gain[at], r.linear[at], clip);
    gaussian_log_prob_grad(mean, piece.log_std, action, dim, piece.scale * l.slope,
                           piece.dmean + i * r.action_dim, piece.dlog_std);
    piece.sums->loss += static_cast<double>(l.loss);
    piece.sums->clipped += l.clipped;
    piece.sums->kl +=
        static_cast<double>(gaussian_kl(r.mean + at * r.action_dim, r.log_std, mean, piece.log_std, dim));
  }
}

namespace {
constexpr auto kOptions = join_options(kSharedOptions, kClipOptions);
}
constinit const AlgoRow kPpo = make_algo_row<Ppo>(
    "ppo", "Proximal policy optimisation, clipped (Schulman et al. 2017); costs are recorded only", kOptions,
    false);

}  // namespace rdm

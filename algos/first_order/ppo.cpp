#include "algos/first_order/ppo.hpp"

#include "algos/algo_registry.hpp"

namespace rdm {

SampleLoss clipped_loss(float ratio, float gain, float linear, float clip) {
  SampleLoss out;
  out.clipped = gain >= 0 ? ratio > 1 + clip : ratio < 1 - clip;
  const float bound = gain >= 0 ? 1 + clip : 1 - clip;
  out.loss = -(out.clipped ? bound : ratio) * gain - ratio * linear;
  out.slope = -ratio * ((out.clipped ? 0 : gain) + linear);
  return out;
}

constinit const AlgoRow kPpo = make_algo_row<Ppo>(
    "ppo",
    "Proximal policy optimisation with a clipped ratio (Schulman et al. 2017); costs are only recorded",
    kPpoRows, Costs::kNone);

}  // namespace rdm

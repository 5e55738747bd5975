#include "algos/core/batch_workers.hpp"

#include <cmath>

namespace rdm {
namespace {

// Scratch for `wide` also serves `narrow`.
bool covers(const MlpShape& wide, const MlpShape& narrow) {
  if (wide.num_hidden != narrow.num_hidden || wide.out < narrow.out) return false;
  for (int32_t l = 0; l < wide.num_hidden; ++l)
    if (wide.hidden[l] < narrow.hidden[l]) return false;
  return true;
}

Lane carve_lane(Arena& arena, const ResolvedAgentConfig& plan, size_t num_params) {
  Lane lane;
  lane.rows = plan.piece_rows;
  const auto rows = static_cast<size_t>(lane.rows);
  const auto widest = static_cast<size_t>(std::max(plan.actor.out, plan.cost_critic.out));
  lane.actor = carve_mlp_scratch(arena, plan.actor, lane.rows);
  lane.critic = covers(plan.actor, plan.cost_critic) ? lane.actor
                                                     : carve_mlp_scratch(arena, plan.cost_critic, lane.rows);
  lane.obs = arena.make<float>(rows * plan.obs_dim());
  lane.out = arena.make<float>(rows * widest);
  lane.dout = arena.make<float>(rows * widest);
  lane.grad = arena.make<float>(num_params);
  return lane;
}

}  // namespace

bool Surrogate::finite() const {
  double sum = gain + kl;
  for (const double c : cost) sum += c;
  return std::isfinite(sum);
}

void BatchWorkers::fold(int32_t group, int32_t n, float* total, size_t begin, size_t end) {
  const int32_t from = group == 0 ? 1 : 0;
  if (from >= n) return;
  const auto ranges = static_cast<size_t>(n), size = end - begin;
  spread(n, [&](int32_t range) {
    const auto k = static_cast<size_t>(range);
    const size_t low = begin + size * k / ranges, high = begin + size * (k + 1) / ranges;
    for (int32_t l = from; l < n; ++l) {
      const float* part = lanes_[l].grad;
      for (size_t i = low; i < high; ++i) total[i] += part[i];
    }
  });
}

void BatchWorkers::carve(Arena& arena, const ResolvedAgentConfig& plan, size_t num_params) {
  count_ = plan.lanes;
  lanes_ = arena.make<Lane>(static_cast<size_t>(count_));
  for (int32_t i = 0; i < count_; ++i) {
    const Lane lane = carve_lane(arena, plan, num_params);
    if (lanes_) lanes_[i] = lane;
  }
}

}  // namespace rdm

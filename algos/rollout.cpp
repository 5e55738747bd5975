#include "algos/rollout.hpp"

namespace rdm {

Rollout carve_rollout(Arena& arena, const Plan& plan) {
  Rollout r;
  r.horizon = plan.horizon;
  r.num_envs = plan.config.num_envs;
  r.num_costs = plan.num_limited;
  r.obs_dim = plan.obs_dim();
  r.action_dim = plan.action_dim();
  const auto n = static_cast<size_t>(plan.samples), k = static_cast<size_t>(r.num_costs);
  r.obs = arena.make<float>(n * r.obs_dim);
  r.action = arena.make<float>(n * r.action_dim);
  r.mean = arena.make<float>(n * r.action_dim);
  for (float** column :
       {&r.log_prob, &r.reward, &r.value, &r.advantage, &r.target, &r.discount, &r.gain, &r.linear})
    *column = arena.make<float>(n);
  for (float** column : {&r.cost, &r.cost_value, &r.cost_advantage, &r.cost_target})
    *column = arena.make<float>(n * k);
  r.valid = arena.make<uint8_t>(n);
  r.last_value = arena.make<float>(plan.num_envs());
  r.last_cost_value = arena.make<float>(plan.num_envs() * k);
  r.log_std = arena.make<float>(r.action_dim);
  r.order = arena.make<int32_t>(n);
  return r;
}

void estimate_advantages(const Rollout& r, const AdvantageOptions& options) {
  gae({r.reward, r.value, r.last_value, r.advantage, r.target, 1}, r.discount, r.valid, r.horizon, r.num_envs,
      options.lambda);
  if (options.standardize_reward) standardize(r.advantage, 1, r.valid, r.samples(), true);
  for (int32_t k = 0; k < r.num_costs; ++k) {
    gae({r.cost + k, r.cost_value + k, r.last_cost_value + k, r.cost_advantage + k, r.cost_target + k,
         r.num_costs},
        r.discount, r.valid, r.horizon, r.num_envs, options.cost_lambda);
    standardize(r.cost_advantage + k, r.num_costs, r.valid, r.samples(), options.standardize_cost);
  }
}

void combine_advantages(const Rollout& r, const double* weights, bool split) {
  const auto costs = static_cast<size_t>(r.num_costs);
  double total = 1;
  for (size_t k = 0; k < costs; ++k) total += weights[k];
  for (size_t i = 0; i < static_cast<size_t>(r.samples()); ++i) {
    double cost = 0;
    for (size_t k = 0; k < costs; ++k)
      cost += weights[k] * static_cast<double>(r.cost_advantage[i * costs + k]);
    const auto reward = static_cast<double>(r.advantage[i]);
    r.gain[i] = static_cast<float>((split ? reward : reward - cost) / total);
    r.linear[i] = static_cast<float>(split ? -cost / total : 0);
  }
}

int32_t list_valid(const Rollout& r) {
  int32_t count = 0;
  for (int32_t i = 0; i < r.samples(); ++i)
    if (r.valid[i]) r.order[count++] = i;
  return count;
}

}  // namespace rdm

// The collecting half of PolicyGradient: act and record.
#include <cmath>
#include <cstring>

#include "algos/policy_gradient.hpp"
#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "nn/gaussian.hpp"

namespace rdm {

void check_rows(const char* name, const float* x, const uint8_t* mask, int32_t rows, size_t dim) {
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) {
    if (mask && !mask[i]) continue;
    // Zero times a number that is not finite is not a number.
    float sum = 0;
    for (size_t j = 0; j < dim; ++j) sum += x[i * dim + j] * 0.0f;
    if (sum != 0) fail(Code::kArgument, "%s: row %zu is not finite", name, i);
  }
}

const float* PolicyGradient::normalized(const float* obs, int32_t rows, float* memory) const {
  if (!normalize_) return obs;
  normalizer_apply(normalizer_, obs, rows, memory);
  return memory;
}

void PolicyGradient::read_log_std(float* log_std) const {
  for (size_t j = 0; j < plan_.action_dim(); ++j) log_std[j] = nets_.log_std()[j] + noise_.log_share();
}

void PolicyGradient::forward_critics(const Lane& lane, const float* x, int32_t rows, float* value,
                                     float* cost_value) const {
  mlp_forward(nets_.shape[Networks::kReward], nets_.net(Networks::kReward), x, rows, lane.critic, value);
  if (nets_.count > Networks::kCost)
    mlp_forward(nets_.shape[Networks::kCost], nets_.net(Networks::kCost), x, rows, lane.critic, cost_value);
}

void PolicyGradient::mean_rows(const Lane& lane, const float* obs, int32_t rows, float* action) const {
  const float* x = normalized(obs, rows, lane.obs);
  mlp_forward(nets_.shape[Networks::kActor], nets_.net(Networks::kActor), x, rows, lane.actor, action);
}

void PolicyGradient::act_rows(const Lane& lane, const float* obs, int32_t first, int32_t rows,
                              float* action) {
  Rollout& r = rollout_;
  const size_t at = r.row(r.filled) + static_cast<size_t>(first), dim = plan_.action_dim();
  float* x = r.obs + at * r.obs_dim;
  if (normalize_)
    normalizer_apply(normalizer_, obs, rows, x);
  else
    std::memcpy(x, obs, static_cast<size_t>(rows) * r.obs_dim * sizeof(float));
  float* mean = r.mean + at * dim;
  mlp_forward(nets_.shape[Networks::kActor], nets_.net(Networks::kActor), x, rows, lane.actor, mean);
  forward_critics(lane, x, rows, r.value + at, r.cost_value + at * static_cast<size_t>(plan_.num_limited));
  for (int32_t i = 0; i < rows; ++i) {
    const auto k = static_cast<size_t>(i);
    float* centered = r.action + (at + k) * dim;
    noise_.sample(first + i, mean + k * dim, std_, action + k * dim, centered);
    r.log_prob[at + k] = gaussian_log_prob(mean + k * dim, log_std_, centered, plan_.config.action_dim);
  }
}

void PolicyGradient::act(const float* obs, bool sample, float* action) {
  const FpMode mode;
  if (sample && pending_) fail(Code::kState, "act: the last sampled actions were not recorded");
  if (sample && missing() == 0) fail(Code::kState, "act: the horizon is full, update is due");
  const int32_t envs = plan_.config.num_envs;
  check_rows("obs", obs, nullptr, envs, plan_.obs_dim());
  if (sample) {
    if (normalize_) normalizer_merge(normalizer_, obs, envs, nullptr, plan_.options.number("obs_count_max"));
    read_log_std(log_std_);
    for (size_t j = 0; j < plan_.action_dim(); ++j) std_[j] = std::exp(log_std_[j]);
  }
  // Rows do not depend on their batch, so the cut may follow the number of lanes.
  const int32_t share = std::min((envs + plan_.lanes - 1) / plan_.lanes, kPieceRows);
  sweep(
      *workers_, plan_.lanes, (envs + share - 1) / share,
      [&](int32_t l, int32_t piece) {
        const int32_t first = piece * share, rows = std::min(share, envs - first);
        const auto at = static_cast<size_t>(first);
        const float* x = obs + at * plan_.obs_dim();
        float* a = action + at * plan_.action_dim();
        if (sample)
          act_rows(lanes_[l], x, first, rows, a);
        else
          mean_rows(lanes_[l], x, rows, a);
      },
      [](int32_t, int32_t) {});
  if (sample) pending_ = true;
}

void PolicyGradient::check_transition(const Transition& t) const {
  const AgentConfig& c = plan_.config;
  if (!t.reward) fail(Code::kArgument, "reward: NULL");
  if (!t.cost && c.cost_dim > 0) fail(Code::kArgument, "cost: NULL with cost_dim %d", c.cost_dim);
  check_rows("reward", t.reward, t.valid, c.num_envs, 1);
  check_rows("cost", t.cost, t.valid, c.num_envs, static_cast<size_t>(c.cost_dim));
  for (int32_t env = 0; env < c.num_envs; ++env) {
    if (t.valid && !t.valid[env]) continue;
    if (t.steps && t.steps[env] < 0) fail(Code::kRange, "steps: row %d is %d", env, t.steps[env]);
    if (t.truncated && t.truncated[env] && t.final_obs) {
      const size_t at = static_cast<size_t>(env) * plan_.obs_dim();
      float sum = 0;
      for (size_t j = 0; j < plan_.obs_dim(); ++j) sum += t.final_obs[at + j] * 0.0f;
      if (sum != 0) fail(Code::kArgument, "final_obs: row %d is not finite", env);
    }
  }
}

// V of the final observations of paths that were cut by a time limit; 0 elsewhere.
void PolicyGradient::value_truncated(const Transition& t) {
  const size_t envs = plan_.num_envs(), costs = static_cast<size_t>(plan_.num_limited);
  std::memset(final_value_, 0, envs * sizeof(float));
  std::memset(final_cost_, 0, envs * costs * sizeof(float));
  if (!t.truncated || !t.final_obs) return;
  int32_t count = 0;
  for (int32_t env = 0; env < plan_.config.num_envs; ++env)
    if (t.truncated[env] && !(t.terminated && t.terminated[env]) && !(t.valid && !t.valid[env]))
      listed_[count++] = env;
  const Lane& lane = lanes_[0];
  for (int32_t first = 0; first < count; first += lane.rows) {
    const int32_t rows = std::min(lane.rows, count - first);
    float* value = lane.out;
    for (int32_t i = 0; i < rows; ++i) {
      const float* obs = t.final_obs + static_cast<size_t>(listed_[first + i]) * plan_.obs_dim();
      std::memcpy(lane.obs + static_cast<size_t>(i) * plan_.obs_dim(), obs, plan_.obs_dim() * sizeof(float));
    }
    if (normalize_) normalizer_apply(normalizer_, lane.obs, rows, lane.obs);
    forward_critics(lane, lane.obs, rows, value, lane.dout);
    for (int32_t i = 0; i < rows; ++i) {
      const auto env = static_cast<size_t>(listed_[first + i]);
      final_value_[env] = value[i];
      for (size_t k = 0; k < costs; ++k)
        final_cost_[env * costs + k] = lane.dout[static_cast<size_t>(i) * costs + k];
    }
  }
}

// A fall ends costs early, which is no safety: the steps that are missing are charged at the episode's own
// rate, discounted in what is learned from and in full in the episode's cost.
void PolicyGradient::charge_fall(int32_t env, float discount, float* sample_cost, double* charge) const {
  const int64_t length = episodes_.length(env), left = plan_.config.max_steps - length;
  for (int32_t k = 0; k < plan_.config.cost_dim; ++k) charge[k] = 0;
  if (left <= 0 || length == 0) return;
  for (int32_t k = 0; k < plan_.config.cost_dim; ++k)
    charge[k] = episodes_.cost(env, k) / static_cast<double>(length) * static_cast<double>(left);
  const auto steps = static_cast<double>(left);
  const double tail = discount_ < 1 ? (1 - std::pow(discount_, steps)) / (1 - discount_) : steps;
  for (int32_t i = 0; i < plan_.num_limited; ++i)
    sample_cost[i] += discount * static_cast<float>(charge[plan_.column[i]] / steps * tail);
}

void PolicyGradient::record_row(const Transition& t, int32_t env) {
  Rollout& r = rollout_;
  const auto e = static_cast<size_t>(env), costs = static_cast<size_t>(plan_.num_limited);
  const size_t at = r.row(r.filled) + e;
  r.valid[at] = !t.valid || t.valid[e];
  r.reward[at] = r.discount[at] = 0;
  for (size_t i = 0; i < costs; ++i) r.cost[at * costs + i] = 0;
  if (!r.valid[at]) {
    noise_.end_episode(env);
    return;
  }
  const float* cost = t.cost ? t.cost + e * static_cast<size_t>(plan_.config.cost_dim) : nullptr;
  const int32_t steps = t.steps ? t.steps[e] : plan_.action_repeat;
  const bool terminated = t.terminated && t.terminated[e];
  const bool truncated = !terminated && t.truncated && t.truncated[e];
  const auto discount = static_cast<float>(std::pow(discount_, steps));
  env_steps_ += steps;
  episodes_.add(env, static_cast<double>(t.reward[e]), cost, steps, t.success && t.success[e]);
  r.reward[at] = t.reward[e] + discount * final_value_[e];
  for (size_t i = 0; i < costs; ++i)
    r.cost[at * costs + i] = cost[plan_.column[i]] + discount * final_cost_[e * costs + i];
  r.discount[at] = terminated || truncated ? 0 : discount;
  if (!terminated && !truncated) return;
  double charge[kMaxCosts];
  if (terminated && terminal_cost_) charge_fall(env, discount, r.cost + at * costs, charge);
  episodes_.finish(env, terminated, terminated && terminal_cost_ ? charge : nullptr);
  noise_.end_episode(env);
}

void PolicyGradient::record(const Transition& t) {
  const FpMode mode;
  if (missing() == 0) fail(Code::kState, "record: the horizon is full, update is due");
  if (!pending_) fail(Code::kState, "record: no sampled act came before");
  check_transition(t);
  value_truncated(t);
  for (int32_t env = 0; env < plan_.config.num_envs; ++env) record_row(t, env);
  if (rollout_.filled == 0) std::memcpy(old_log_std_, log_std_, plan_.action_dim() * sizeof(float));
  ++rollout_.filled;
  pending_ = false;
}

}  // namespace rdm

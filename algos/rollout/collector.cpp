#include "algos/rollout/collector.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "algos/core/option_tables.hpp"
#include "algos/rollout/sequences.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "nn/kernels.hpp"

namespace rdm {
namespace {

constexpr auto kMaxFloat = static_cast<double>(std::numeric_limits<float>::max());

// One sum for all: 0 times a number that is not finite is NaN, and NaN stays in the sum.
bool all_finite(const float* x, size_t count) {
  float sum = 0;
  for (size_t j = 0; j < count; ++j) sum += x[j] * 0.0f;
  return sum == 0;
}

bool flag(const uint8_t* flags, size_t i, bool none) {
  return flags ? flags[i] != 0 : none;
}

}  // namespace

void check_rows(const char* name, const float* x, const uint8_t* mask, int32_t rows, size_t dim) {
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    if (flag(mask, i, true) && !all_finite(x + i * dim, dim))
      fail(Code::kArgument, "%s: row %zu is not finite", name, i);
}

void check_costs(const char* name, const float* x, int32_t rows, int32_t columns) {
  check_rows(name, x, nullptr, rows, static_cast<size_t>(columns));
  const size_t count = static_cast<size_t>(rows) * static_cast<size_t>(columns);
  for (size_t i = 0; i < count; ++i)
    if (x[i] < 0)
      fail(Code::kArgument, "%s: row %zu, column %zu is %g, but it must be 0 or more", name,
           i / static_cast<size_t>(columns), i % static_cast<size_t>(columns), static_cast<double>(x[i]));
}

void Collector::check_flags(const char* name, const uint8_t* flags) const {
  for (size_t i = 0; flags && i < resolved_->num_envs(); ++i)
    if (flags[i] > 1)
      fail(Code::kArgument, "%s: row %zu is %d, neither 0 nor 1", name, i, static_cast<int>(flags[i]));
}

void Collector::carve(Arena& arena, const ResolvedAgentConfig& resolved) {
  rollout_ = carve_rollout(arena, resolved);
  normalizer_ = carve_normalizer(arena, resolved.config.obs_dim);
  reward_scale_ = carve_normalizer(arena, 1);
  cost_scale_ = carve_normalizer(arena, resolved.config.cost_dim);
  scaled_reward_ = arena.make<float>(resolved.num_envs());
  scaled_cost_ = arena.make<float>(resolved.num_envs() * static_cast<size_t>(resolved.config.cost_dim));
  noise_.carve(arena, resolved);
  memory_.carve(arena, resolved);
  if (resolved.shared.normalize_obs) usual_.carve(arena, resolved.num_envs());
  episodes_.carve(
      arena, resolved.config.num_envs, resolved.config.cost_dim,
      kWindowRows.known_to(resolved.options) ? kWindowRows.read(resolved.options).window : kStatsWindow,
      resolved.config.ranks.count);
  const auto blocks = static_cast<size_t>(resolved.blocks);
  const auto widest = std::max(resolved.obs_dim(), static_cast<size_t>(resolved.config.cost_dim));
  moments_step_ = 1 + 2 * widest;
  if (resolved.blocks > 1 || resolved.config.ranks.count > 1)
    moments_ = arena.make<double>(blocks * moments_step_);
  block_rows_ = arena.make<int32_t>(blocks * static_cast<size_t>(resolved.config.ranks.count));
  segments_ = arena.make<Segment>(blocks);
  part_ = arena.make<Segment>(blocks);
  std_ = arena.make<float>(resolved.state_std() ? 0 : resolved.action_dim());
  const size_t finals = resolved.num_envs() * static_cast<size_t>(resolved.num_critics());
  final_value_ = arena.make<float>(finals);
  final_cost_ = arena.make<float>(finals * static_cast<size_t>(resolved.num_limited));
  listed_ = arena.make<int32_t>(resolved.num_envs());
  epoch_cost_ = arena.make<double>(resolved.num_envs() * static_cast<size_t>(resolved.config.cost_dim));
  epoch_steps_ = arena.make<double>(resolved.num_envs());
}

void Collector::open(const ResolvedAgentConfig& resolved, const Networks& nets, BatchWorkers& workers) {
  resolved_ = &resolved;
  nets_ = &nets;
  workers_ = &workers;
  noise_.reset(resolved.config.seed, resolved.config.ranks.rank * resolved.config.num_envs);
  memory_.open(resolved, rollout_);
  normalizer_.clip = static_cast<float>(shared().obs_clip);
}

void Collector::drop() {
  rollout_.filled = 0;
  pending_ = false;
  if (normalizes()) usual_.drop();
  std::fill_n(epoch_cost_, resolved_->num_envs() * static_cast<size_t>(resolved_->config.cost_dim), 0.0);
  std::fill_n(epoch_steps_, resolved_->num_envs(), 0.0);
  invalid_ = cut_ = 0;
  std::fill_n(status_, EpochTotals::kStatusKinds, int64_t{0});
}

void Collector::forget(bool by_mean, const uint8_t* mask) {
  if (!memory_) return;
  if (!by_mean && pending_)
    fail(Code::kState, "forget: the actions that were sampled last have not been recorded");
  memory_.forget(by_mean, mask);
}

const float* Collector::normalized(const float* obs, int32_t rows, float* memory) const {
  if (!normalizes()) return obs;
  normalizer_apply(normalizer_, obs, rows, memory);
  return memory;
}

Novelty Collector::novelty(const float* row) const {
  return novelty_of({row, normalizer_.shift, normalizer_.scale, nets_->columns[Networks::kActor], true},
                    nets_->row_entries());
}

void Collector::measure_usual(const float* obs, int32_t rows) {
  if (!normalizes()) return;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) usual_.count(novelty(obs + i * rollout_.obs_dim));
  usual_.close_alone();
}

void Collector::values(const Workspace& workspace, const float* x, int32_t rows, float* value,
                       float* cost_value) const {
  nets_->forward(Networks::kReward, x, rows, workspace.critic, value);
  if (nets_->count > Networks::kCost) nets_->forward(Networks::kCost, x, rows, workspace.critic, cost_value);
}

void Collector::split_head(const float* y, int32_t rows, float* mean, float* log_std) const {
  const size_t dim = rollout_.action_dim;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i, y += 2 * dim) {
    std::memcpy(mean + i * dim, y, dim * sizeof(float));
    if (log_std) std::memcpy(log_std + i * dim, y + dim, dim * sizeof(float));
  }
}

void Collector::mean_rows(const Workspace& workspace, const float* obs, const PointRows& clouds,
                          int32_t first, int32_t rows, float* action) {
  float* y = nets_->state_std() ? workspace.out : action;
  const float* x = normalized(obs, rows, workspace.obs);
  if (nets_->gru.units) {
    nets_->forward_kept_memory(x, {1, rows, memory_.state(first, true)}, workspace.actor, y);
    memory_.keep_next(first, rows, true, workspace.actor.memory.h);
  } else {
    nets_->forward_kept(stacked(workspace, x, first, rows, true), clouds, rows, workspace.actor, y);
    if (memory_) memory_.push_mean(normalized(obs, rows, workspace.obs), first, rows);
  }
  if (y != action) split_head(y, rows, action, nullptr);
  squash(nets_->squash, action, static_cast<size_t>(rows) * rollout_.action_dim);
}

PointRows Collector::keep_points(const PointRows& clouds, size_t at, int32_t rows) const {
  const Rollout& r = rollout_;
  if (!r.points) return clouds;
  const auto count = static_cast<size_t>(rows) * r.row_points;
  PointRows kept;
  kept.points = r.points + at * r.row_points * 3;
  quantize_points(nets_->eyes, clouds.metres, count, r.points + at * r.row_points * 3);
  if (r.point_class) {
    kept.classes = r.point_class + at * r.row_points;
    std::memcpy(r.point_class + at * r.row_points, clouds.classes, count);
  }
  if (r.point_color) {
    kept.colors = r.point_color + at * r.row_points * 3;
    std::memcpy(r.point_color + at * r.row_points * 3, clouds.colors, 3 * count);
  }
  return kept;
}

void Collector::act_rows(const Workspace& workspace, const float* obs, const PointRows& clouds, int32_t first,
                         int32_t rows, float* action, const float* given) {
  Rollout& r = rollout_;
  const size_t at = r.row(r.filled) + static_cast<size_t>(first), dim = r.action_dim;
  float* const kept = r.obs + at * r.obs_dim;
  const float* x = normalized(obs, rows, r.replayed ? workspace.obs : kept);
  if (r.replayed || x != kept) std::memcpy(kept, obs, static_cast<size_t>(rows) * r.obs_dim * sizeof(float));
  if (!r.replayed) x = kept;
  float *mean = r.mean + at * dim, *y = nets_->state_std() ? workspace.out : mean;
  const float* seen = stacked(workspace, x, first, rows, false);
  if (nets_->gru.units) {
    nets_->forward_memory(x, {1, rows, memory_.state(first, false)}, workspace.actor, y);
    memory_.keep_next(first, rows, false, workspace.actor.memory.h);
  } else {
    nets_->forward_actor(seen, keep_points(clouds, at, rows), rows, workspace.actor, y);
  }
  for (size_t i = 0; r.features && i < static_cast<size_t>(rows); ++i)
    std::memcpy(r.features + (at + i) * r.row_features,
                nets_->features(workspace.actor) + i * nets_->feature_step(), r.row_features * sizeof(float));
  if (y != mean) split_head(y, rows, mean, r.log_std_of(at));
  if (!r.replayed)
    values(workspace, seen, rows, r.value + at * r.critics,
           r.cost_value + at * r.critics * static_cast<size_t>(r.num_costs));
  float own_std[kMaxActions];
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) {
    float* centered = r.action + (at + i) * dim;
    const float *log_std = r.log_std_of(at + i), *std = std_;
    if (nets_->state_std()) kernels().map_exp(log_std, dim, own_std), std = own_std;
    const int32_t env = first + static_cast<int32_t>(i);
    if (normalizes()) usual_.see(static_cast<size_t>(env), novelty(obs + i * r.obs_dim));
    if (r.replayed) {
      decide_replayed(env, mean + i * dim, std, given ? given + i * dim : nullptr,
                      action ? action + i * dim : nullptr, centered);
      continue;
    }
    if (given)
      noise_.take(env, mean + i * dim, given + i * dim, centered);
    else
      noise_.sample(env, mean + i * dim, std, action + i * dim, centered);
    keep_log_prob(r, at + i, mean + i * dim, log_std);
  }
}

// The action of one row, or the one that was given, and what is kept of it: what the worlds make of it.
void Collector::decide_replayed(int32_t env, const float* mean, const float* std, const float* given,
                                float* action, float* kept) {
  const size_t dim = rollout_.action_dim;
  if (given) {
    std::copy_n(given, dim, kept);
  } else if (uniform_) {
    noise_.uniform(env, action);
    std::copy_n(action, dim, kept);
  } else {
    float center[kMaxActions];
    std::copy_n(mean, dim, center);
    if (nets_->squash == Squash::kMean) squash(nets_->squash, center, dim);
    noise_.sample(env, center, std, action, kept);
    if (nets_->squash == Squash::kSample) squash(nets_->squash, action, dim);
    std::copy_n(action, dim, kept);
  }
  for (size_t j = 0; j < dim; ++j) kept[j] = std::clamp(kept[j], -1.0f, 1.0f);
}

void Collector::check_clouds(const PointRows& clouds) const {
  const PointNetShape& eyes = nets_->eyes;
  if (!eyes.points) {
    if (clouds) fail(Code::kState, "points: the agent has no encoder, so it cannot read them");
    return;
  }
  if (!clouds.metres) fail(Code::kState, "act: the agent's encoder needs points; call rdm_agent_act_points");
  need_channels(eyes, clouds, static_cast<size_t>(rollout_.num_envs));
  check_rows("points", clouds.metres, nullptr, rollout_.num_envs, eyes.row_points());
}

// A row's result does not depend on its batch, so the cut may follow the number of workers.
int32_t Collector::share(int32_t rows) const {
  return std::min((rows + workers_->count() - 1) / workers_->count(), resolved_->chunk_rows);
}

void Collector::need_turn(const char* call) const {
  if (pending_) fail(Code::kState, "%s: the actions that were sampled last have not been recorded", call);
  if (missing() == 0) fail(Code::kState, "%s: the horizon is full; call rdm_agent_update first", call);
}

void Collector::act(const float* obs, bool sample, float* action, const PointRows& clouds) {
  if (sample) need_turn("act");
  const int32_t envs = rollout_.num_envs;
  check_rows("obs", obs, nullptr, envs, rollout_.obs_dim);
  check_clouds(clouds);
  if (sample) return decide(obs, clouds, action, nullptr);
  workers_->sweep(envs, share(envs), [&](const Workspace& workspace, int32_t first, int32_t rows) {
    const auto at = static_cast<size_t>(first);
    mean_rows(workspace, obs + at * rollout_.obs_dim, clouds.from(nets_->eyes, at), first, rows,
              action + at * rollout_.action_dim);
  });
}

void Collector::decide(const float* obs, const PointRows& clouds, float* action, const float* given) {
  if (normalizes() && !nets_->adapts() &&
      !(shared().obs_freeze > 0 && normalizer_.count >= shared().obs_freeze))
    merge(normalizer_, obs, nullptr, shared().obs_count_max);
  for (size_t j = 0; !nets_->state_std() && j < rollout_.action_dim; ++j) {
    rollout_.log_std[j] = nets_->log_std()[j] + resolved_->log_share;
    std_[j] = static_cast<float>(elementary::exp(static_cast<double>(rollout_.log_std[j])));
  }
  if (memory_) memory_.begin_decision();
  const int32_t envs = rollout_.num_envs;
  workers_->sweep(envs, share(envs), [&](const Workspace& workspace, int32_t first, int32_t rows) {
    const auto at = static_cast<size_t>(first), dim = rollout_.action_dim;
    act_rows(workspace, obs + at * rollout_.obs_dim, clouds.from(nets_->eyes, at), first, rows,
             action ? action + at * dim : nullptr, given ? given + at * dim : nullptr);
  });
  pending_ = true;
}

void Collector::check_actions(const float* action) const {
  const size_t dim = rollout_.action_dim;
  for (size_t i = 0; i < resolved_->num_envs() * dim; ++i)
    if (!(std::abs(action[i]) <= Noise::kMaxAction))
      fail(Code::kRange, "action: row %zu, entry %zu is %g, which is outside [%g, %g]", i / dim, i % dim,
           static_cast<double>(action[i]), static_cast<double>(-Noise::kMaxAction),
           static_cast<double>(Noise::kMaxAction));
}

void Collector::put(const float* obs, const float* action, const Transition& t) {
  need_turn("put");
  if (nets_->eyes.points)
    fail(Code::kUnsupported, "put: the agent's encoder needs points, which put does not take");
  check_rows("obs", obs, nullptr, rollout_.num_envs, rollout_.obs_dim);
  check_actions(action);
  check(t);
  decide(obs, {}, nullptr, action);
  follow(t);
}

void Collector::replace(int32_t env, const float* action) {
  Rollout& r = rollout_;
  const size_t at = r.row(r.filled) + static_cast<size_t>(env), dim = r.action_dim;
  const float* mean = r.mean + at * dim;
  if (r.replayed) {
    for (size_t j = 0; j < dim; ++j) r.action[at * dim + j] = std::clamp(action[j], -1.0f, 1.0f);
    return;
  }
  noise_.replace(env, mean, action, r.action + at * dim);
  keep_log_prob(r, at, mean, r.log_std_of(at));
}

void Collector::foresee(const int32_t* env, const float* obs, int32_t rows, float* state, Stream* noise,
                        float* offset, float* action) const {
  const size_t width = rollout_.obs_dim, dim = rollout_.action_dim;
  workers_->sweep(rows, share(rows), [&](const Workspace& workspace, int32_t first, int32_t n) {
    const auto at = static_cast<size_t>(first);
    const float* x = normalized(obs + at * width, n, workspace.obs);
    float *out = action + at * dim, *y = nets_->state_std() ? workspace.out : out;
    // The network that samples, not its average.
    float* const states = memory_ ? state + at * memory_.dim() : nullptr;
    if (nets_->gru.units) {
      nets_->forward_memory(x, {1, n, states}, workspace.actor, y);
      std::copy_n(workspace.actor.memory.h, static_cast<size_t>(n) * memory_.dim(), states);
    } else if (memory_) {
      memory_.stack_on(x, states, n, workspace.obs);
      nets_->forward_actor(workspace.obs, {}, n, workspace.actor, y);
      memory_.push_rows(states, workspace.obs, n);
    } else {
      nets_->forward_actor(x, {}, n, workspace.actor, y);
    }
    float log_std[kMaxActions], own_std[kMaxActions];
    for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
      float* mean = out + i * dim;
      if (y != out) split_head(y + 2 * i * dim, 1, mean, log_std);
      if (!noise || nets_->squash == Squash::kMean) squash(nets_->squash, mean, dim);
      if (!noise) continue;
      const float* std = std_;
      if (y != out) kernels().map_exp(log_std, dim, own_std), std = own_std;
      const auto e = static_cast<size_t>(env[at + i]);
      if (uniform_)
        Noise::foresee_uniform(&noise[e], mean, static_cast<int32_t>(dim));
      else
        noise_.foresee(mean, std, &noise[e], offset + e * dim, mean);
      if (!uniform_ && nets_->squash == Squash::kSample) squash(nets_->squash, mean, dim);
    }
  });
}

void Collector::see(const float* obs, int32_t rows, float* state) const {
  const size_t dim = resolved_->obs_dim();
  workers_->sweep(rows, share(rows), [&](const Workspace& workspace, int32_t first, int32_t n) {
    const auto at = static_cast<size_t>(first);
    float* const states = state + at * memory_.dim();
    memory_.stack_on(normalized(obs + at * dim, n, workspace.obs), states, n, workspace.obs);
    memory_.push_rows(states, workspace.obs, n);
  });
}

void Collector::value_rows(const float* obs, const float* state, int32_t rows, float* value,
                           float* cost_value) const {
  if (rows < 1) return;
  const size_t dim = resolved_->obs_dim(), costs = static_cast<size_t>(resolved_->num_limited);
  workers_->sweep(rows, share(rows), [&](const Workspace& workspace, int32_t first, int32_t n) {
    const auto at = static_cast<size_t>(first);
    const float* x = normalized(obs + at * dim, n, workspace.obs);
    if (memory_.stacks()) {
      memory_.stack_on(x, state + at * memory_.dim(), n, workspace.obs);
      x = workspace.obs;
    }
    const size_t critics = rollout_.critics;
    if (critics == 1) return values(workspace, x, n, value + at, cost_value + at * costs);
    values(workspace, x, n, workspace.out, workspace.dout);
    const auto mean = [&](const float* of, size_t width, float* to) {
      for (size_t i = 0; i < static_cast<size_t>(n) * width; ++i) {
        double sum = 0;
        for (size_t v = 0; v < critics; ++v)
          sum += static_cast<double>(of[i / width * critics * width + v * width + i % width]);
        to[i] = static_cast<float>(sum / static_cast<double>(critics));
      }
    };
    mean(workspace.out, 1, value + at);
    if (nets_->count > Networks::kCost) mean(workspace.dout, costs, cost_value + at * costs);
  });
}

void Collector::check(const Transition& t) const {
  const AgentConfig& c = resolved_->config;
  if (!t.reward) fail(Code::kArgument, "reward is NULL");
  if (!t.cost && c.cost_dim > 0) fail(Code::kArgument, "cost is NULL with cost_dim %d", c.cost_dim);
  check_flags("terminated", t.terminated);
  check_flags("truncated", t.truncated);
  check_flags("valid", t.valid);
  check_flags("success", t.success);
  check_rows("reward", t.reward, t.valid, c.num_envs, 1);
  check_costs("cost", t.cost, c.num_envs, c.cost_dim);
  if (t.limit) {
    check_costs("limit", t.limit, c.num_envs, 1);
    if (resolved_->rate_steps > 0)
      fail(Code::kState, "limit: option cost_limit_per_step limits column 0 for every episode alike");
  }
  for (size_t i = 0; i < resolved_->num_envs(); ++i) {
    if (t.steps && t.steps[i] < 0)
      fail(Code::kRange, "steps: row %zu is %d, which is outside the bounds", i, t.steps[i]);
    if (!flag(t.valid, i, true)) continue;
    if (t.final_obs && flag(t.truncated, i, false) &&
        !all_finite(t.final_obs + i * resolved_->obs_dim(), resolved_->obs_dim()))
      fail(Code::kArgument, "final_obs: row %zu is not finite", i);
  }
}

// V of the final observations of paths that a time limit cut, a chunk at a time.
void Collector::value_truncated(const Transition& t) {
  const size_t critics = rollout_.critics, dim = resolved_->obs_dim();
  const size_t costs = critics * static_cast<size_t>(resolved_->num_limited);
  std::memset(final_value_, 0, resolved_->num_envs() * critics * sizeof(float));
  std::memset(final_cost_, 0, resolved_->num_envs() * costs * sizeof(float));
  if (rollout_.replayed || !t.truncated || !t.final_obs) return;
  int32_t count = 0;
  for (size_t i = 0; i < resolved_->num_envs(); ++i)
    if (t.truncated[i] && !flag(t.terminated, i, false) && flag(t.valid, i, true))
      listed_[count++] = static_cast<int32_t>(i);
  const Workspace& workspace = (*workers_)[0];
  for (int32_t first = 0; first < count; first += workspace.rows) {
    const int32_t rows = std::min(workspace.rows, count - first);
    const int32_t* env = listed_ + first;
    for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
      std::memcpy(workspace.obs + i * dim, t.final_obs + static_cast<size_t>(env[i]) * dim,
                  dim * sizeof(float));
    const float* x = normalized(workspace.obs, rows, workspace.obs);
    if (memory_ && memory_.stacks()) memory_.stack_after(x, env, rows, workspace.obs);
    values(workspace, x, rows, workspace.out, workspace.dout);
    for (size_t i = 0; i < static_cast<size_t>(rows); ++i) {
      std::memcpy(final_value_ + static_cast<size_t>(env[i]) * critics, workspace.out + i * critics,
                  critics * sizeof(float));
      if (resolved_->values_costs)
        std::memcpy(final_cost_ + static_cast<size_t>(env[i]) * costs, workspace.dout + i * costs,
                    costs * sizeof(float));
    }
  }
}

// A fall ends the costs of an episode early, which is not safe behaviour. The missing steps are therefore charged at
// the episode's mean cost per step: in full in the episode's sum (charge [cost_dim]), discounted in the sample.
void Collector::charge_fall(int32_t env, float discount, float* sample_cost, double* charge) const {
  const int64_t length = episodes_.length(env), left = resolved_->episode_steps - length;
  for (int32_t k = 0; k < resolved_->config.cost_dim; ++k) charge[k] = 0;
  if (left <= 0 || length == 0) return;
  const auto steps = static_cast<double>(left);
  for (int32_t k = 0; k < resolved_->config.cost_dim; ++k)
    charge[k] = episodes_.cost(env, k) / static_cast<double>(length) * steps;
  const double tail = shared().discount < 1
                          ? (1 - elementary::pow(shared().discount, left)) / (1 - shared().discount)
                          : steps;
  for (int32_t i = 0; i < resolved_->num_limited; ++i) {
    const int32_t k = resolved_->column[i];
    const float scale = shared().normalize_cost ? cost_scale_.scale[k] : 1;
    sample_cost[i] += discount * scale * static_cast<float>(charge[k] / steps * tail);
  }
  if (!shared().discounted_limit) return;
  const double share = elementary::pow(shared().discount, length) * tail / steps;
  for (int32_t k = 0; k < resolved_->config.cost_dim; ++k) charge[k] *= share;
}

// Statistics first, then the samples: as for observations.
void Collector::scale_rewards(const Transition& t) {
  const int32_t envs = rollout_.num_envs;
  reward_ = t.reward, cost_ = t.cost;
  if (shared().normalize_reward) {
    merge(reward_scale_, t.reward, t.valid, 0);
    normalizer_apply(reward_scale_, t.reward, envs, scaled_reward_);
    reward_ = scaled_reward_;
  }
  if (const auto factor = static_cast<float>(shared().reward_factor); factor != 1) {
    for (int32_t i = 0; i < envs; ++i) scaled_reward_[i] = factor * reward_[i];
    reward_ = scaled_reward_;
  }
  if (shared().normalize_cost && resolved_->config.cost_dim > 0) {
    merge(cost_scale_, t.cost, t.valid, 0);
    normalizer_apply(cost_scale_, t.cost, envs, scaled_cost_);
    cost_ = scaled_cost_;
  }
}

// An invalid row that begins an episode and does not end it: it only resets.
bool Collector::resets(const Transition& t, int32_t env) const {
  const auto e = static_cast<size_t>(env);
  const bool over = flag(t.terminated, e, false) || flag(t.truncated, e, false);
  return !flag(t.valid, e, true) && !over && episodes_.length(env) == 0;
}

// What statistics and limits count of a row: everything of a valid one. Of an invalid row only the cost counts, and
// its time and success unless the row is a mere reset (the first row of an episode, which does not end it).
void Collector::count_row(const Transition& t, int32_t env, const float* cost, int32_t steps) {
  const auto e = static_cast<size_t>(env), columns = static_cast<size_t>(resolved_->config.cost_dim);
  const bool valid = flag(t.valid, e, true), resets = this->resets(t, env);
  const int32_t taken = resets ? 0 : steps;
  const double weight =
      shared().discounted_limit ? elementary::pow(shared().discount, episodes_.length(env)) : 1;
  episodes_.add(env, valid ? static_cast<double>(t.reward[e]) : 0, cost, taken,
                !resets && flag(t.success, e, false), weight);
  own_steps_ += taken;
  epoch_steps_[e] += taken;
  for (size_t k = 0; k < columns; ++k) epoch_cost_[e * columns + k] += static_cast<double>(cost[k]);
  if (!valid && !resets) ++invalid_;
  for (int32_t bit = 0; t.status && bit < EpochTotals::kStatusKinds; ++bit)
    if (t.status[e] >> bit & 1) ++status_[bit];
}

// Ends the episode where the row ended it. Where an episode has reached episode_steps without an end, only its sums
// are closed: its path continues for the advantages.
void Collector::end_row(const Transition& t, int32_t env, float discount, float* sample_cost) {
  const auto e = static_cast<size_t>(env);
  const bool terminated = flag(t.terminated, e, false);
  double charge[kMaxCosts] = {};
  // An episode with a limit of its own: what its sum is beyond that it is beyond the agent's.
  const double own = t.limit && limits_first() ? resolved_->limit[0] - static_cast<double>(t.limit[e]) : 0;
  if (!terminated && !flag(t.truncated, e, false)) {
    if (resolved_->episode_steps == 0 || episodes_.length(env) < resolved_->episode_steps) return;
    ++cut_;
    charge[0] = own;
    return episodes_.finish(env, false, charge);
  }
  if (terminated && shared().terminal_cost) charge_fall(env, discount, sample_cost, charge);
  charge[0] += own;
  episodes_.finish(env, terminated, charge);
  noise_.end_episode(env);
}

void Collector::record_row(const Transition& t, int32_t env) {
  Rollout& r = rollout_;
  const auto e = static_cast<size_t>(env), costs = static_cast<size_t>(r.num_costs);
  const size_t at = r.row(r.filled) + e;
  const size_t first = e * static_cast<size_t>(resolved_->config.cost_dim);
  const float *cost = t.cost ? t.cost + first : nullptr, *learned = t.cost ? cost_ + first : nullptr;
  const int32_t steps = t.steps ? t.steps[e] : shared().action_repeat;
  const auto discount = static_cast<float>(elementary::pow(shared().discount, steps));
  const size_t critics = r.critics;
  float *limited = r.cost + at * critics * costs, *reward = r.reward + at * critics;
  if (memory_ && (flag(t.terminated, e, false) || flag(t.truncated, e, false) || resets(t, env)))
    memory_.clear(env);
  count_row(t, env, cost, steps);
  r.valid[at] = flag(t.valid, e, true);
  if (r.valid[at]) {
    if (normalizes()) usual_.count(e);
    const bool over = flag(t.terminated, e, false) || flag(t.truncated, e, false);
    for (size_t v = 0; v < critics; ++v) {
      reward[v] = reward_[e] + discount * final_value_[e * critics + v];
      for (size_t i = 0, k = v * costs; i < costs; ++i, ++k)
        limited[k] = learned[resolved_->column[i]] + discount * final_cost_[e * critics * costs + k];
    }
    r.discount[at] = over ? 0 : discount;
    if (r.replayed && (r.over[at] = over)) keep_final(t, env, at, discount);
  }
  float fall[kMaxCosts] = {};
  end_row(t, env, discount, fall);
  for (size_t k = 0; k < critics * costs; ++k) limited[k] += fall[k % costs];
  for (size_t i = 0; !resolved_->values_costs && i < costs; ++i) reward[0] -= charge_[i] * limited[i];
  if (r.valid[at]) return;
  std::fill_n(reward, critics, 0.0f);
  r.discount[at] = 0;
  std::fill_n(limited, critics * costs, 0.0f);
  noise_.end_episode(env);
}

// Of the row that an episode ended with: a time limit is no end of what follows, if that was seen.
void Collector::keep_final(const Transition& t, int32_t env, size_t at, float discount) {
  const auto e = static_cast<size_t>(env);
  if (!flag(t.truncated, e, false) || flag(t.terminated, e, false) || !t.final_obs) return;
  const size_t dim = rollout_.obs_dim;
  std::copy_n(t.final_obs + e * dim, dim, rollout_.final_obs + at * dim);
  rollout_.discount[at] = discount;
}

void Collector::record(const Transition& t) {
  if (missing() == 0) fail(Code::kState, "record: the horizon is full; call rdm_agent_update first");
  if (!pending_)
    fail(Code::kState, "record: no sampled action came before; call rdm_agent_act with RDM_ACT_SAMPLE first");
  check(t);
  follow(t);
}

void Collector::follow(const Transition& t) {
  value_truncated(t);
  scale_rewards(t);
  episodes_.tick();
  if (memory_) memory_.advance();
  for (int32_t env = 0; env < rollout_.num_envs; ++env) record_row(t, env);
  ++rollout_.filled;
  pending_ = false;
}

// Rows of all ranks: moments of each block, in the tree.
void Collector::merge(Normalizer& n, const float* x, const uint8_t* mask, double count_max) {
  Ranks& ranks = workers_->ranks();
  if (!moments_) return normalizer_merge(n, x, rollout_.num_envs, mask, count_max);
  const auto envs = static_cast<size_t>(ranks.block_envs()), dim = static_cast<size_t>(n.dim);
  const auto node = [&](int32_t b) { return moments_ + static_cast<size_t>(b) * moments_step_; };
  workers_->spread(ranks.blocks(), [&](int32_t b) {
    const size_t first = static_cast<size_t>(b) * envs;
    normalizer_moments(n.dim, x + first * dim, ranks.block_envs(), mask ? mask + first : nullptr, node(b));
  });
  const auto add = [&](double* a, const double* b) { normalizer_add_moments(n.dim, a, b); };
  Ranks::tree(ranks.blocks(), [&](int32_t a, int32_t b) { add(node(a), node(b)); });
  ranks.fold(moments_, 1 + 2 * dim, add);
  normalizer_merge_moments(n, moments_, count_max);
}

void Collector::settle() {
  env_steps_ += workers_->ranks().total(own_steps_);
  own_steps_ = 0;
  episodes_.settle(workers_->ranks());
}

EpochTotals Collector::totals() const {
  constexpr size_t kCosts = kMaxCosts, kSteps = kCosts, kRunning = kCosts + 1, kInvalid = kCosts + 2;
  constexpr size_t kCut = kInvalid + 1, kStatus = kCut + 1;
  Ranks& ranks = workers_->ranks();
  const auto columns = static_cast<size_t>(resolved_->config.cost_dim);
  const int32_t envs = ranks.block_envs();
  const auto sums = ranks.sum<kStatus + EpochTotals::kStatusKinds>([&](int32_t b, double* out) {
    std::fill_n(out, kStatus + EpochTotals::kStatusKinds, 0.0);
    for (int32_t env = b * envs; env < (b + 1) * envs; ++env) {
      const auto e = static_cast<size_t>(env);
      for (size_t k = 0; k < columns; ++k) out[k] += epoch_cost_[e * columns + k];
      out[kSteps] += epoch_steps_[e];
      out[kRunning] += static_cast<double>(episodes_.length(env));
    }
    if (b > 0) return;  // counts are for the whole rank, so they are added once, with its first block
    out[kInvalid] = static_cast<double>(invalid_);
    out[kCut] = static_cast<double>(cut_);
    for (size_t i = 0; i < EpochTotals::kStatusKinds; ++i) out[kStatus + i] = static_cast<double>(status_[i]);
  });
  EpochTotals t;
  std::copy_n(sums.begin(), kCosts, t.cost);
  t.steps = sums[kSteps];
  t.running = sums[kRunning] / resolved_->all_envs();
  t.invalid = static_cast<int64_t>(sums[kInvalid]);
  t.cut = static_cast<int64_t>(sums[kCut]);
  for (size_t i = 0; i < EpochTotals::kStatusKinds; ++i)
    t.status[i] = static_cast<int64_t>(sums[kStatus + i]);
  return t;
}

Batch Collector::minibatch(int32_t i, int32_t parts) const {
  const Ranks& ranks = workers_->ranks();
  const auto part = [&](int32_t rows) {
    int64_t size = (rows + parts - 1) / parts;
    if (rollout_.path) size = (size + rollout_.path - 1) / rollout_.path * rollout_.path;  // whole sequences
    const int64_t first = std::min<int64_t>(i * size, rows);
    return Segment{static_cast<int32_t>(first), static_cast<int32_t>(std::min<int64_t>(size, rows - first))};
  };
  Batch batch = listed_rows_;
  batch.rows = 0;
  for (int32_t b = 0; b < ranks.blocks() * ranks.count(); ++b) batch.rows += part(block_rows_[b]).rows;
  for (int32_t b = 0; b < ranks.blocks(); ++b) {
    part_[b] = part(segments_[b].rows);
    part_[b].first += segments_[b].first;
  }
  batch.segments = part_;
  return batch;
}

double Collector::mean_value(bool of_cost) const {
  const Rollout& r = rollout_;
  const auto critics = static_cast<int32_t>(r.critics);
  const int32_t step = of_cost ? r.num_costs : 1;
  double sum = 0;
  for (int32_t v = 0; v < critics; ++v)
    sum += masked_mean(r.rows(), (of_cost ? r.cost_value : r.value) + v * step, critics * step,
                       workers_->ranks());
  return sum / critics;
}

void Collector::begin_estimate(const float* last_obs) {
  const Rollout& r = rollout_;
  column_ = -resolved_->num_critics();
  if (r.replayed) return;
  workers_->sweep(
      r.num_envs, resolved_->chunk_rows, [&](const Workspace& workspace, int32_t first, int32_t rows) {
        const auto at = static_cast<size_t>(first);
        const float* x = normalized(last_obs + at * r.obs_dim, rows, workspace.obs);
        values(workspace, stacked(workspace, x, first, rows, false), rows, r.last_value + at * r.critics,
               r.last_cost_value + at * r.critics * static_cast<size_t>(r.num_costs));
      });
}

bool Collector::estimate_on() {
  if (!rollout_.replayed &&
      column_ < (resolved_->values_costs ? resolved_->num_critics() * rollout_.num_costs : 0)) {
    const SharedOptions& o = shared();
    estimate_advantage(rollout_, column_++,
                       {o.lambda, o.cost_lambda, o.standardize_reward_adv, o.standardize_cost_adv},
                       workers_->ranks());
    return false;
  }
  list_rows();
  return true;
}

void Collector::list_rows() {
  const Rollout& r = rollout_;
  Ranks& ranks = workers_->ranks();
  const int32_t envs = ranks.block_envs();
  int32_t* const own = block_rows_ + ranks.first_block();
  for (int32_t b = 0, at = 0; b < ranks.blocks(); ++b, at += own[b - 1]) {
    if (r.path) restart_sequences(r, b * envs, envs);
    own[b] = r.path ? list_sequences(r, b * envs, envs, at, nullptr) : list_valid(r, b * envs, envs, at);
    segments_[b] = {at, own[b]};
  }
  ranks.gather(own, static_cast<size_t>(ranks.blocks()) * sizeof *own, block_rows_);
  listed_rows_ = Batch(r.order, 0);
  listed_rows_.blocks = ranks.blocks();
  listed_rows_.segments = segments_;
  listed_rows_.envs = r.num_envs, listed_rows_.path = r.path;
  for (int32_t b = 0; b < ranks.blocks() * ranks.count(); ++b) listed_rows_.rows += block_rows_[b];
}

void Collector::visit(StateIo& io) {
  io.section("COLL");
  io.counter(env_steps_);
  for (Normalizer* n : {&normalizer_, &reward_scale_, &cost_scale_}) {
    const auto dim = static_cast<size_t>(n->dim);
    // Means of floats, and squares of floats summed over as many as were counted.
    io.number(n->count, 0, 1e18);
    io.numbers(n->mean, dim, -kMaxFloat, kMaxFloat);
    io.numbers(n->m2, dim, 0, 1e100);
  }
  noise_.visit(io);
  episodes_.visit(io);
  usual_.visit(io);
  memory_.visit(io);
}

}  // namespace rdm

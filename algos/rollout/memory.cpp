#include "algos/rollout/memory.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "nn/policy.hpp"

namespace rdm {

void AgentMemory::carve(Arena& arena, const ResolvedAgentConfig& resolved) {
  dim_ = resolved.state_dim();
  const size_t envs = resolved.num_envs(), count = envs * dim_;
  state_ = arena.make<float>(count);
  mean_ = arena.make<float>(count);
  next_ = arena.make<float>(resolved.gru.units ? count : 0);
  age_ = arena.make<int32_t>(dim_ ? envs : 0);
}

void AgentMemory::push(float* state, const float* row) const {
  push_history(state, rollout_->depth, rollout_->width, row, rollout_->columns);
}

void AgentMemory::begin_decision() {
  const Rollout& r = *rollout_;
  const auto envs = static_cast<size_t>(r.num_envs);
  if (r.filled == 0) {
    std::fill_n(age_, envs, Rollout::kWholeMemory);
    if (r.before) std::copy_n(state_, envs * dim_, r.before);
  }
  std::copy_n(age_, envs, r.age + r.row(r.filled));
  if (r.path && r.filled % r.path == 0)
    std::copy_n(state_, envs * dim_, r.state + static_cast<size_t>(r.filled / r.path) * envs * dim_);
}

void AgentMemory::stack(const float* x, int32_t first, int32_t rows, bool by_mean, float* seen) const {
  stack_on(x, state(first, by_mean), rows, seen);
}

void AgentMemory::stack_on(const float* x, const float* states, int32_t rows, float* seen) const {
  const size_t dim = rollout_->obs_dim, width = rollout_->seen_dim();
  for (int32_t i = rows; i-- > 0;) {  // from the last row on: they may begin in the same place
    float* const to = seen + static_cast<size_t>(i) * width;
    std::memmove(to, x + static_cast<size_t>(i) * dim, dim * sizeof(float));
    std::memcpy(to + dim, states + static_cast<size_t>(i) * dim_, dim_ * sizeof(float));
  }
}

void AgentMemory::push_rows(float* states, const float* seen, int32_t rows) const {
  for (int32_t i = 0; i < rows; ++i)
    push(states + at(i), seen + static_cast<size_t>(i) * rollout_->seen_dim());
}

void AgentMemory::stack_after(const float* x, const int32_t* env, int32_t rows, float* seen) const {
  const Rollout& r = *rollout_;
  const size_t dim = r.obs_dim, width = r.seen_dim();
  for (int32_t i = rows; i-- > 0;) {
    float* const to = seen + static_cast<size_t>(i) * width;
    std::memmove(to, x + static_cast<size_t>(i) * dim, dim * sizeof(float));
    std::memcpy(to + dim, state(env[i], false), dim_ * sizeof(float));
    push(to + dim, r.obs + (r.row(r.filled) + static_cast<size_t>(env[i])) * dim);
  }
}

void AgentMemory::keep_next(int32_t first, int32_t rows, bool by_mean, const float* h) {
  std::copy_n(h, static_cast<size_t>(rows) * dim_, (by_mean ? mean_ : next_) + at(first));
}

void AgentMemory::push_mean(const float* x, int32_t first, int32_t rows) {
  for (int32_t i = 0; i < rows; ++i)
    push(mean_ + at(first + i), x + static_cast<size_t>(i) * rollout_->obs_dim);
}

void AgentMemory::advance() {
  const Rollout& r = *rollout_;
  const auto envs = static_cast<size_t>(r.num_envs);
  if (r.units) std::swap_ranges(state_, state_ + envs * dim_, next_);
  for (size_t e = 0; e < envs; ++e) {
    if (r.depth) push(state_ + e * dim_, r.obs + (r.row(r.filled) + e) * r.obs_dim);
    if (age_[e] < Rollout::kWholeMemory) ++age_[e];
  }
}

void AgentMemory::clear(int32_t env) {
  std::fill_n(state_ + at(env), dim_, 0.0f);
  age_[env] = 0;
}

void AgentMemory::forget(bool by_mean, const uint8_t* mask) {
  for (int32_t env = 0; env < rollout_->num_envs; ++env) {
    if (mask && !mask[env]) continue;
    if (by_mean)
      std::fill_n(mean_ + at(env), dim_, 0.0f);
    else
      clear(env);
  }
}

void AgentMemory::visit(StateIo& io) {
  if (dim_ == 0) return;
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  const double bound = resolved_->gru.units              ? 1
                       : resolved_->shared.normalize_obs ? resolved_->shared.obs_clip
                                                         : kMost;
  io.section("MEMO");
  for (float* x : {state_, mean_}) io.share(x, resolved_->num_envs() * dim_, -bound, bound);
}

}  // namespace rdm

#include "algos/rollout/noise.hpp"

#include <algorithm>

namespace rdm {
namespace {
// Above sigma |z| sqrt(1 - rho^2) / (1 - rho) for sigma <= 1e3 (std_max), |z| < 7 (Stream::normals) and
// rho <= 0.999.
constexpr double kMaxNoise = 1e6;
}  // namespace

void Noise::carve(Arena& arena, const ResolvedAgentConfig& resolved) {
  num_envs_ = resolved.config.num_envs;
  dim_ = resolved.config.action_dim;
  correlation_ = static_cast<float>(resolved.shared.noise_correlation);
  stream_ = arena.make<Stream>(resolved.num_envs());
  state_ = arena.make<float>(resolved.num_envs() * resolved.action_dim());
}

void Noise::reset(uint64_t seed, int32_t first) {
  for (int32_t env = 0; env < num_envs_; ++env)
    stream_[env] = Stream(seed, static_cast<uint32_t>(first + env), Purpose::kPolicyNoise);
}

void Noise::sample(int32_t env, const float* mean, const float* std, float* action, float* centered) {
  draw(mean, std, &stream_[env], state_of(env), action, centered);
}

void Noise::draw(const float* mean, const float* std, Stream* stream, float* state, float* action,
                 float* centered) const {
  stream->normals(centered, dim_);
  for (int32_t j = 0; j < dim_; ++j) {
    const float fresh = std[j] * centered[j], offset = correlation_ * state[j];
    centered[j] = mean[j] + fresh;
    state[j] = offset + fresh;
    action[j] = centered[j] + offset;
  }
}

void Noise::peek(int32_t env, Stream* stream, float* offset) const {
  *stream = stream_[env];
  std::copy_n(state_of(env), dim_, offset);
}

void Noise::foresee(const float* mean, const float* std, Stream* stream, float* offset, float* action) const {
  float centered[kMaxActions];
  draw(mean, std, stream, offset, action, centered);
}

// The offset that the other one was drawn with is what its own share leaves of the state.
void Noise::replace(int32_t env, const float* mean, const float* action, float* centered) {
  constexpr auto kMost = static_cast<float>(kMaxNoise);
  float* state = state_of(env);
  for (int32_t j = 0; j < dim_; ++j) {
    const float offset = state[j] - (centered[j] - mean[j]);
    centered[j] = action[j] - offset;
    state[j] = std::clamp(action[j] - mean[j], -kMost, kMost);
  }
}

void Noise::take(int32_t env, const float* mean, const float* action, float* centered) {
  constexpr auto kMost = static_cast<float>(kMaxNoise);
  float* state = state_of(env);
  for (int32_t j = 0; j < dim_; ++j) {
    centered[j] = action[j] - correlation_ * state[j];
    state[j] = std::clamp(action[j] - mean[j], -kMost, kMost);
  }
}

void Noise::end_episode(int32_t env) {
  float* state = state_of(env);
  for (int32_t j = 0; j < dim_; ++j) state[j] = 0;
}

void Noise::visit(StateIo& io) {
  io.section("NOIS");
  const auto n = static_cast<size_t>(num_envs_);
  io.share(stream_, n);
  io.share(state_, n * static_cast<size_t>(dim_), -kMaxNoise, kMaxNoise);
}

}  // namespace rdm

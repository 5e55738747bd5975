// Exploration noise that is correlated over decisions: n' = rho n + sqrt(1 - rho^2) sigma z.
//
// sigma is the stationary deviation, the one that a policy file keeps. Given the offset rho n, what is left
// of an action is a sample of N(mean, (1 - rho^2) sigma^2): that is the density that is learned from.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "algos/core/state_io.hpp"

namespace rdm {

class Noise {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved);
  // first: number of environment 0 among all ranks'.
  void reset(uint64_t seed, int32_t first = 0);
  // Draws for environment env: action = mean + noise, centered = action - offset. All [action_dim].
  // std: of the innovation.
  void sample(int32_t env, const float* mean, const float* std, float* action, float* centered);
  // Goes on from an action that was drawn elsewhere, within +-kMaxAction, by the same rule: centered likewise.
  void take(int32_t env, const float* mean, const float* action, float* centered);
  // In the place of an action that was just drawn or taken, whose `centered` this is: likewise.
  void replace(int32_t env, const float* mean, const float* action, float* centered);
  // What sample will draw next of copies of an environment's stream and offset [action_dim]; both go on.
  void peek(int32_t env, Stream* stream, float* offset) const;
  void foresee(const float* mean, const float* std, Stream* stream, float* offset, float* action) const;
  // Draws action [action_dim] uniformly in [-1, 1) instead; the noise stays where it is.
  void uniform(int32_t env, float* action) { foresee_uniform(&stream_[env], action, dim_); }
  static void foresee_uniform(Stream* stream, float* action, int32_t dim) {
    stream->signed_units(action, dim);
  }
  static constexpr float kMaxAction = 1e5f;
  void end_episode(int32_t env);
  float correlation() const { return correlation_; }
  void visit(StateIo& io);

 private:
  float* state_of(int32_t env) const { return state_ + static_cast<size_t>(env) * static_cast<size_t>(dim_); }
  void draw(const float* mean, const float* std, Stream* stream, float* state, float* action,
            float* centered) const;

  int32_t num_envs_ = 0, dim_ = 0;
  float correlation_ = 0;
  Stream* stream_ = nullptr;  // [num_envs]
  float* state_ = nullptr;    // [num_envs][dim]
};

}  // namespace rdm

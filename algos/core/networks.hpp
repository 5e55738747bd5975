// The parameters that an agent learns: log standard deviation, actor, reward critic, cost critic, one vector.
//
// With std_mode=state there is no such deviation: the actor's network gives, behind each row's means, its log
// deviations.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "algos/core/state_io.hpp"
#include "nn/adam.hpp"

namespace rdm {

// A block of the common vector with its own optimiser and gradient norm.
struct Block {
  size_t offset = 0, size = 0;
  Adam adam;
};

// Order: actor (log_std padded to 16 with zeros, then the network), reward critic, cost critic.
struct Networks {
  enum Index { kActor, kReward, kCost };
  MlpShape shape[3];
  const int32_t* columns[3] = {};  // [shape.in] entries of a row that the network sees; null: all
  int32_t obs_dim = 0;             // of a row
  Block block[3];
  int32_t count = 0;    // 2 without cost critic
  size_t size = 0;      // of params
  size_t std_size = 0;  // padded; 0 with std_mode=state
  int32_t action_dim = 0;
  float std_low = 0, std_high = 0;  // bounds on the log deviations that the network gives
  float log_share = 0;              // of the innovation in them
  double input_bound = 0;           // on the magnitude of inputs
  float* params = nullptr;
  // Option average: the actor's block as the mean over past epochs, of which the last ones count most; null:
  // none. It is what acts without noise and goes into policy files; it takes no part in learning.
  float* average = nullptr;
  double average_share = 0;     // of the average that the next epoch leaves, at most
  int64_t* averaged = nullptr;  // epochs in it; null: as average

  bool state_std() const { return std_size == 0; }
  float* log_std() const { return params; }
  size_t net_offset(int32_t i) const { return block[i].offset + (i == kActor ? std_size : 0); }
  float* net(int32_t i) const { return params + net_offset(i); }
  // The actor that others get to see: log deviations, then the network.
  const float* kept_log_std() const { return average ? average : params; }
  const float* kept_actor() const { return kept_log_std() + std_size; }
  // y = network i of the rows x [rows][obs_dim], and the gradient of its block, grad laid out as params; x
  // and scratch as in the forward pass before. The actor's log deviations are those of the innovation, within
  // their bounds.
  void forward(int32_t i, const float* x, int32_t rows, const MlpScratch& scratch, float* y) const {
    forward_with(net(i), i, x, rows, scratch, y);
  }
  // The same of the actor that others get to see.
  void forward_kept(const float* x, int32_t rows, const MlpScratch& scratch, float* y) const {
    forward_with(kept_actor(), kActor, x, rows, scratch, y);
  }
  void backward(int32_t i, const float* x, int32_t rows, const MlpScratch& scratch, const float* dy,
                float* grad) const {
    mlp_backward(shape[i], net(i), seen(i, x, scratch), rows, scratch, dy, grad + net_offset(i));
  }
  // dy along a direction of the network's parameters, likewise.
  void tangent(int32_t i, const float* direction, const float* x, int32_t rows, const MlpScratch& scratch,
               float* dy) const {
    mlp_tangent(shape[i], net(i), direction, seen(i, x, scratch), rows, scratch, dy);
  }
  // dy of the actor's outputs y: nothing where a deviation is at its bound.
  void gate_std(const float* y, int32_t rows, float* dy) const;
  int32_t num_tensors() const;
  void visit(StateIo& io);

 private:
  void forward_with(const float* weights, int32_t i, const float* x, int32_t rows, const MlpScratch& scratch,
                    float* y) const {
    if (columns[i]) pick_columns(x, rows, obs_dim, columns[i], shape[i].in, scratch.picked);
    mlp_forward(shape[i], weights, seen(i, x, scratch), rows, scratch, y);
    if (i == kActor && state_std()) bound_std(rows, y);
  }
  const float* seen(int32_t i, const float* x, const MlpScratch& scratch) const {
    return columns[i] ? scratch.picked : x;
  }
  void bound_std(int32_t rows, float* y) const;
};
Networks carve_networks(Arena& arena, const ResolvedAgentConfig& resolved);
// Weights from the streams (seed, network, init); the actor's last bias is the initial mean.
void init_networks(const Networks& n, const ResolvedAgentConfig& resolved);
void clamp_log_std(const Networks& n);
// One more epoch in the average: a plain mean until it has 1 / (1 - average_share) of them.
void average_actor(const Networks& n);
// It begins again with the actor as it is.
void restart_average(const Networks& n);
// With std_schedule=linear the deviation for the epoch that follows `done` finished ones.
void schedule_std(const Networks& n, const Options& options, int32_t done);

inline constexpr int32_t kTensorNameSize = 32;
// Tensor `index` in the order above, names "actor.log_std", "actor.0.weight", "cost_critic.2.bias".
bool find_tensor(const Networks& n, int32_t index, char* name, TensorInfo* out);

}  // namespace rdm

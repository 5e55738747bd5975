// The parameters that an agent learns: log standard deviation, actor, reward critic, cost critic, one vector.
#pragma once
#include "algos/plan.hpp"
#include "algos/state_io.hpp"
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
  Block block[3];
  int32_t count = 0;    // 2 without cost critic
  size_t size = 0;      // of params
  size_t std_size = 0;  // padded
  int32_t action_dim = 0;
  float* params = nullptr;

  float* log_std() const { return params; }
  size_t net_offset(int32_t i) const { return block[i].offset + (i == kActor ? std_size : 0); }
  float* net(int32_t i) const { return params + net_offset(i); }
  // y = network i of x, and the gradient of its block, grad laid out as params.
  void forward(int32_t i, const float* x, int32_t rows, const MlpScratch& scratch, float* y) const {
    mlp_forward(shape[i], net(i), x, rows, scratch, y);
  }
  void backward(int32_t i, const float* x, int32_t rows, const MlpScratch& scratch, const float* dy,
                float* grad) const {
    mlp_backward(shape[i], net(i), x, rows, scratch, dy, grad + net_offset(i));
  }
  int32_t num_tensors() const;
  void visit(StateIo& io);
};
Networks carve_networks(Arena& arena, const Plan& plan);
// Weights from the streams (seed, network, init); the actor's last bias is the initial mean.
void init_networks(const Networks& n, const Plan& plan);
void clamp_log_std(const Networks& n, const Options& options);
// With std_schedule=linear the deviation for the epoch that follows `done` finished ones.
void schedule_std(const Networks& n, const Options& options, int32_t done);

inline constexpr int32_t kTensorNameSize = 32;
// Tensor `index` in the order above, names "actor.log_std", "actor.0.weight", "cost_critic.2.bias".
bool find_tensor(const Networks& n, int32_t index, char* name, TensorInfo* out);

}  // namespace rdm

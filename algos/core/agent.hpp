// The agent: an algorithm's networks, rollout memory and update behind one handle. Mirrors rdm_agent_*.
//
// All memory is carved at creation; act, record and update allocate nothing. Work on a minibatch is cut into
// pieces of fixed size that are reduced in a fixed order, so any number of threads gives the same bytes.
#pragma once
#include <atomic>
#include <cstdint>

#include "base/arena.hpp"
#include "base/bytes.hpp"
#include "base/option.hpp"
#include "base/workers.hpp"

namespace rdm {

inline constexpr int kMaxActions = 1024;
inline constexpr int kMaxCosts = 16;  // = RDM_MAX_COSTS

// One row of the registry of algorithms.
struct AlgoInfo {
  const char* name;
  const char* summary;
  const OptionSpec* options;  // the whole table: shared options first, then the algorithm's own
  int32_t num_options;
};
int32_t algo_count();
const AlgoInfo& algo_at(int32_t index);
// Error(kNotFound) with the nearest name.
int32_t algo_find(const char* name);

struct AgentConfig {
  int32_t obs_dim = 0, action_dim = 0, cost_dim = 1, num_envs = 0, num_threads = 0;
  const char* algo = "ppo_lag";
  const char* task = "";
  uint64_t seed = 0, layout_hash = 0;
  float control_dt = 0;
  int32_t max_steps = 0;
  const float* initial_mean = nullptr;    // [action_dim] or null
  const OptionInput* defaults = nullptr;  // laid under options; keys of other algorithms are skipped
  int32_t num_defaults = 0;
  const OptionInput* options = nullptr;
  int32_t num_options = 0;
  const double* cost_limits = nullptr;  // [cost_dim] or null; < 0: none
  HostHooks hooks;
};

struct Transition {
  const float* reward = nullptr;  // [num_envs]
  const float* cost = nullptr;    // [num_envs][cost_dim]
  const uint8_t *terminated = nullptr, *truncated = nullptr, *valid = nullptr, *success = nullptr;
  const float* final_obs = nullptr;  // [num_envs][obs_dim]
  const int32_t* steps = nullptr;    // [num_envs]
};

// Field by field the public rdm_epoch, without struct_size.
struct Epoch {
  int32_t epoch = 0;
  int64_t env_steps = 0, episodes = 0;
  double ret = 0, cost[kMaxCosts] = {}, cost_per_step = 0, length = 0, fall_rate = 0, success_rate = 0;
  double multiplier[kMaxCosts] = {};
  double kl = 0, entropy = 0, learning_rate = 0, action_std = 0;
  double loss_policy = 0, loss_reward_value = 0, loss_cost_value = 0, clip_fraction = 0;
  double value_reward = 0, value_cost = 0;
  int32_t passes = 0;
};

struct TensorInfo {
  const char* name;
  int32_t rows, cols;
  float* data;
};

class Agent {
 public:
  static size_t memory(const AgentConfig& config);  // bytes of create, exact
  static Agent* create(const AgentConfig& config);
  static void destroy(Agent* a);
  virtual ~Agent() = default;

  virtual void act(const float* obs, bool sample, float* action) = 0;
  virtual void record(const Transition& t) = 0;
  virtual void update(const float* last_obs, Epoch* out) = 0;
  // Decisions still missing in this horizon; 0: update is due.
  virtual int32_t missing() const = 0;
  virtual int32_t horizon() const = 0;
  virtual int32_t action_repeat() const = 0;
  virtual void drop_horizon() = 0;  // after a cancel: forget what was collected

  virtual void set_option(const OptionInput& option) = 0;
  virtual const Options& options() const = 0;
  virtual bool tensor(int32_t index, TensorInfo* out) = 0;  // false past the end
  virtual void tensors_changed() = 0;                       // after a write through TensorInfo::data

  virtual void write_policy_file(Writer& out) = 0;  // const but for scratch
  virtual void save(Writer& out) const = 0;         // Error(kState) inside a horizon
  // Error(kFormat) unless load would take these bytes; changes nothing.
  virtual void check_state(const void* bytes, size_t size) = 0;
  virtual void load(const void* bytes, size_t size) = 0;  // changes nothing when it fails

  virtual const AgentConfig& config() const = 0;  // pointers inside are not valid any more

  // Throws Error(kCancelled) once after cancel() was called (async-signal-safe).
  void check_cancel();
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }

 private:
  std::atomic<bool> cancelled_{false};
};

}  // namespace rdm

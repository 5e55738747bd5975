// What goes into an agent and comes out of it, and the list of algorithms as others see it.
#pragma once
#include <cstdint>

#include "algos/core/columns.hpp"
#include "base/option.hpp"

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

// How a host carries messages between the processes that learn together; as rdm_ranks.
struct RankHooks {
  int32_t rank = 0, count = 1;
  void* user = nullptr;
  int32_t (*gather)(void* user, const void* mine, size_t bytes, void* all) = nullptr;
  int32_t (*swap)(void* user, int32_t rank, const void* mine, size_t bytes, void* theirs) = nullptr;
  uint32_t version = 0;  // of the library, which all ranks must have alike
};

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
  const char* settings = nullptr;       // lines key=value, laid over the options; null: none
  const double* cost_limits = nullptr;  // [cost_dim] or null; < 0: none
  const ObsField* fields = nullptr;     // [num_fields] parts of a row, or null: no names
  int32_t num_fields = 0;
  HostHooks hooks;
  RankHooks ranks;
};

struct Transition {
  const float* reward = nullptr;  // [num_envs]
  const float* cost = nullptr;    // [num_envs][cost_dim]
  const uint8_t *terminated = nullptr, *truncated = nullptr, *valid = nullptr, *success = nullptr;
  const float* final_obs = nullptr;  // [num_envs][obs_dim]
  const int32_t* steps = nullptr;    // [num_envs]
  const uint32_t* status = nullptr;  // [num_envs] RDM_STATUS_*
  uint64_t generation = 0;           // of the policy that sampled; 0: not known
  const float* limit = nullptr;      // [num_envs] on column 0, of the episode alone; null: the agent's
};

// As the public ones.
enum EpochFlag : uint32_t {
  kEpochNoEpisode = 1,
  kEpochSkippedGradients = 2,
  kEpochInvalidRows = 4,
  kEpochCut = 8,
  kEpochDiverged = 16,
  kEpochContacts = 32,
  kEpochBadAction = 64,
  kEpochTask = 128,
  kEpochSolver = 256,
  kEpochSlowed = 512
};

// What an epoch tells, with the meaning of rdm_epoch, each named here alone: F(type, member).
using CostValues = double[kMaxCosts];
#define RDM_EPOCH_MEMBERS(F)    \
  F(int32_t, epoch)             \
  F(int64_t, env_steps)         \
  F(int64_t, episodes)          \
  F(double, ret)                \
  F(CostValues, cost)           \
  F(double, cost_per_step)      \
  F(double, length)             \
  F(double, fall_rate)          \
  F(double, success_rate)       \
  F(CostValues, multiplier)     \
  F(double, kl)                 \
  F(double, entropy)            \
  F(double, learning_rate)      \
  F(double, action_std)         \
  F(double, loss_policy)        \
  F(double, loss_reward_value)  \
  F(double, loss_cost_value)    \
  F(double, clip_fraction)      \
  F(double, value_reward)       \
  F(double, value_cost)         \
  F(int32_t, passes)            \
  F(int32_t, cost_signal)       \
  F(uint32_t, flags)            \
  F(int64_t, skipped_gradients) \
  F(int64_t, invalid_rows)      \
  F(int64_t, diverged)          \
  F(int64_t, contacts_left_out) \
  F(int64_t, bad_actions)       \
  F(int64_t, task_failed)       \
  F(int64_t, unconverged)       \
  F(int64_t, slowed)            \
  F(int64_t, violations)        \
  F(int64_t, refused)           \
  F(int64_t, unproven)          \
  F(int64_t, copied)            \
  F(int64_t, inevitable)

struct Epoch {
#define RDM_MEMBER(type, member) type member{};
  RDM_EPOCH_MEMBERS(RDM_MEMBER)
#undef RDM_MEMBER
};

struct TensorInfo {
  const char* name;
  int32_t rows, cols;
  float* data;
};

}  // namespace rdm

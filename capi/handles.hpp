// The handles behind the ABI: the object itself, its error text, and what only the shim needs. And what one
// source file of the shim takes from another.
#pragma once
#include "capi/in_use.hpp"
#if RDM_WITH_SIM
#include "base/memory_block.hpp"
#include "capi/layouts.hpp"
#include "env/pool.hpp"
#include "robot/robot_copy.hpp"
#include "sense/render/raycast.hpp"
#endif
#if RDM_WITH_LEARN
#include "algos/agent/agent.hpp"
#endif
#if RDM_WITH_POLICY
#include "nn/actor.hpp"
#endif

#if RDM_WITH_SIM
struct rdm_pool {
  static constexpr rdm::capi::Tag kTag = rdm::capi::Tag::kPool;
  static constexpr bool kOneAtATime = false;
  rdm::capi::Tag tag = kTag;
  mutable rdm::capi::InUse in_use;
  rdm::HostHooks hooks;                          // those of `block`
  mutable char error[rdm::kErrorTextSize] = "";  // also of calls that only read
  rdm::Pool* pool = nullptr;
  rdm::MemoryBlock* block = nullptr;  // in which all of it lies
  void* memory = nullptr;             // [bytes] the block's, of the alloc hook; null: it is a host's own
  size_t bytes = 0;
  rdm::Arena arena;                // the arrays below
  rdm_option* defaults = nullptr;  // [num_defaults] of the agent, for rdm_agent_config_for_pool
  int32_t num_defaults = 0;
  float* initial_mean = nullptr;  // [action_dim]
  double* cost_limits = nullptr;  // [cost_dim]
  rdm_field* fields = nullptr;    // [number of fields]
  rdm::capi::Layout layout;       // these, for texts
  rdm::RaycastScratch raycast;
  rdm::RenderShape* shapes = nullptr;  // [most_drawn_shapes]
};

namespace rdm::capi {
// A camera of the task by name; Error(kNotFound) offers the nearest.
Camera pool_camera(const rdm_pool* p, int32_t env, const char* name);  // as it stands in that world now
rdm_camera_info describe(const CameraSpec& c);
// Field i of a task's observation; Error(kRange) past the end.
rdm_field_info field_of(const Task& task, int32_t i);
// What a host says of a robot; check_robot has not seen it.
RobotCopy robot_from(const rdm_robot_def* def);
// Discovery drops what it knows of a task that was removed.
void forget_task(int32_t index);
}  // namespace rdm::capi
#endif

#if RDM_WITH_LEARN
// Sums over the control steps of one decision, for rdm_agent_rollout.
struct DecisionBuffers {
  float* reward = nullptr;   // [num_envs]
  float* cost = nullptr;     // [num_envs][cost_dim]
  int32_t* steps = nullptr;  // [num_envs]
  float* limit = nullptr;    // [num_envs] of the episode that runs before the decision
  uint8_t *mask = nullptr, *valid = nullptr, *terminated = nullptr, *truncated = nullptr, *success = nullptr;
  uint32_t* status = nullptr;  // [num_envs] of the decision
};

struct rdm_agent {
  static constexpr rdm::capi::Tag kTag = rdm::capi::Tag::kAgent;
  static constexpr bool kOneAtATime = true;  // to save it settles statistics, to value it uses its threads
  rdm::capi::Tag tag = kTag;
  mutable rdm::capi::InUse in_use;
  rdm::HostHooks hooks;
  mutable char error[rdm::kErrorTextSize] = "";  // also of calls that only read
  rdm::Agent* agent = nullptr;
  rdm::Arena arena;
  DecisionBuffers decision;
  rdm_shield* shield = nullptr;  // of its rollouts, a host's
};

namespace rdm::capi {
// Into as much of the caller's struct as there is.
void write_epoch(rdm_epoch* io, const Epoch& e);
}  // namespace rdm::capi
#endif

#if RDM_WITH_POLICY
struct rdm_policy {
  static constexpr rdm::capi::Tag kTag = rdm::capi::Tag::kPolicy;
  rdm::capi::Tag tag = kTag;
  rdm::HostHooks hooks;
  rdm::Policy* policy = nullptr;
  rdm::capi::Changes changes;
};

namespace rdm::capi {
// A host's clouds for an encoder; rows of them are not looked at.
PointRows read_points(const rdm_points* points, const PointNetShape& eyes);
// As rdm_policy_check; the struct is read already.
void check_policy(const PolicyView& v, const rdm_spec& spec);
}  // namespace rdm::capi
#endif

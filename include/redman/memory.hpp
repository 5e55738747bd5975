// redman/memory.hpp: agents and policies that remember. C++17, experimental.
//
//   std::vector<float> state = redman::start(policy, rows);  // of new episodes
//   redman::act(policy, obs, state.data(), rows, nullptr, action);
#ifndef REDMAN_MEMORY_HPP
#define REDMAN_MEMORY_HPP
#include <redman/memory.h>

#include <redman/agent.hpp>
#include <redman/policy.hpp>

namespace redman {

// What a policy remembers of so many worlds before their first decision: [rows][state_dim].
inline std::vector<float> start(const Policy& policy, int32_t rows) {
  return std::vector<float>(static_cast<size_t>(rows) *
                            static_cast<size_t>(policy.info().state_dim));
}
// state [rows][state_dim] becomes that after the decision.
inline void act(const Policy& policy, const float* obs, float* state, int32_t rows,
                const float* noise, float* action, void* scratch, size_t scratch_bytes) {
  check(
      rdm_policy_act_state(policy.get(), obs, state, rows, noise, action, scratch, scratch_bytes));
}
// The same with scratch memory from the heap.
inline void act(const Policy& policy, const float* obs, float* state, int32_t rows,
                const float* noise, float* action) {
  Bytes scratch(policy.scratch_bytes(rows));
  act(policy, obs, state, rows, noise, action, scratch.data(), scratch.size());
}
// mask [num_envs], or null: of all.
inline void forget(const Agent& agent, int32_t mode, const uint8_t* mask = nullptr) {
  check(rdm_agent_forget(agent.get(), mode, mask));
}

}  // namespace redman
#endif

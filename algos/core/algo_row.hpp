// What is known of an algorithm before one is made: a row of the list in algo_registry.cpp.
#pragma once
#include "algos/core/agent_types.hpp"

namespace rdm {

class Agent;
struct ResolvedAgentConfig;

// How many limited cost columns an algorithm learns from: none, any number, one at a time (several are
// refused, or the most violated counts, by option several_costs), or any number that is taken off the reward by
// its weights (Agent::cost_weight), so that they have no critic.
enum class Costs : int32_t { kNone, kAny, kOne, kInReward };

struct AlgoRow {
  AlgoInfo info;
  Costs costs;
  size_t (*measure)(ResolvedAgentConfig&& resolved);
  Agent* (*make)(const HostHooks& hooks, ResolvedAgentConfig&& resolved);
  void (*end)(Agent* agent);
  void (*adapt)(ResolvedAgentConfig& resolved);  // defaults that hang on the limits, by set_default; or null
  // The algorithm that it is for one agent: what tasks and presets set for that one holds for it too; or null.
  const AlgoRow* alone = nullptr;
  bool own_critics = false;  // each group of its team has critics of its own
};
const AlgoRow& algo_row(int32_t index);

}  // namespace rdm

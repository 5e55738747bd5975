// What is known of an algorithm before one is made: a row of the list in algo_registry.cpp.
#pragma once
#include "algos/core/agent_types.hpp"
#include "algos/core/shared_options.hpp"
#include "nn/squash.hpp"

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
  // It learns from a replay memory (off_policy/): it has critics of rows and actions, and of shared options this
  // part, whose values `shared` reads.
  bool off_policy = false;
  Squash squash = Squash::kNone;                              // what makes actions of its actor's outputs
  SharedOptions (*shared)(const Options& options) = nullptr;  // null: all of them
};
// Of an algorithm's options, those that are shared.
SharedOptions read_shared_options(const Options& options, const AlgoRow& row);
const AlgoRow& algo_row(int32_t index);

}  // namespace rdm

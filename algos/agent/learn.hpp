// What is learned from rows that were recorded before, without a world. Mirrors rdm_recording_rows, rdm_learn_report.
#pragma once
#include <cstdint>

#include "algos/core/agent_types.hpp"
#include "algos/rollout/episodes.hpp"

namespace rdm {

struct LearnRows {
  int64_t rows = 0;
  int32_t cost_dim = 0;
  const float *obs = nullptr, *action = nullptr, *reward = nullptr, *cost = nullptr;
  const uint8_t *terminated = nullptr, *truncated = nullptr;
  const int64_t* episode = nullptr;
};

struct LearnReport {
  int64_t steps = 0;    // gradient steps of this call
  int64_t rows = 0;     // that are learned from
  int64_t skipped = 0;  // gradients that were not finite
  double loss_policy = kNothing, loss_reward_value = kNothing,
         loss_cost_value = kNothing;  // means over the steps
  double value_reward = kNothing, value_cost = kNothing;
  double cost[kMaxCosts];             // estimate of J_c now; kNothing of costs without a limit
  double multiplier[kMaxCosts] = {};  // [cost_dim]
};

}  // namespace rdm

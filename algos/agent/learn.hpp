// What is learned from rows that were recorded before, without a world. Mirrors rdm_recording_rows, rdm_learn_report.
#pragma once
#include <cstdint>

#include "algos/core/agent_types.hpp"

namespace rdm {

struct LearnRows {
  int64_t rows = 0;
  int32_t cost_dim = 0;
  const float *obs = nullptr, *action = nullptr, *reward = nullptr, *cost = nullptr;
  const uint8_t *terminated = nullptr, *truncated = nullptr;
  const int64_t* episode = nullptr;
};

struct LearnReport {
  int64_t steps = 0;                                                   // gradient steps of this call
  int64_t rows = 0;                                                    // that are learned from
  int64_t skipped = 0;                                                 // gradients that were not finite
  double loss_policy = 0, loss_reward_value = 0, loss_cost_value = 0;  // means over the steps
  double value_reward = 0, value_cost = 0;
  double cost[kMaxCosts] = {};        // [cost_dim] estimate of J_c at the last multiplier step
  double multiplier[kMaxCosts] = {};  // [cost_dim]
};

}  // namespace rdm

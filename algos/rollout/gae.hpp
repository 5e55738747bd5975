// Generalised advantage estimation (Schulman et al. 2016, "High-dimensional continuous control using
// generalized advantage estimation", eq. 16) and standardisation over a horizon of many environments.
//
//   delta_t = r_t + d_t V(s_t+1) - V(s_t)
//   A_t     = delta_t + d_t lambda A_t+1     backwards in t; the critic's target is A_t + V(s_t)
//
// d_t: discount^steps of the decision, 0 where a path ended. A path that a time limit cut has d_t V of its
// final observation in r_t (Collector::record), so it is no end of the task. Rewards and each cost alike,
// with a lambda of their own.
//
// Reward advantages are standardised over the batch, cost advantages only centred (scale_cost_adv=center),
// for all algorithms: their size against the limit means something. FOCOPS' authors standardise both.
#pragma once
#include <cstdint>

#include "algos/core/ranks.hpp"

namespace rdm {

// One reward or cost column; sample (t, env) is element (t num_envs + env) stride.
struct GaeColumn {
  const float* reward = nullptr;      // with the value of a truncated path's end already added
  const float* value = nullptr;       // V(s_t)
  const float* last_value = nullptr;  // [num_envs] V of the observation after the horizon
  float* advantage = nullptr;
  float* target = nullptr;  // advantage + value
  int32_t stride = 1;       // of all five
};

// discount [horizon][num_envs]: of the value that follows, 0 where the path ended. valid likewise: rows that
// are not get advantage 0 and end the path before them, whose value then is V of the row itself.
void gae(const GaeColumn& c, const float* discount, const uint8_t* valid, int32_t horizon, int32_t num_envs,
         double lambda);

// Rows of a rollout in the order of its columns, by blocks of environments.
struct BlockRows {
  const uint8_t* valid = nullptr;
  int32_t horizon = 0, num_envs = 0;

  // f(row) for each valid one of environments [first, first + count).
  template <class F>
  void each(int32_t first, int32_t count, F&& f) const {
    for (int32_t t = 0; t < horizon; ++t)
      for (int32_t e = first; e < first + count; ++e)
        if (const int32_t row = t * num_envs + e; valid[row]) f(row);
  }
};

// Over the valid rows of all ranks: subtracts the mean and, if asked, divides by the population deviation +
// 1e-8.
void standardize(const BlockRows& rows, float* x, int32_t stride, bool divide, Ranks& ranks);

// Mean over the valid rows of all ranks, 0 when there are none.
double masked_mean(const BlockRows& rows, const float* x, int32_t stride, Ranks& ranks);

}  // namespace rdm

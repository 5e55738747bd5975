// Generalised advantage estimation and standardisation over a horizon of many environments.
#pragma once
#include <cstdint>

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

// Over the valid rows: subtracts the mean and, if asked, divides by the population deviation + 1e-8.
void standardize(float* x, int32_t stride, const uint8_t* valid, int32_t count, bool divide);

// Mean over the valid rows, 0 when there are none.
double masked_mean(const float* x, int32_t stride, const uint8_t* valid, int32_t count);

}  // namespace rdm

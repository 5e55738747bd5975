// What an epoch collects: one row per decision, sample t of environment e at row t num_envs + e, so that an
// act writes one block.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "algos/rollout/gae.hpp"

namespace rdm {

struct Rollout {
  int32_t horizon = 0, num_envs = 0, num_costs = 0;
  size_t obs_dim = 0, action_dim = 0;
  int32_t filled = 0;                 // decisions recorded
  const ActorGroup* group = nullptr;  // [num_groups] of the actor; none: one network gives all of an action
  int32_t num_groups = 0;
  size_t critics = 1;  // of each kind

  // [samples] rows of:
  float* obs = nullptr;  // [obs_dim] as the networks saw it, without its history; with `replayed` as it came
  int16_t* points = nullptr;                // [eyes.points][3], of an actor whose eyes learn
  uint8_t* point_class = nullptr;           // [eyes.points], with classes
  uint8_t* point_color = nullptr;           // [eyes.points][3], with colours
  float* features = nullptr;                // [features], of eyes that stand still
  size_t row_points = 0, row_features = 0;  // points and features of a row
  float* action = nullptr;                  // [action_dim] less the offset of the correlated noise
  float* mean = nullptr;                    // [action_dim] of the policy that acted
  float* log_prob = nullptr;                // [parts()]
  // [critics]: more than one where each group of the actor has critics of its own
  float *reward = nullptr, *value = nullptr, *advantage = nullptr, *target = nullptr;
  // [critics][num_costs]
  float *cost = nullptr, *cost_value = nullptr, *cost_advantage = nullptr, *cost_target = nullptr;
  float* discount = nullptr;  // 0 where a path ended
  uint8_t* valid = nullptr;
  // What goes into a replay memory, of a learner that has one (off_policy/): actions are those that the worlds were
  // given, rewards have no values in them, and discounts are 0 only where nothing is worth anything any more.
  bool replayed = false;
  uint8_t* over = nullptr;     // the episode ended with this row
  float* final_obs = nullptr;  // [obs_dim], where it ended and the discount is not 0
  float* log_std = nullptr;    // [action_dim] of the innovation, of the policy that acted; std_step apart
  size_t std_step = 0;         // 0: one for all rows
  // [critics]: what the actor climbs: clipped, and linear in the ratio (0 unless the algorithm splits its loss).
  float *gain = nullptr, *linear = nullptr;
  float *last_value = nullptr,
        *last_cost_value = nullptr;  // [num_envs][critics], [num_envs][critics][num_costs]
  int32_t* order = nullptr;          // [samples] valid rows, block after block, shuffled

  // What an agent with a memory keeps. age [samples]: decisions since the memory was cleared, within this horizon, no
  // more than count: kWholeMemory where it was not.
  static constexpr int32_t kWholeMemory = 1 << 30;
  int32_t* age = nullptr;
  int32_t depth = 0, width = 0;      // history: decisions before, and numbers of each
  const int32_t* columns = nullptr;  // [width] of a row; null: all
  float* before = nullptr;           // [num_envs][depth][width] history where the horizon began
  int32_t path = 0, units = 0;       // GRU: decisions through which gradients flow, and its units
  float* state = nullptr;            // [paths][num_envs][units] before the first decision of each path
  int32_t* sequence = nullptr;       // [paths num_envs] paths in the order of minibatches, block after block
  int32_t paths() const { return path ? (horizon + path - 1) / path : 0; }
  size_t seen_dim() const { return obs_dim + static_cast<size_t>(depth) * static_cast<size_t>(width); }

  float* log_std_of(size_t at) const { return log_std + at * std_step; }
  // Entries of the action that one network gives.
  struct Part {
    size_t first, count;
  };
  size_t parts() const { return static_cast<size_t>(std::max(num_groups, 1)); }
  Part part(size_t g) const {
    if (num_groups == 0) return {0, action_dim};
    return {static_cast<size_t>(group[g].first), static_cast<size_t>(group[g].count)};
  }
  // What the actor saw of the listed rows, every stride-th of the list.
  PointRows clouds(const int32_t* order, int32_t stride = 1) const {
    return {points, nullptr, point_class, point_color, features, nullptr, order, stride};
  }
  // Of sample `at` the row of what group g climbs, as each critic has one.
  size_t valued(size_t at, size_t g) const { return critics > 1 ? at * critics + g : at; }
  size_t valued_rows() const { return static_cast<size_t>(samples()) * critics; }
  size_t row(int32_t t) const { return static_cast<size_t>(t) * static_cast<size_t>(num_envs); }
  int32_t samples() const { return horizon * num_envs; }
  BlockRows rows() const { return {valid, horizon, num_envs}; }
};
Rollout carve_rollout(Arena& arena, const ResolvedAgentConfig& resolved);

struct AdvantageOptions {
  double lambda = 0.95, cost_lambda = 0.95;
  bool standardize_reward = true, standardize_cost = false;
};
// Of row `at`: log p of the actions of each part, after they were written.
void keep_log_prob(const Rollout& r, size_t at, const float* mean, const float* log_std);
// p(action) / p_old(action) of row `at` under a policy with this mean and innovation; at most e^20, which is
// far past any clip and still finite after it is multiplied. Of one part alone, or of parts [first, last).
double part_ratio(const Rollout& r, size_t at, size_t part, const float* mean, const float* log_std);
double sample_ratio(const Rollout& r, size_t at, size_t first, size_t last, const float* mean,
                    const float* log_std);
inline double sample_ratio(const Rollout& r, size_t at, const float* mean, const float* log_std) {
  return sample_ratio(r, at, 0, r.parts(), mean, log_std);
}
// KL(old || now) of the same.
double sample_kl(const Rollout& r, size_t at, size_t first, size_t last, const float* mean,
                 const float* log_std);
// Copies the observations of n listed rows, every stride-th entry of the list, with their histories to x
// [n][seen_dim].
void gather_obs(const Rollout& r, const int32_t* order, int32_t stride, int32_t n, float* x);
// Asks the memory for the actions and old means of n listed rows, which a loss is about to read.
void expect_actions(const Rollout& r, const int32_t* order, int32_t n);

// How cost weights l meet the reward: (A_r - sum l_i A_ci) / (1 + sum l_i), (1 - sum l_i) A_r - sum l_i A_ci,
// or A_r - sum l_i A_ci.
enum class Mix : int32_t { kSum, kDifference, kPlain };

// Fills advantages and targets of the reward (column -critics to -1, one for each critic) or of a limited cost (0 to
// critics num_costs - 1), and scales the advantages by those
// of all ranks.
void estimate_advantage(const Rollout& r, int32_t column, const AdvantageOptions& options, Ranks& ranks);
void estimate_advantages(const Rollout& r, const AdvantageOptions& options, Ranks& ranks);
// What the actor climbs under cost weights l [num_costs], in gain; with split the cost part of it stands in
// linear instead, which no clip touches.
void combine_advantages(const Rollout& r, const double* weights, Mix mix, bool split);
// Writes the valid rows into order, those of environments [first, first + count) from entry `at` on; returns
// their number.
int32_t list_valid(const Rollout& r, int32_t first, int32_t count, int32_t at);

}  // namespace rdm

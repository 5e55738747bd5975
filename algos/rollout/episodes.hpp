// Running episodes of all environments and the window of the last finished ones; statistics are values.
#pragma once
#include <algorithm>
#include <limits>

#include "algos/core/agent_types.hpp"
#include "algos/core/state_io.hpp"
#include "base/arena.hpp"

namespace rdm {

inline constexpr int32_t kStatsWindow = 100;  // episodes behind the numbers of an Epoch

inline constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();  // of what was not measured

// Means over finished episodes; while there is none, kNothing.
struct EpisodeStats {
  int64_t finished = 0;  // so far
  bool fresh = false;    // at least one since the last mark
  double ret = kNothing, length = kNothing, fall_rate = kNothing, success_rate = kNothing;
  double cost_per_step = kNothing;  // column 0
  double cost[kMaxCosts];           // raw sum of each column
  // Mean of the last `cost_window` episodes' weighed sums with what falls were charged: what limits hold for.
  double charged_cost[kMaxCosts];

  EpisodeStats() {
    for (double* list : {cost, charged_cost}) std::fill_n(list, kMaxCosts, kNothing);
  }
};

class Episodes {
 public:
  // cost_window: episodes behind charged_cost.
  void carve(Arena& arena, int32_t num_envs, int32_t cost_dim, int32_t cost_window, int32_t ranks = 1);

  // Adds a decision of environment env; cost [cost_dim]. weight: of its costs in what limits hold for.
  void add(int32_t env, double reward, const float* cost, int32_t steps, bool success, double weight = 1);
  // Control steps and cost so far of the episode that runs in env.
  int64_t length(int32_t env) const { return length_[env]; }
  double cost(int32_t env, int32_t column) const { return cost_[at(env, column)]; }
  // Ends it. charge [cost_dim] or null is added to the charged costs.
  void finish(int32_t env, bool terminated, const double* charge);

  // A decision of all environments begins.
  void tick() { ++moment_; }
  // Among ranks an episode that ended counts from here on: all of theirs come in, by time, then environment,
  // as those of one process would.
  void settle(Ranks& ranks);
  void forget() { ended_count_ = moment_ = 0; }  // of what came since

  EpisodeStats stats() const;
  void mark() { marked_ = finished_; }
  void visit(StateIo& io);

 private:
  size_t at(int32_t i, int32_t column) const {
    return static_cast<size_t>(i) * static_cast<size_t>(cost_dim_) + static_cast<size_t>(column);
  }
  size_t wide() const { return kOwn + 2 * static_cast<size_t>(cost_dim_); }  // of a row of ended_
  void take(const double* row);

  // Of a row of ended_, before its costs and charged costs.
  enum { kMoment, kReturn, kLength, kFall, kSuccess, kOwn };
  int32_t num_envs_ = 0, cost_dim_ = 0, cost_window_ = 0, capacity_ = 0;
  double* ended_ = nullptr;    // [capacity_][wide()] ring of what ended since settle; none without ranks
  double* arrived_ = nullptr;  // [ranks][capacity_][wide()]
  int64_t* counts_ = nullptr;  // [ranks]
  int32_t* next_ = nullptr;    // [ranks]
  int64_t ended_count_ = 0, moment_ = 0;
  int64_t finished_ = 0, marked_ = 0;
  // [num_envs] of the running episodes
  double *ret_ = nullptr, *cost_ = nullptr, *weighed_ = nullptr;  // cost, weighed [num_envs][cost_dim]
  int64_t* length_ = nullptr;
  uint8_t* success_ = nullptr;
  // [capacity] rings; episode number i is at i mod capacity
  double *done_ret_ = nullptr, *done_cost_ = nullptr, *done_charged_ = nullptr;
  int64_t* done_length_ = nullptr;
  uint8_t *done_fall_ = nullptr, *done_success_ = nullptr;
};

}  // namespace rdm

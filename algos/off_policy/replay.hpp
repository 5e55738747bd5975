// The replay memory: what was seen, done and paid, a ring of rows for each world, taken from the agent's arena.
//
// A row is a decision: observation, action, reward, limited costs, and the discount to what follows, 0 where
// nothing does. Its next observation is that of the row behind it in its ring, so each observation is kept once. Where
// the row behind is not what followed (a time limit ended the episode; the world has not gone on yet) a row stands in
// between that has an observation alone and is never drawn. So memory is about
//
//   rows (obs_dim + action_dim + num_costs + 2) 4 bytes
//
// Rows are floats in the units that they came in. Halves would save half of that, but they end at 65504 and have three
// digits, and observations of hosts are in any unit; networks see rows that are normalised when they are drawn, by the
// statistics of that time.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "algos/core/state_io.hpp"
#include "base/arena.hpp"

namespace rdm {

inline size_t count_of(int32_t n) {
  return static_cast<size_t>(n);
}

// Bound on the magnitudes of rewards and costs that are kept: targets of them stay finite.
inline constexpr float kMaxReplayed = 1e12f;

// Rows that a network sees at a time.
inline constexpr int32_t kPartRows = 256;

struct ReplayRow {
  const float* obs = nullptr;     // [obs_dim]
  const float* action = nullptr;  // [action_dim] within [-1, 1]
  float reward = 0;
  const float* cost = nullptr;  // [num_costs] of limited columns
  float discount = 0;           // 0: what follows is worth nothing
};

class Replay {
 public:
  // rows: of all worlds; each has the same share, rounded up, and one row more.
  static int32_t rows_of_world(int64_t rows, int32_t num_envs);
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, int64_t rows);
  void open(const ResolvedAgentConfig& resolved);

  // Adds a decision of world env. If its observation is not the one that `follow` foretold, that stays where it is,
  // and this one stands behind it.
  void push(int32_t env, const ReplayRow& row);
  // What the last row of env led to, which is no decision (yet): the next push may be of it.
  void follow(int32_t env, const float* obs);
  // Likewise, and the next push is of another episode.
  void end(int32_t env, const float* obs);
  // Forgets everything.
  void clear();

  int64_t rows() const { return rows_; }  // that can be drawn
  // Draws rows uniformly from those that can be drawn, with replacement. At least one must be there.
  void draw(Stream& stream, int32_t count, int32_t* drawn) const;
  // Of drawn row i, and of the one behind it.
  const float* obs(int32_t i) const { return obs_ + static_cast<size_t>(i) * obs_dim_; }
  const float* next_obs(int32_t i) const { return obs(next(i)); }
  const float* action(int32_t i) const { return action_ + static_cast<size_t>(i) * action_dim_; }
  const float* cost(int32_t i) const { return cost_ + static_cast<size_t>(i) * num_costs_; }
  float reward(int32_t i) const { return reward_[i]; }
  float discount(int32_t i) const { return discount_[i]; }
  int32_t capacity() const { return num_envs_ * capacity_; }
  // Rows that can be drawn and begin an episode, as far as the memory goes back, to out [capacity()]; how many.
  int32_t first_rows(int32_t* out) const;
  // Place i has this row: one that can be drawn, or else its observation alone.
  bool is(int32_t i, const ReplayRow& row, bool drawn) const;
  bool drawable(int32_t i) const { return drawable_[i] != 0; }
  void visit(StateIo& io);
  void after_load();

 private:
  int32_t next(int32_t i) const { return (i + 1) % capacity_ == 0 ? i + 1 - capacity_ : i + 1; }
  int32_t take(int32_t env);

  int32_t num_envs_ = 0, capacity_ = 0;  // rows of a ring
  size_t obs_dim_ = 0, action_dim_ = 0, num_costs_ = 0;
  int64_t rows_ = 0;
  int32_t longest_ = 0;  // rows of the fullest ring, those that are not drawn too
  // [num_envs][capacity_] of:
  float *obs_ = nullptr, *action_ = nullptr, *reward_ = nullptr, *cost_ = nullptr, *discount_ = nullptr;
  uint8_t* drawable_ = nullptr;
  // [num_envs] where the next row goes, rows that are there, and whether the row at the head is a foretold one.
  int32_t *head_ = nullptr, *size_ = nullptr;
  uint8_t* foretold_ = nullptr;
};

}  // namespace rdm

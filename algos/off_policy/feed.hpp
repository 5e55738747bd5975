// A recording in the replay memory: whole episodes, each in the ring that has the fewest rows by then.
//
// What a row led to is the row behind it. What the last row of an episode led to was not recorded, so it is learned from
// where a termination ended the episode, and else it is only what the row before it led to.
#pragma once
#include "algos/agent/learn.hpp"
#include "algos/off_policy/replay.hpp"
#include "base/host.hpp"

namespace rdm {

class Feed {
 public:
  // The memory forgets what it has and takes the rows. Error(kRange) where it is too small, kArgument for rows that
  // nothing can be learned from; nothing changes then.
  void fill(const ResolvedAgentConfig& resolved, const LearnRows& rows, Replay& replay);
  // The memory has these rows, where `fill` puts them. Takes memory where it was not asked of them before.
  bool holds(const ResolvedAgentConfig& resolved, const LearnRows& rows, Replay& replay);

  // Of the rows that fill or holds saw last. First rows of the episodes, as rows of the memory.
  const Vector<int32_t>& starts() const { return starts_; }
  double length() const { return length_; }  // mean number of decisions of an episode
  // Mean sum of the discounts d^t of an episode's decisions, and of those that values are of: beyond a time limit they
  // go on for ever.
  double discounts() const { return discounts_; }
  double value_discounts() const { return value_discounts_; }
  void forget_lengths() { length_ = discounts_ = value_discounts_ = 0; }

 private:
  void put_in_order(const LearnRows& rows);
  enum class Pass { kCheck, kFill, kCompare };
  bool pass(const ResolvedAgentConfig& resolved, const LearnRows& rows, Replay& replay, Pass how);

  Vector<int32_t> order_;  // of episodes, and of time within them
  Vector<int32_t> starts_;
  Vector<int32_t> used_;  // rows of each ring
  double length_ = 0, discounts_ = 0, value_discounts_ = 0;
};

}  // namespace rdm

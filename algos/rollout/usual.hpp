// Which novelty (nn/novelty.hpp) is usual: counts of rows by the size of it, in bins of a sixteenth of an octave,
// of which the edge is read that one row in a thousand is above. Rows of whole epochs are counted until they are
// a thousand, then anew; what was known before stays meanwhile. Counts of ranks add up in any order, so results
// do not depend on them.
#pragma once
#include "algos/core/ranks.hpp"
#include "algos/core/state_io.hpp"
#include "nn/novelty.hpp"

namespace rdm {

class UsualRows {
 public:
  void carve(Arena& arena, size_t envs);
  // The row that a world acts on; counted when it is recorded. Of several threads, each with worlds of its own.
  void see(size_t env, const Novelty& novelty) { seen_[env] = novelty; }
  void count(size_t env) { count(seen_[env]); }
  void count(const Novelty& novelty);
  void drop();  // what this epoch has counted
  // Of all ranks: the epoch has ended.
  void close(Ranks& ranks);
  // What is known is from what was counted since `drop` alone; the same rows on all ranks.
  void close_alone();
  const Novelty& known() const { return known_; }
  // Another policy's statistics, and what is known of them.
  void set(const Novelty& known);
  void visit(StateIo& io);

 private:
  void settle();

  Novelty* seen_ = nullptr;  // [num_envs]
  // [2][bins] of rms and largest: of this epoch, and of all ranks' epochs before it that were too few.
  double *counts_ = nullptr, *before_ = nullptr;
  Novelty known_;
};

}  // namespace rdm

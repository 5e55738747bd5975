// Copies of worlds in which ways to go on are tried: which still go, and how the others ended.
#pragma once
#include "base/arena.hpp"
#include "env/pool.hpp"

namespace rdm {

class CopiesTried {
 public:
  enum class Fate : uint8_t {
    kGoing,
    kOver,  // its episode has ended
    kCost,  // a cost is beyond its budget
    kLost,  // it diverged, or its task failed
  };

  void make(const Pool& of, int32_t count, int32_t threads, const HostHooks& hooks);
  void carve(Arena& arena);
  void end();

  // Copy i becomes world `source` of `from` and goes; bound [cost_dim]: what an episode's costs may come to,
  // below 0: whatever they like.
  void start(int32_t i, const Pool& from, int32_t source, const double* bound);
  // It draws anew what its world drew for itself.
  void redraw(int32_t i, Stream& stream) { pool_->redraw(i, stream); }
  void stop(int32_t i) { going_[i] = 0; }
  void stop_all();
  bool going(int32_t i) const { return going_[i] != 0; }
  const uint8_t* goers() const { return going_; }  // [count]
  bool any_going() const;
  // The copies that go step by the actions in their rows, `steps` times each unless they end before. Control
  // steps that were taken. With stop_at_cost one that exceeds a bound ends, else its excess is counted on.
  int64_t step(int32_t steps, bool stop_at_cost);
  Fate fate(int32_t i) const { return fate_[i]; }
  // Of a copy that ended: the cost whose bound it met first, -1: none; and the episode's control step.
  int32_t column(int32_t i) const { return column_[i]; }
  int32_t ended_in(int32_t i) const { return ended_in_[i]; }
  // Sum over the costs of what an episode has spent beyond its bounds.
  double excess(int32_t i) const;

  const Pool& pool() const { return *pool_; }
  int32_t count() const { return count_; }
  const float* obs(int32_t i) const { return pool_->buffers().obs + row(i, pool_->obs_dim()); }
  float* action(int32_t i) { return pool_->buffers().action + row(i, pool_->task().action_dim()); }

 private:
  static size_t row(int32_t i, int32_t width) { return static_cast<size_t>(i) * static_cast<size_t>(width); }
  void look(int32_t i, bool stop_at_cost);

  Pool* pool_ = nullptr;
  int32_t count_ = 0, costs_ = 0;
  uint8_t *going_ = nullptr, *mask_ = nullptr;       // [count]
  Fate* fate_ = nullptr;                             // [count]
  int32_t *column_ = nullptr, *ended_in_ = nullptr;  // [count]
  double* bound_ = nullptr;                          // [count][costs]
};

}  // namespace rdm

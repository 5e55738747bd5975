// What one world draws for its disturbances (env/options/disturb.hpp), and what it has to remember for them.
//
// A field that is disturbed is shown as
//   y_t = cut(x_max(t - d, 0) + b + s n_t)     n_t normal, new in each control step t
// with deviation s, delay d and offsets b drawn at the reset, t = 0; with the drop-out's probability as
// y_t-1. An action is carried out d control steps after it was given, the hold action before.
#pragma once
#include "base/arena.hpp"
#include "base/bytes.hpp"
#include "base/rng.hpp"
#include "env/options/disturb.hpp"

namespace rdm {

class WorldDisturbance {
 public:
  void carve(Arena& arena, const Disturbance& plan, const Task& task);
  void name(uint64_t seed, uint32_t number) { stream_ = Stream(seed, number, Purpose::kDisturbance); }

  // A new episode: draws, forgets, and takes the task's hold action for what came before.
  void begin(const Disturbance& plan, const Task& task);
  // The row of control step `step`, 0 at the reset, as it is shown; once for each step, in order.
  void show(const Disturbance& plan, int32_t step, float* row);
  // The clipped action of the step that follows `step`, in the place of the one that is given.
  void delay_action(const Disturbance& plan, int32_t step, int32_t action_dim, float* action);

  void write(Writer& out) const;
  void read(Reader& in, bool keep_stream = false);
  void copy(const WorldDisturbance& other);  // of the same plan and task
  // Error(kFormat) for numbers that no world has that was reset.
  void check(const Disturbance& plan) const;

 private:
  Stream stream_;
  float* numbers_ = nullptr;  // [count_] of each field in turn, then of the action
  int32_t count_ = 0;
};

}  // namespace rdm

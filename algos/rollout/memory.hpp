// What an agent remembers of its worlds (options history and memory): a state of each, zeros where its episode began.
//
//   history  the columns of its last decisions as the networks saw them, newest first; a decision is put in front
//            when it is recorded, and networks see it behind the next row (a stacked row)
//   GRU      its state; the one after a sampled decision waits for the record
//
// So a decision that is dropped before its record leaves no trace, and none counts twice. Acting by the mean has a
// state of its own, which advances with each decision and ends only by `forget`: evaluating does not disturb what is
// collected.
#pragma once
#include "algos/core/state_io.hpp"
#include "algos/rollout/rollout.hpp"

namespace rdm {

class AgentMemory {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved);
  void open(const ResolvedAgentConfig& resolved, const Rollout& rollout) {
    resolved_ = &resolved;
    rollout_ = &rollout;
  }
  explicit operator bool() const { return dim_ > 0; }
  bool stacks() const { return rollout_->depth > 0; }

  // Before the decisions of a horizon, and before each of them: what learning needs of the states.
  void begin_decision();
  // Rows x [rows][obs_dim], which may begin at `seen`, with their histories: seen [rows][seen_dim]. Of environments
  // first + i, or env[i]; with `pushed` [num_envs][obs_dim] a decision that saw these rows comes before.
  void stack(const float* x, int32_t first, int32_t rows, bool by_mean, float* seen) const;
  void stack_after(const float* x, const int32_t* env, int32_t rows, float* seen) const;
  // The same of states [rows][dim()] that somebody else keeps, and such a state after a decision that saw these rows.
  void stack_on(const float* x, const float* states, int32_t rows, float* seen) const;
  void push_rows(float* states, const float* seen, int32_t rows) const;
  size_t dim() const { return dim_; }
  const float* state(int32_t env, bool by_mean) const { return (by_mean ? mean_ : state_) + at(env); }
  // Of a GRU: the states behind the decision, which wait for `advance`, or by the mean hold at once.
  void keep_next(int32_t first, int32_t rows, bool by_mean, const float* h);
  // Of a history by the mean, after a decision that saw these rows.
  void push_mean(const float* x, int32_t first, int32_t rows);
  // The decision is recorded.
  void advance();
  void clear(int32_t env);  // its episode ended
  void forget(bool by_mean, const uint8_t* mask);
  void visit(StateIo& io);

 private:
  size_t at(int32_t env) const { return static_cast<size_t>(env) * dim_; }
  void push(float* state, const float* row) const;

  const ResolvedAgentConfig* resolved_ = nullptr;
  const Rollout* rollout_ = nullptr;
  size_t dim_ = 0;
  float *state_ = nullptr, *mean_ = nullptr;  // [num_envs][dim]
  float* next_ = nullptr;                     // likewise, of a GRU
  int32_t* age_ = nullptr;                    // [num_envs] as Rollout::age
};

}  // namespace rdm

// A task around a task: its worlds keep what is left of an episode's limit (env/options/budget.hpp), show it behind
// the fields of the inner task, and say what follows when it is spent. As it is a task, whatever knows tasks knows
// budgets: layouts, saved states, copies, shields, planners, policies as C files.
#pragma once
#include "env/options/budget.hpp"
#include "env/task_around.hpp"

namespace rdm {

class BudgetTask final : public TaskAround {
 public:
  BudgetTask(const Task& inner, const Budget& budget);

  size_t state_bytes() const override { return offset_ + sizeof(State) + kept_bytes(); }
  size_t kept_bytes() const override { return simmers() ? sizeof(int64_t) : 0; }
  void check_state(const void* state) const override;
  void reset(World& world, void* state, Stream& stream) const override;
  Verdict judge(World& world, void* state, int32_t step) const override;
  void reset_rows(const TaskRows& rows) const override;
  void judge_rows(const TaskRows& rows) const override;
  bool draws_limit() const override { return budget_.limit < 0; }
  double limit(const void* state) const override;
  void set_limit(void* state, double limit, float* obs) const override;

 protected:
  void show(const World& world, const void* state, float* out) const override;

 private:
  // Behind the inner task's, and behind it with simmer the control steps of the world so far.
  struct State {
    double limit, left;
  };
  bool simmers() const { return budget_.kind == BudgetKind::kSimmer; }
  State read(const void* state) const;
  void write(void* state, const State& s) const;
  void begin(void* state, Stream& stream) const;
  void spend(void* state, Verdict* verdict) const;
  void show_left(const State& s, float* out) const;

  Budget budget_;
  size_t offset_ = 0;  // of State
  double scale_ = 1;   // of a limit, where the budget is discounted
};

}  // namespace rdm

// A task around a task: its worlds keep what is left of an episode's limit (env/options/budget.hpp), show it behind
// the fields of the inner task, and say what follows when it is spent. As it is a task, whatever knows tasks knows
// budgets: layouts, saved states, copies, shields, planners, policies as C files.
#pragma once
#include "env/fields.hpp"
#include "env/options/budget.hpp"

namespace rdm {

class BudgetTask final : public Task {
 public:
  // The inner task must outlive it.
  BudgetTask(const Task& inner, const Budget& budget);

  const Scene& scene() const override { return inner_.scene(); }
  EngineKind engine() const override { return inner_.engine(); }
  int32_t max_steps() const override { return inner_.max_steps(); }
  int32_t action_dim() const override { return inner_.action_dim(); }
  const Vector<FieldSpec>& fields() const override { return fields_; }
  const char* action_order() const override { return inner_.action_order(); }
  size_t state_bytes() const override { return offset_ + sizeof(State) + kept_bytes(); }
  size_t kept_bytes() const override { return simmers() ? sizeof(int64_t) : 0; }
  void check_state(const void* state) const override;
  void reset(World& world, void* state, Stream& stream) const override;
  void redraw(World& world, Stream& stream) const override { inner_.redraw(world, stream); }
  void control(World& world, void* state, const float* action) const override {
    inner_.control(world, state, action);
  }
  Verdict judge(World& world, void* state, int32_t step) const override;
  void observe(const World& world, const void* state, float* obs) const override;
  bool takes_rows() const override { return inner_.takes_rows(); }
  void reset_rows(const TaskRows& rows) const override;
  void control_rows(const TaskRows& rows) const override { inner_.control_rows(rows); }
  void judge_rows(const TaskRows& rows) const override;
  void observe_rows(const TaskRows& rows) const override;
  float obs_limit() const override { return inner_.obs_limit(); }
  Vec3 focus(const World& world, const void* state) const override { return inner_.focus(world, state); }
  bool has_goal() const override { return inner_.has_goal(); }
  Pose goal_pose(const void* state) const override { return inner_.goal_pose(state); }
  const Vector<CameraSpec>& mounted_cameras() const override { return inner_.mounted_cameras(); }
  void hold_action(float* action) const override { inner_.hold_action(action); }
  void initial_mean(float* action) const override { inner_.initial_mean(action); }
  bool guard_at(int32_t i, Guard* guard, float* normal) const override {
    return inner_.guard_at(i, guard, normal);
  }
  int32_t action_of(int32_t joint) const override { return inner_.action_of(joint); }
  bool draws_limit() const override { return budget_.limit < 0; }
  double limit(const void* state) const override;

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
  void show(const void* state, float* out) const;

  const Task& inner_;
  Budget budget_;
  FieldTable fields_;
  size_t offset_ = 0;      // of State
  int32_t inner_dim_ = 0;  // entries of the inner task's row
  double scale_ = 1;       // of a limit, where the budget is discounted
};

}  // namespace rdm

// A task around a task, which adds to the inner one's row: all that is not said here is the inner task's.
#pragma once
#include <cstring>

#include "env/fields.hpp"

namespace rdm {

class TaskAround : public Task {
 public:
  const Scene& scene() const override { return inner_.scene(); }
  EngineKind engine() const override { return inner_.engine(); }
  int32_t max_steps() const override { return inner_.max_steps(); }
  int32_t action_dim() const override { return inner_.action_dim(); }
  const Vector<FieldSpec>& fields() const override { return fields_; }
  const char* action_order() const override { return inner_.action_order(); }
  size_t state_bytes() const override { return inner_.state_bytes(); }
  size_t kept_bytes() const override { return inner_.kept_bytes(); }
  void check_state(const void* state) const override { inner_.check_state(state); }
  void reset(World& world, void* state, Stream& stream) const override { inner_.reset(world, state, stream); }
  void redraw(World& world, Stream& stream) const override { inner_.redraw(world, stream); }
  void control(World& world, void* state, const float* action) const override {
    inner_.control(world, state, action);
  }
  Verdict judge(World& world, void* state, int32_t step) const override {
    return inner_.judge(world, state, step);
  }
  void observe(const World& world, const void* state, float* obs) const override {
    inner_.observe(world, state, obs);
    show(world, state, obs + inner_dim_);
  }
  bool takes_rows() const override { return inner_.takes_rows(); }
  void reset_rows(const TaskRows& rows) const override { inner_.reset_rows(rows); }
  void control_rows(const TaskRows& rows) const override { inner_.control_rows(rows); }
  void judge_rows(const TaskRows& rows) const override { inner_.judge_rows(rows); }
  // The inner task's rows stand close together at first; the last one moves first.
  void observe_rows(const TaskRows& rows) const override {
    inner_.observe_rows(rows);
    const auto inner = static_cast<size_t>(inner_dim_), width = static_cast<size_t>(field_total(fields_));
    for (auto i = static_cast<size_t>(rows.count); i-- > 0;) {
      float* const row = rows.obs + i * width;
      std::memmove(row, rows.obs + i * inner, inner * sizeof *row);
      show(*rows.worlds[i], rows.states[i], row + inner);
    }
  }
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
  bool group_set_at(int32_t i, const char** key, const char** list) const override {
    return inner_.group_set_at(i, key, list);
  }
  const DynamicsDraws* draws() const override { return inner_.draws(); }
  bool draws_limit() const override { return inner_.draws_limit(); }
  double limit(const void* state) const override { return inner_.limit(state); }
  void set_limit(void* state, double limit, float* obs) const override {
    inner_.set_limit(state, limit, obs);
  }
  int32_t action_of(int32_t joint) const override { return inner_.action_of(joint); }

 protected:
  // The inner task must outlive it.
  explicit TaskAround(const Task& inner) : inner_(inner), inner_dim_(obs_dim(inner)) {
    for (const FieldSpec& f : inner.fields()) fields_.push_back(f);
  }
  // What stands behind the inner task's row.
  virtual void show(const World& world, const void* state, float* out) const = 0;
  const Task& inner() const { return inner_; }
  FieldTable& own_fields() { return fields_; }
  int32_t inner_dim() const { return inner_dim_; }

 private:
  const Task& inner_;
  FieldTable fields_;
  int32_t inner_dim_;
};

}  // namespace rdm

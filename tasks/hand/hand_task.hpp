// What every task of hands shares: the scene, the control of the hands, and where its bytes are in a world's
// state.
#pragma once
#include "env/task.hpp"
#include "tasks/hand/hand_control.hpp"
#include "tasks/hand/hand_teams.hpp"
#include "tasks/hand/shape_pairs.hpp"

namespace rdm {

class HandTask : public Task {
 public:
  const Scene& scene() const override { return scene_; }
  EngineKind engine() const override { return engine_; }
  int32_t max_steps() const override { return max_steps_; }
  int32_t action_dim() const override { return hands_.action_dim(); }
  const Vector<FieldSpec>& fields() const override { return fields_; }
  const char* action_order() const override { return hands_.action_order(); }
  int32_t action_of(int32_t joint) const override { return hands_.action_of(joint); }
  bool group_set_at(int32_t i, const char** key, const char** list) const override {
    return teams_.set_at(i, key, list);
  }
  size_t state_bytes() const override { return own_bytes_ + hands_.state_bytes(); }
  void control(World& world, void* state, const float* action) const override {
    hands_.control(world, control_state(state), action);
  }
  void redraw(World& world, Stream& stream) const override { hands_.redraw(world, stream); }
  const DynamicsDraws* draws() const override { return hands_.draws(); }
  void check_state(const void* state) const final {
    check_own_state(state);
    hands_.check_state(static_cast<const char*>(state) + own_bytes_);
  }
  float obs_limit() const override { return 5; }
  void hold_action(float* action) const override { hands_.hold(action); }
  // "right_palm" and "left_palm": at the wrist, before the palm, towards what the fingers hold.
  const Vector<CameraSpec>& mounted_cameras() const override { return cameras_; }

 protected:
  // `own_bytes` of a task's own state stand before those of the hands' control, which begin with doubles:
  // Error(kInternal) unless it is a multiple of 8.
  HandTask(const HandControlConfig& config, const Options& options, int32_t max_steps, HandScene scene,
           size_t own_bytes);

  // check_state of the task's own part.
  virtual void check_own_state(const void* state) const = 0;

  const HandControl& hands() const { return hands_; }
  HandControl& hands() { return hands_; }
  HandControlState control_state(void* state) const {
    return hands_.state(static_cast<char*>(state) + own_bytes_);
  }
  // The row of the last step.
  const float* last_action(const void* state) const {
    return hands_.action(static_cast<const char*>(state) + own_bytes_);
  }
  FieldTable& own_fields() { return fields_; }
  // Whether hand i is the mirror image of its robot's tables: a left one, but those of one on an arm are
  // mirrored already.
  bool mirrors(int32_t i) const { return mirrors_[i]; }
  // A point of the palm's link, as the robot's tables have it, in the frame of what carries it here: that
  // link, or the hand's base.
  Vec3 palm_point(int32_t i, const Vec3& p) const;

 private:
  CameraSpec palm_camera(int32_t i) const;

  EngineKind engine_;
  int32_t max_steps_;
  size_t own_bytes_;
  HandScene made_;  // but for what went into scene_
  Scene scene_;
  HandControl hands_;
  HandTeams teams_;
  FieldTable fields_;
  bool mirrors_[kMaxHands] = {};
  Vector<CameraSpec> cameras_;
};

}  // namespace rdm

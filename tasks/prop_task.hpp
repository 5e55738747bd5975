// A task of two flying hands and loose things that start at rest: everything but what they are for.
#pragma once
#include <algorithm>

#include "env/task.hpp"
#include "tasks/hand_rig.hpp"

namespace rdm {

// Options that such tasks have beside those of their hands.
void add_prop_options(const RigPlan& plan, int32_t max_steps, int32_t contacts_max, OptionTable& table);

class PropTask : public Task {
 public:
  const Scene& scene() const override { return scene_; }
  EngineKind engine() const override { return engine_; }
  int32_t max_steps() const override { return max_steps_; }
  int32_t action_dim() const override { return rig_.action_dim(); }
  const Vector<FieldSpec>& fields() const override { return fields_; }
  const char* action_order() const override { return rig_.action_order(); }
  size_t state_bytes() const override { return own_bytes_ + rig_.state_bytes(); }
  // Bodies stand where the scene has them, moved by reset_noise; then start() follows.
  void reset(World& world, void* state, Stream& stream) const override;
  void control(World& world, void* state, const float* action) const override;
  void observe(const World& world, const void* state, float* obs) const override;
  float obs_limit() const override { return 5; }
  void hold_action(float* action) const override { rig_.hold(action); }
  void initial_mean(float* action) const override { rig_.hold(action); }

 protected:
  // `own_bytes` of a task's own state, a multiple of 8, stand before the rig's.
  PropTask(const RigPlan& plan, const Options& options, SceneDef scene, size_t own_bytes);
  // Moves bodies by draws of up to reset_noise() along x and y; unless a task knows better, all the same way.
  virtual void draw_places(World& world, Stream& stream) const;
  virtual void start(World& world, void* state) const = 0;
  virtual float* write_props(const World& world, const void* state, float* out) const = 0;

  const HandRig& rig() const { return rig_; }
  double reset_noise() const { return reset_noise_; }
  FieldTable& own_fields() { return fields_; }
  // Origin of the distal link's frame moved by `beyond` m along the finger: 0 to 4 for first finger to thumb.
  Vec3 tip(const World& world, int32_t hand, int32_t finger, double beyond) const;
  // The point 0.08 m along the fingers and 0.02 m before the palm.
  Vec3 palm(const World& world, int32_t hand) const;
  int32_t palm_link(int32_t hand) const { return palms_[hand]; }
  // Pairs in which one shape is of the first kind and the other of the second.
  template <class A, class B>
  Vector<int32_t> pairs_between(A&& first, B&& second) const;
  bool of_hand(const SceneShape& shape) const { return shape.articulation >= 0; }

 private:
  EngineKind engine_;
  int32_t max_steps_;
  double reset_noise_, joint_noise_;
  size_t own_bytes_;
  Scene scene_;
  HandRig rig_;
  int32_t palms_[kMaxHands];
  Vec3 palm_points_[kMaxHands];
  FieldTable fields_;
};

template <class A, class B>
Vector<int32_t> PropTask::pairs_between(A&& first, B&& second) const {
  Vector<int32_t> out;
  for (size_t i = 0; i < scene_.pairs.size(); ++i) {
    const SceneShape &a = scene_.shapes[static_cast<size_t>(scene_.pairs[i].a)],
                     &b = scene_.shapes[static_cast<size_t>(scene_.pairs[i].b)];
    if ((first(a) && second(b)) || (first(b) && second(a))) out.push_back(static_cast<int32_t>(i));
  }
  return out;
}

}  // namespace rdm

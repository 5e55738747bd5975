// A task of two flying hands and loose things that start at rest: everything but what they are for.
//
// ReDMan B.1 draws "the object's starting pose and target pose" anew in every episode; it gives no widths.
// Here option reset_noise is a few millimetres, each task's own default, as wide as its demonstration
// carries; reset_noise=0 is the nominal start, the same each time.
#pragma once
#include "tasks/hand/hand_task.hpp"

namespace rdm {

// Options that such tasks have beside those of their hands.
void add_prop_options(const HandControlConfig& config, int32_t max_steps, int32_t contacts_max,
                      OptionTable& table);

struct PropOptions {
  int32_t max_steps;
  double reset_noise, joint_noise;  // m, share of a joint's range
};

class PropTask : public HandTask {
 public:
  // Bodies stand where the scene has them, moved by reset_noise; then start() follows.
  void reset(World& world, void* state, Stream& stream) const override;
  void observe(const World& world, const void* state, float* obs) const override;
  void initial_mean(float* action) const override { hands().hold(action); }

 protected:
  // `own_bytes` of a task's own state, a multiple of 8, stand before the control's.
  PropTask(const HandControlConfig& config, const Options& options, HandScene scene, size_t own_bytes);
  // Moves bodies by draws of up to reset_noise() along x and y; unless a task knows better, all the same way.
  virtual void draw_places(World& world, Stream& stream) const;
  virtual void start(World& world, void* state) const = 0;
  virtual float* write_props(const World& world, const void* state, float* out) const = 0;

  double reset_noise() const { return options_.reset_noise; }
  // Origin of the distal link's frame moved by `beyond` m towards the finger's end.
  Vec3 tip(const World& world, int32_t hand, int32_t finger, double beyond) const;
  // The point before the palm where a held thing is: Robot::p_hold.
  Vec3 palm(const World& world, int32_t hand) const;
  // Acts during the next step on whatever carries the palm, at p.
  void push_palm(World& world, int32_t hand, const Vec3& force, const Vec3& p_W) const;
  static bool of_hand(const SceneShape& shape) { return shape.articulation >= 0; }

 private:
  PropOptions options_;
  int32_t palms_[kMaxHands];
  Vec3 palm_points_[kMaxHands];
  Vec3 tip_axes_[kMaxHands][kMaxHandTips];  // unit, from a distal link's origin to its end, in the link
};

}  // namespace rdm

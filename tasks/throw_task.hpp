// A task in which the right hand throws an object to the left one: everything but its costs.
#pragma once
#include <iterator>

#include "env/task.hpp"
#include "tasks/hand_rig.hpp"
#include "tasks/throw_game.hpp"

namespace rdm {

// The words of one task.
struct ThrowPlan {
  RigPlan rig;
  ObjectPlace place;
  double fall_height;     // m, default of the option
  double base_limit = 0;  // m, likewise, of flying hands
};

void add_throw_task_options(const ThrowPlan& plan, OptionTable& table);
// Hands, ground and object.
SceneDef make_throw_scene(const ThrowPlan& plan, const Options& options,
                          int32_t num_materials = kOwnMaterial);

// The pose from which a throw from hand to hand is learned: the right hand flat and both wrists raised, thumb
// and left hand at the middle of their ranges; with `window` the first finger bent into its cost window.
// `mean` is a row of zeros.
void flat_throw_mean(const HandRig& rig, bool window, float* mean);

class ThrowTask : public Task {
 public:
  const Scene& scene() const override { return scene_; }
  EngineKind engine() const override { return engine_; }
  int32_t max_steps() const override { return max_steps_; }
  int32_t action_dim() const override { return rig_.action_dim(); }
  const Vector<FieldSpec>& fields() const override { return fields_; }
  const char* action_order() const override { return rig_.action_order(); }
  size_t state_bytes() const override { return sizeof(State) + rig_.state_bytes(); }
  void reset(World& world, void* state, Stream& stream) const override;
  void control(World& world, void* state, const float* action) const override;
  Verdict judge(World& world, void* state, int32_t step) const override;
  void observe(const World& world, const void* state, float* obs) const override;
  float obs_limit() const override { return 5; }
  void hold_action(float* action) const override { rig_.hold(action); }
  void initial_mean(float* action) const override {
    std::copy(std::begin(initial_mean_), std::begin(initial_mean_) + action_dim(), action);
  }

 protected:
  // What a cost is judged by. The commands in [-1, 1] and the actions are those of the step.
  struct Step {
    const World& world;
    const double* command;  // [2][kHandActions]
    const float* action;    // [action_dim]
    Release* release;
  };
  ThrowTask(const ThrowPlan& plan, const Options& options, SceneDef scene);
  virtual void judge_costs(const Step& step, Verdict* verdict) const = 0;

  const HandRig& rig() const { return rig_; }
  const ThrowGame& game() const { return game_; }
  float initial_mean_[kMaxRigActions] = {};

 private:
  // The rig's bytes follow.
  struct State {
    ThrowState game;
    Release release;
  };
  EngineKind engine_;
  int32_t max_steps_;
  double base_limit_;
  Scene scene_;
  HandRig rig_;
  ThrowGame game_;
  FieldTable fields_;
};

}  // namespace rdm

// A task in which the right hand throws an object to the left one: everything but its costs.
#pragma once
#include <iterator>

#include "tasks/hand/hand_task.hpp"
#include "tasks/throw/throw_setup.hpp"

namespace rdm {

// The words of one task.
struct ThrowConfig {
  HandControlConfig rig;
  ObjectPlace place;
  double fall_height;     // m, default of the option
  double base_limit = 0;  // m, likewise, of flying hands
};

void add_throw_task_options(const ThrowConfig& plan, OptionTable& table);
// Hands, ground and object.
SceneDef make_throw_scene(const ThrowConfig& plan, const Options& options,
                          int32_t num_materials = kOwnMaterial);

// Poses from which throws are learned, into a row of zeros: the right hand flat, thumb and left hand at the
// middle of their ranges; with `window` the first finger bent into its cost window.
void flat_hand_mean(const HandControl& rig, bool window, float* mean);
// The same with both wrists raised: for a throw from hand to hand.
void flat_throw_mean(const HandControl& rig, bool window, float* mean);

class ThrowTask : public HandTask {
 public:
  void reset(World& world, void* state, Stream& stream) const override;
  Verdict judge(World& world, void* state, int32_t step) const override;
  void observe(const World& world, const void* state, float* obs) const override;
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
  ThrowTask(const ThrowConfig& plan, const Options& options, SceneDef scene);
  void check_own_state(const void* state) const override;
  virtual void judge_costs(const Step& step, Verdict* verdict) const = 0;

  const ThrowSetup& game() const { return game_; }
  // Where learning starts, by the word of option initial_mean: hold, zero, else `flat`.
  void choose_mean(const char* word, void (*flat)(const HandControl&, bool, float*), bool window);

 private:
  // The rig's bytes follow.
  struct State {
    ThrowState game;
    Release release;
  };
  double base_limit_;
  ThrowSetup game_;
  float initial_mean_[kMaxRigActions] = {};
};

}  // namespace rdm

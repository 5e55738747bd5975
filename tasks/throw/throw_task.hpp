// A task in which the right hand throws an object to the left one: everything but its costs.
//
// Each step pays r = exp(-0.2 (50 d + theta)) of the object's distance d, m, and rotation theta, rad, to the
// goal (ReDMan eq. B1); an episode ends with the object below fall_height or after 75 steps.
#pragma once
#include <iterator>

#include "tasks/hand/hand_task.hpp"
#include "tasks/throw/throw_setup.hpp"

namespace rdm {

// What one task sets.
struct ThrowConfig {
  HandControlConfig hands;
  ObjectPlace place;
  double fall_height;     // m, default of the option
  double base_limit = 0;  // m, likewise, of flying hands
};

void add_throw_task_options(const ThrowConfig& config, OptionTable& table);
// Hands, ground and object.
HandScene make_throw_scene(const ThrowConfig& config, const Options& options,
                           int32_t num_materials = kOwnMaterial);

// The right first finger in a pose that learning starts from: flat as the others, bent into the paper's
// windows, or as the task's start has it.
enum class FirstFinger { kFlat, kBent, kStart };
// Poses from which throws are learned, into a row of hold_arms: the right hand flat but for its first finger,
// thumb and left hand at the middle of their ranges.
void flat_hand_mean(const HandControl& hands, FirstFinger first, float* mean);
// The same with both wrists raised: for a throw from hand to hand.
void flat_throw_mean(const HandControl& hands, FirstFinger first, float* mean);

// Words of option initial_mean: where learning starts. A task has some of them.
enum class ThrowMean { kAuto, kFlat, kWindow, kHold, kZero };

class ThrowTask : public HandTask {
 public:
  void reset(World& world, void* state, Stream& stream) const override;
  Verdict judge(World& world, void* state, int32_t step) const override;
  void observe(const World& world, const void* state, float* obs) const override;
  void initial_mean(float* action) const override {
    std::copy(std::begin(initial_mean_), std::begin(initial_mean_) + action_dim(), action);
  }
  bool has_goal() const override { return true; }
  Pose goal_pose(const void* state) const override {
    return {setup_.goal, static_cast<const State*>(state)->progress.goal};
  }

 protected:
  // What a cost is judged by. The commands in [-1, 1] and the actions are those of the step.
  struct Step {
    const World& world;
    const double* command;  // [2][num_actions]
    const float* action;    // [action_dim]
    Release* release;
  };
  ThrowTask(const ThrowConfig& config, const Options& options, HandScene scene);
  void check_own_state(const void* state) const override;
  virtual void judge_costs(const Step& step, Verdict* verdict) const = 0;

  const ThrowSetup& setup() const { return setup_; }
  // Where learning starts: hold, zero, else `flat`.
  void choose_mean(ThrowMean mean, void (*flat)(const HandControl&, FirstFinger, float*), FirstFinger first);

 private:
  // The bytes of the hands' control follow.
  struct State {
    ThrowState progress;
    Release release;
  };
  double base_limit_;
  ThrowSetup setup_;
  float initial_mean_[kMaxHandActions] = {};
};

}  // namespace rdm

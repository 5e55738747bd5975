// A task of one right hand on a fixed base and one object: everything but reward, costs and success. The
// observation has an order of its own: joints, object and goal, fingertips, action.
#pragma once
#include "tasks/hand/hand_task.hpp"
#include "tasks/hand/object_goal.hpp"

namespace rdm {

// What one task sets.
struct SingleHandConfig {
  HandControlConfig hands;
  ObjectPlace place;
  double joint_noise;
};

void add_single_hand_options(const SingleHandConfig& config, OptionTable& table);

class SingleHand : public HandTask {
 public:
  void reset(World& world, void* state, Stream& stream) const override;
  Verdict judge(World& world, void* state, int32_t step) const override;
  void observe(const World& world, const void* state, float* obs) const override;
  void initial_mean(float* action) const override;
  bool has_goal() const override { return true; }
  Pose goal_pose(const void* state) const override {
    return {goal_.goal, static_cast<const State*>(state)->goal.goal};
  }

 protected:
  // One world's part. The bytes of the hand's control follow.
  struct State {
    GoalState goal;
    Stream goals;  // of goals drawn within an episode
  };
  // What a step is judged by.
  struct Step {
    const World& world;
    const double* command;  // [num_actions] in [-1, 1]
    const float* action;    // [num_actions]
    State* state;
  };
  // state_size: of a task's own state, which begins with a State.
  SingleHand(const SingleHandConfig& config, const Options& options, size_t state_size = sizeof(State));
  void check_own_state(const void* state) const override;
  virtual void judge_step(const Step& step, Verdict* verdict) const = 0;

  const Hand& hand() const { return hands().hand(0); }
  const ObjectGoal& goal() const { return goal_; }
  float initial_mean_[kMaxHandActions] = {};

 private:
  double joint_noise_;
  ObjectGoal goal_;
};

}  // namespace rdm

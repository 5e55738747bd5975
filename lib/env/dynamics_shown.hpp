// What worlds draw at their resets as fields of the observation (option show_dynamics): for each option with a range, or
// that level draws, a number in [-1, 1], where in its range the world's factor lies; and so for action_delay.
//
//   dynamics.OPTION = 2 (f - low) / (high - low) - 1        f: the factor on what the scene was made with
//
// Factors are read back from the world, so what redraws them, or a saved state, shows what the world has. Those of a
// machine that is not simulated are not known: a policy that observes them is a teacher (pages students and memory).
#pragma once
#include "base/option_rows.hpp"
#include "env/dynamics_draw.hpp"
#include "env/options/disturb.hpp"
#include "env/task_around.hpp"

namespace rdm {

struct DynamicsOptions {
  bool show = false;
};
// The rows, static.
const OptionSpec* dynamics_options(int32_t* count);
bool shows_dynamics(const Options& options);
// Joins the rows that were given another value than their default.
uint64_t hash_dynamics(const Options& options, uint64_t hash);

class DynamicsTask final : public TaskAround {
 public:
  // Error(kArgument) where nothing is drawn. Says in plan where a drawn action_delay is shown.
  DynamicsTask(const Task& inner, Disturbance& plan, const char* owner);

 protected:
  void show(const World& world, const void* state, float* out) const override;

 private:
  Vector<DynamicsDraws::Shown> shown_;
  bool delay_ = false;
};

}  // namespace rdm

// Whole episodes, counted without favour to short ones: every world plays a fixed share of them.
#pragma once
#include <functional>
#include <vector>

#include "play/actor.hpp"
#include "play/trouble.hpp"

namespace tool {

inline constexpr int32_t kMostEpisodes = 1'000'000;

struct Episode {
  double ret = 0;             // sum of rewards
  std::vector<double> cost;   // [cost_dim] sums
  int32_t length = 0;         // control steps
  bool terminated = false;    // a fall
  int32_t success_steps = 0;  // in which the task's success held; of reorient: goals
  Trouble trouble;
};

// Called around each control step of world `env` in its episode number `episode`.
using StepObserver = std::function<void(size_t env, size_t episode)>;

// Plays `count` episodes in a pool without autoreset that was just reset. Episode e is played by world
// e mod num_envs; a world that has done its share rests. The result does not depend on threads. `before`
// finds the actions in the pool, `after` what came of them. With `magnitudes` costs are sums of cost_raw
// where it is above 0, as an agent with cost_signal=raw learns them.
std::vector<Episode> play_episodes(redman::Pool& pool, Actor& actor, size_t count,
                                   const StepObserver& after = {}, const StepObserver& before = {},
                                   bool magnitudes = false);

struct Summary {
  double return_mean = 0, return_std = 0, length_mean = 0, fall_rate = 0;
  double success_rate = 0;    // share of episodes with success at least once
  double success_steps = 0;   // of an episode
  double violation_rate = 0;  // share of episodes over a limit
  double cost_per_step = 0;   // column 0
  double return_stderr = 0;   // of return_mean; so below
  std::vector<double> cost_mean, cost_std, cost_stderr;
  Trouble trouble;  // of all episodes
};
// Standard deviations are of the population, standard errors of the mean from the sample's, NaN for one
// episode. limits [cost_dim], < 0: none.
// An episode that trouble ended is a violation and no success; what it summed up to then is no measurement,
// and all else is of the other episodes, NaN where there are none.
Summary summarise(const std::vector<Episode>& episodes, const std::vector<double>& limits);

// Every limited column's mean is at or below its limit, and trouble ended no episode.
bool feasible(const Summary& summary, const std::vector<double>& limits);

}  // namespace tool

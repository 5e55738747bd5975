// Which policy of a run is kept.
#pragma once
#include <cstdint>
#include <vector>

#include "play/episodes.hpp"

namespace tool {

// Of an evaluation during training; a policy that looks better than the best so far plays as many again
// kConfirmations times, and those alone say whether it is.
inline constexpr size_t kSelectionEpisodes = 20, kConfirmations = 4;

// How good an evaluation was. Feasible before infeasible; feasible by return, infeasible by column costs.
struct Score {
  bool feasible = false;
  double ret = 0, excess = 0;  // excess: sum over limited columns of cost above the limit, as a share of it
  bool better_than(const Score& other) const;
};

// A cost counts as its mean and a standard error of it: the best of many noisy evaluations is one that came
// out too low, and a mean that is allowed to stand on the limit then is truly over it. limits [cost_dim], <
// 0: none.
Score score_of(const Summary& summary, const std::vector<double>& limits);

// The seed of an episode that policies of a run are chosen by: kSelectionEpisodes to look, then those that
// confirm. No report and no other run plays it: what the best of many is chosen by says too much good of it.
// Seeds of people and reports are below all of these.
uint64_t selection_seed(uint64_t run_seed, size_t episode);

}  // namespace tool

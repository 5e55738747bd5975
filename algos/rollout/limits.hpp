// What limits are held against in one epoch.
//
// A limit is on the sum of a cost over an episode: J_c, the mean of the last finished ones. An environment
// that never ends has no such sum, and nothing is not 0. So, for each limited cost:
//   sums that end           episodes end by themselves, or the agent closes one at episode_steps or max_steps
//                           control steps: J_c as ever, known from the first one on
//   cost_limit_per_step     J_c is the epoch's mean cost per control step times kRateSteps, or times the
//                           length that is known; the limit likewise. So rates of multipliers and penalties
//                           keep their unit
//   neither, no end so far  an episode is at least as long as those that run: J_c is the epoch's cost per
//                           step times their mean length. That bounds J_c from below, so it is known only
//                           where it is above the limit
// While a cost is not known multipliers and slopes stay as they are, and constrained steps take the policy to
// be at the limit, so that they may not raise its cost.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "algos/rollout/episodes.hpp"

namespace rdm {

// Of the decisions of one epoch, all ranks'.
struct EpochTotals {
  static constexpr int32_t kStatusKinds = 6;  // bits of RDM_STATUS_*
  double cost[kMaxCosts] = {};                // sum of each column
  double steps = 0;                           // control steps
  double running = 0;                         // mean length of the episodes that run now
  int64_t invalid = 0, cut = 0;               // rows; episodes that the agent closed
  int64_t status[kStatusKinds] = {};          // decisions with each bit

  double rate(int32_t column) const { return steps > 0 ? cost[column] / steps : kNothing; }
};

// Of limited cost i, [num_limited].
struct JudgedCosts {
  int32_t count = 0;
  bool known[kMaxCosts] = {};
  bool fresh[kMaxCosts] = {};  // there is something new to judge by
  double cost[kMaxCosts] = {}, limit[kMaxCosts] = {};
  double steps[kMaxCosts] = {};  // control steps that the sum is over
  // The limit is 0 and no decision of this epoch cost anything, nor an episode of the window if the epoch is
  // shorter than one. As costs are not negative the policy is at their minimum, where the gradient of its cost
  // is 0: an estimate of that would be the critic's error alone.
  bool spotless[kMaxCosts] = {};

  bool any_known() const {
    return std::any_of(known, known + count, [](bool k) { return k; });
  }
  double excess(int32_t i) const { return cost[i] - limit[i]; }  // where it is known
};

// A limit is set for which neither ends nor a length nor a rate are known.
bool lacks_length(const ResolvedAgentConfig& resolved, const EpisodeStats& stats);
JudgedCosts judge(const ResolvedAgentConfig& resolved, const EpisodeStats& stats, const EpochTotals& totals);

}  // namespace rdm

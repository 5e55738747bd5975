#include "algos/rollout/limits.hpp"

namespace rdm {

bool lacks_length(const ResolvedAgentConfig& resolved, const EpisodeStats& stats) {
  if (stats.finished > 0 || resolved.episode_steps > 0) return false;
  return resolved.num_limited > (resolved.rate_steps > 0 ? 1 : 0);
}

JudgedCosts judge(const ResolvedAgentConfig& resolved, const EpisodeStats& stats, const EpochTotals& totals) {
  JudgedCosts j;
  j.count = resolved.num_limited;
  for (int32_t i = 0; i < j.count; ++i) {
    const int32_t k = resolved.column[i];
    j.limit[i] = resolved.limit[i];
    if (k == 0 && resolved.rate_steps > 0) {
      j.known[i] = j.fresh[i] = totals.steps > 0;
      j.steps[i] = resolved.rate_steps;
      if (j.known[i]) j.cost[i] = totals.rate(k) * j.steps[i];
    } else if (stats.finished > 0) {
      j.known[i] = true;
      j.fresh[i] = stats.fresh;
      j.cost[i] = stats.charged_cost[k];
      j.steps[i] = stats.length;
    } else if (lacks_length(resolved, stats) && totals.steps > 0) {
      j.cost[i] = totals.rate(k) * totals.running;
      j.steps[i] = totals.running;
      j.known[i] = j.fresh[i] = j.cost[i] > j.limit[i];
    }
    const bool whole = totals.steps >= j.steps[i] * resolved.all_envs();
    j.spotless[i] = j.known[i] && j.limit[i] == 0 && totals.cost[k] == 0 && (whole || j.cost[i] == 0);
  }
  return j;
}

}  // namespace rdm

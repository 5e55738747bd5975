#include "run/score.hpp"

#include <algorithm>
#include <limits>

namespace tool {

bool Score::better_than(const Score& other) const {
  if (feasible != other.feasible) return feasible;
  return feasible ? ret > other.ret : excess < other.excess;
}

Score score_of(const Summary& s, const std::vector<double>& limits) {
  if (s.trouble.lost()) return {false, s.return_mean, std::numeric_limits<double>::infinity()};
  Score score{true, s.return_mean, 0};
  for (size_t k = 0; k < limits.size(); ++k) {
    if (limits[k] < 0) continue;
    const double over = s.cost_mean[k] + s.cost_stderr[k] - limits[k];
    score.feasible = score.feasible && over <= 0;
    score.excess += std::max(0.0, over) / std::max(limits[k], 1.0);
  }
  return score;
}

uint64_t selection_seed(uint64_t run_seed, size_t episode) {
  constexpr uint64_t kFirst = uint64_t{1} << 63;
  return kFirst | (run_seed * (kSelectionEpisodes * (1 + kConfirmations)) + episode);
}

}  // namespace tool

// What the means of episodes do not say: how far they can be trusted, and how bad the bad episodes are.
#pragma once
#include <string>
#include <vector>

#include "common/report.hpp"
#include "common/statistics.hpp"
#include "play/episodes.hpp"

namespace tool {

inline constexpr double kReturnQuantiles[] = {0.1, 0.5, 0.9}, kCostQuantiles[] = {0.5, 0.9, 0.99};
// Of more episodes than these the interval of a mean is that of the normal law, which the bootstrap's then is.
inline constexpr size_t kMostResampled = 2000;
// So many are asked for where a cost's deviation is above its limit.
inline constexpr int32_t kManyEpisodes = 1000;

// Of episodes that were measurements; NaN where there are none.
struct Spread {
  double return_iqm = 0, success_stderr = 0;
  Interval return_interval{};  // 95 %, of the mean; NaN where there is one episode or all are the same
  std::vector<double> return_quantiles;  // of kReturnQuantiles
  struct Cost {
    Interval interval{};            // likewise
    std::vector<double> quantiles;  // of kCostQuantiles
    double cvar = 0;                // mean of the worst tenth of the episodes
    double over = 0;                // share of episodes over its limit, NaN without one
  };
  std::vector<Cost> costs;  // [cost_dim]
};

// Episodes that trouble ended are in no number but `over`, as over every limit, and success_stderr.
Spread spread_of(const std::vector<Episode>& episodes, const std::vector<double>& limits);

// What a reader is to know of numbers that are not there or mean little, a sentence each. `costs` are names.
std::vector<std::string> remarks_of(const Summary& summary, const Spread& spread,
                                    const std::vector<double>& limits, const std::vector<std::string>& costs,
                                    int32_t episodes);

// "34.300 +- 0.54": a mean and its standard error, where there is one.
std::string measured(double mean, double error);

void put_spread(Json& json, const Spread& spread);

}  // namespace tool

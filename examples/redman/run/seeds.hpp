// What the runs of a configuration say together, which differ in their seeds alone.
#pragma once
#include <string>
#include <vector>

#include "common/statistics.hpp"
#include "run/comparison.hpp"

namespace tool {

// NaN where there is too little: one run, an evaluation without a measurement, a column that runs do not have.
struct Seeds {
  double return_mean = 0, return_sd = 0, return_iqm = 0;
  Interval return_interval{};  // 95 %, of the interquartile mean
  double normalised_return =
      0;  // over the mean of the runs of PPO without a shield; NaN where it is not above 0
  std::vector<double> cost_sd;          // [costs]
  std::vector<double> cost_ratio;       // [costs] mean over limit, NaN without a limit or with one of 0
  double training_cost_rate = 0;        // mean over seeds of column 0 per control step, all of training
  double training_violating_steps = 0;  // likewise
  std::string group;                    // letters by return: group_letters(); "" for one run
};

// Of each configuration; a configuration's outcomes are those of its runs.
std::vector<Seeds> seeds_of(const std::vector<Configuration>& configurations);

}  // namespace tool

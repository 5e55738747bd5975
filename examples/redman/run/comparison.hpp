// Runs side by side: which are seeds of one configuration, how configurations differ, and how good each is.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "run/run_data.hpp"
#include "run/score.hpp"

namespace tool {

struct CostOutcome {
  std::string name;
  double limit = -1;  // < 0: none
  double mean = 0;    // of an episode
};

// What came of one run, or of several the mean.
struct Outcome {
  bool evaluated = false;  // fresh episodes on the mean action; else the last tenth of training
  double ret = 0, success = 0, falls = 0, length = 0;
  std::vector<CostOutcome> costs;  // column 0 first
  Trouble trouble;                 // of the episodes that evaluate
  // Every limited column's mean is at or below its limit, and trouble ended no episode; feasible before
  // infeasible, then as policies are chosen.
  Score score() const;
};

// The last tenth of a run's training.
struct TrainingEnd {
  double ret = 0, cost = 0;  // means over epochs, column 0
  double over = 0;           // share of epochs over a limit
  double steps = 0, seconds = 0;
};

// Costs with their limits, by the names of the curve's columns, column 0 first. Their means are those of the
// last tenth of training.
std::vector<CostOutcome> cost_columns_of(const RunData& run);
Outcome training_outcome(const RunData& run);
TrainingEnd training_end(const RunData& run);

struct Configuration {
  std::string label;         // algorithm, and what tells it from others of that algorithm
  bool limit_named = false;  // the label has the limit on column 0
  std::vector<const RunData*> runs;
  std::vector<Outcome> outcomes;  // of the runs
  size_t color = 0;
  Outcome mean() const;
};

// In the order of the runs, which are of one task.
std::vector<Configuration> group_runs(const std::vector<const RunData*>& runs);
// Best first; colours are given in that order.
void rank(std::vector<Configuration>& configurations);

struct Difference {
  std::string key;                  // of FlatConfig
  std::vector<std::string> values;  // of each configuration, "" where it has none
};
std::vector<Difference> differences(const std::vector<Configuration>& configurations);

}  // namespace tool

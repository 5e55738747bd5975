// progress.csv, a row for each epoch: written with names as the ecosystem's plotters look them up, and read.
#pragma once
#include <redman/redman.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace tool {

// The last evaluation on the mean action; NaN before the first.
struct LastEvaluation {
  double ret, cost;
};

// Seconds; the only columns that differ between two runs of the same settings.
struct EpochTimes {
  double epoch = 0;       // collecting and learning
  double evaluation = 0;  // 0 when there was none
  double total = 0;       // since the run began, over all its processes
};

// A cost column: its name, and whether it has a limit and so perhaps a multiplier.
struct CostColumn {
  std::string name;
  bool limited;
};

// Column 0 has the bare name, the others "/<name>".
std::string curve_header(const std::vector<CostColumn>& costs);
// In the order of `header`, which is that of the run's file: a run may go on that an older version began.
// Numbers have nine digits; means over episodes are nan before the first one ends, and what this version does
// not know is.
std::string curve_row(const std::string& header, const std::vector<CostColumn>& costs, const rdm_epoch& e,
                      int64_t steps_in_epoch, const LastEvaluation& evaluation, const EpochTimes& times);

// Columns by name, all of one length; NaN where a cell is no number or beyond +-1e100. A row of another
// length, such as a last one that is cut short, is left out. Failure when a name stands twice.
using Columns = std::map<std::string, std::vector<double>>;
Columns parse_progress(const char* text, size_t size);

}  // namespace tool

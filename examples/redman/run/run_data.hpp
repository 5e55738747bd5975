// What a finished or running training left in its folder, as numbers to plot.
#pragma once
#include <string>
#include <vector>

#include "run/config.hpp"
#include "run/progress.hpp"

namespace tool {

struct RunData : RunLabel {
  std::string path;
  FlatConfig config;
  Columns columns;                                                   // of progress.csv
  std::string first_limit;                                           // key in config of that of cost column 0
  double limit = -1;                                                 // its value, < 0: none
  const std::vector<double>& column(const std::string& name) const;  // empty when there is none
};

// The folder itself when it is a run, else every run below it, sorted. Failure when there is none.
std::vector<std::string> find_runs(const std::string& folder);
// Of the folders of a command: each run once, however it is named. Failure as of find_runs and read_run.
std::vector<RunData> read_runs(const std::vector<std::string>& folders);
// Failure when the folder is no run or has no finished epoch. A last row that is cut short is left out.
RunData read_run(const std::string& path);

}  // namespace tool

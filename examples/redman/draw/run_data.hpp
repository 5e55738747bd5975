// What a finished or running training left in its folder, as numbers to plot.
#pragma once
#include <map>
#include <string>
#include <vector>

namespace tool {

struct RunData {
  std::string path, task, algo;
  double limit = -1;  // of column 0, < 0: none
  unsigned long long seed = 0;
  std::map<std::string, std::vector<double>> columns;  // of progress.csv, NaN where a cell is empty or nan
  const std::vector<double>& column(const std::string& name) const;  // empty when there is none
};

// The folder itself when it is a run, else every run below it, sorted. Failure when there is none.
std::vector<std::string> find_runs(const std::string& folder);
// Failure when the folder is no run or has no finished epoch. A last row that is cut short is left out.
RunData read_run(const std::string& path);

}  // namespace tool

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

// Failure when the folder holds no run. A last row that is cut short is left out.
RunData read_run(const std::string& path);

}  // namespace tool

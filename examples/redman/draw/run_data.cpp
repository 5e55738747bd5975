#include "draw/run_data.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "files.hpp"
#include "report.hpp"

namespace tool {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

double number(const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  return end == cell.c_str() ? std::nan("") : value;
}

}  // namespace

const std::vector<double>& RunData::column(const std::string& name) const {
  static const std::vector<double> kNone;
  const auto found = columns.find(name);
  return found == columns.end() ? kNone : found->second;
}

std::vector<std::string> find_runs(const std::string& folder) {
  if (file_exists(folder + "/config.json")) return {folder};
  std::vector<std::string> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error))
    if (entry.path().filename() == "config.json") found.push_back(entry.path().parent_path().string());
  if (found.empty()) throw Failure(folder + " holds no run: no config.json in it or below");
  std::sort(found.begin(), found.end());
  return found;
}

RunData read_run(const std::string& path) {
  RunData run;
  run.path = path;
  try {
    const Json config = Json::parse(read_file(path + "/config.json"));
    run.task = config.at("task");
    run.algo = config.at("algo");
    run.seed = config.at("seed");
    const Json& limits = config.at("cost_limits");
    if (!limits.empty()) run.limit = limits.contains("cost") ? limits["cost"].get<double>() : -1;
  } catch (const Json::exception& e) {
    throw Failure(path + "/config.json is not a run's configuration: " + e.what());
  }
  std::istringstream in(read_file(path + "/progress.csv"));
  std::string line;
  std::getline(in, line);
  const auto names = split(line);
  while (std::getline(in, line)) {
    const auto cells = split(line);
    if (cells.size() != names.size()) continue;
    for (size_t i = 0; i < names.size(); ++i) run.columns[names[i]].push_back(number(cells[i]));
  }
  if (run.column("TotalEnvSteps").empty()) throw Failure(path + "/progress.csv has no finished epoch yet");
  return run;
}

}  // namespace tool

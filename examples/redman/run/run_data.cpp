#include "run/run_data.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "common/files.hpp"
#include "common/json.hpp"
#include "common/report.hpp"

namespace tool {

const std::vector<double>& RunData::column(const std::string& name) const {
  static const std::vector<double> kNone;
  const auto found = columns.find(name);
  return found == columns.end() ? kNone : found->second;
}

std::vector<std::string> find_runs(const std::string& folder) {
  namespace fs = std::filesystem;
  if (file_exists(folder + "/config.json")) return {folder};
  std::vector<std::string> found;
  std::error_code error, kind;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error))
    if (at->path().filename() == "config.json" && at->is_regular_file(kind))
      found.push_back(at->path().parent_path().string());
  if (found.empty())
    throw Failure(folder + " holds no run: " +
                  (is_folder(folder) ? "there is no config.json in it or below it"
                                     : "it does not exist" + missing_file_hint(folder)));
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<RunData> read_runs(const std::vector<std::string>& folders) {
  std::vector<RunData> runs;
  std::set<std::string> seen;
  for (const std::string& folder : folders)
    for (const std::string& path : find_runs(folder)) {
      std::error_code error;
      const std::string whole = std::filesystem::weakly_canonical(path, error).string();
      if (seen.insert(error ? path : whole).second) runs.push_back(read_run(path));
    }
  return runs;
}

namespace {

// Of a task of one's own, or costs of one's own, column 0 may have any name: it is the limited one whose curve is without a
// name. In the library's tasks it is called cost.
std::string first_limit_of(const FlatConfig& config, const Columns& columns) {
  const std::string limits = "cost_limits.";
  for (auto at = config.lower_bound(limits); at != config.end() && at->first.starts_with(limits); ++at)
    if (columns.count("Metrics/EpCost/" + at->first.substr(limits.size())) == 0) return at->first;
  return limits + "cost";
}

}  // namespace

RunData read_run(const std::string& path) {
  const std::string config = path + "/config.json", progress = path + "/progress.csv";
  const std::string label = read_file(config, kMostJsonBytes), rows = read_file(progress);
  RunData run;
  try {
    static_cast<RunLabel&>(run) = parse_label(label.data(), label.size());
    run.config = parse_flat_config(label.data(), label.size());
  } catch (const Failure& e) {
    throw Failure(config + " is not a run's configuration: " + e.what());
  }
  run.path = path;
  try {
    run.columns = parse_progress(rows.data(), rows.size());
  } catch (const Failure& e) {
    throw Failure(progress + " is not a run's curve: " + e.what());
  }
  run.first_limit = first_limit_of(run.config, run.columns);
  if (const auto limit = run.config.find(run.first_limit); limit != run.config.end()) {
    run.limit = std::strtod(limit->second.c_str(), nullptr);
    run.config.erase("algo_cfgs.cost_limit");  // the same
  }
  if (run.column("TotalEnvSteps").empty()) throw Failure(progress + " has no finished epoch yet");
  return run;
}

}  // namespace tool

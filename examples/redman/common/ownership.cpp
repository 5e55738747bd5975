#include "common/ownership.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "common/files.hpp"
#include "common/json.hpp"
#include "common/report.hpp"

namespace tool {
namespace {

namespace fs = std::filesystem;

// A regular file, or a link to one; false where nothing stands.
bool stands(const std::string& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

bool begins_with(const std::string& path, const std::string& head) {
  return beginning_of(path, head.size()) == head;
}

// Other tools write files of this name, some with the same tables: the layout's hash is redman's alone.
bool is_own_config(const std::string& path) {
  const std::string text = read_file(path, kMostJsonBytes);
  try {
    const Document json = parse_json(text.data(), text.size());
    const char* const keys[] = {"task", "algo", "seed", "train_cfgs", "algo_cfgs", "layout_hash"};
    return std::all_of(std::begin(keys), std::end(keys), [&](const char* key) { return json.contains(key); });
  } catch (const Failure&) {
    return false;
  }
}

bool is_own(const std::string& path, const std::string& name) {
  if (name == "config.json") return is_own_config(path);
  if (name == "progress.csv") return begins_with(path, "Train/Epoch,Train/TotalSteps,TotalEnvSteps,");
  return begins_with(path, name == "policy.rdm" ? "RDMPOLIC" : "RDMCHECK");
}

}  // namespace

void check_run_files(const std::string& folder) {
  for (const char* name : kRunFiles) {
    const std::string path = folder + '/' + name;
    if (!stands(path)) continue;
    if (!file_exists(path))
      throw Failure(path + " is not a regular file: move it away, or give another folder");
    if (!is_own(path, name))
      throw Failure(path + " was not written by redman: move it away, or give another folder");
  }
}

std::string first_run_file(const std::string& folder) {
  for (const char* name : kRunFiles)
    if (stands(folder + '/' + name)) return name;
  return "";
}

void check_default_output(const std::string& path, const std::string& mark, const char* flag) {
  constexpr size_t kHead = 1024;
  if (!file_exists(path) || beginning_of(path, kHead).find(mark) != std::string::npos) return;
  throw Failure(path + " exists already and was not written by redman: give " + flag + " FILE");
}

bool is_run_file(const std::string& path) {
  const fs::path whole = path, folder = whole.parent_path();
  if (std::none_of(std::begin(kRunFiles), std::end(kRunFiles),
                   [&](const char* name) { return whole.filename() == name; }))
    return false;
  const std::string config = ((folder.empty() ? "." : folder) / "config.json").string();
  try {
    return file_exists(config) && is_own_config(config);
  } catch (const Failure&) {
    return true;  // it cannot be read: nothing is risked
  }
}

}  // namespace tool

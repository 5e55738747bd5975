// A run folder: config.json, progress.csv, policy.rdm, checkpoint.rdm. A kill at any moment leaves one that
// can be read and continued.
#pragma once
#include <cstddef>
#include <string>

#include "setup.hpp"

namespace tool {

// What `train` was asked for: everything needed to do it again.
struct RunSettings {
  PoolSettings pool;
  AgentSettings agent;
  std::vector<std::string> limits;  // as --cost-limit had them
  int64_t steps = 1000000;          // control steps, all worlds
  int32_t eval_every = 10;          // epochs
  int32_t checkpoint_every = 10;    // epochs
};

class RunFolder {
 public:
  // Makes the folder and its parents. A run that stands there already is a Failure, or is removed.
  static RunFolder create(const std::string& path, bool overwrite);
  // An existing run. Failure when there is no config.json.
  static RunFolder open(const std::string& path);
  // runs/<algo>-{<task>}/seed-000-<local time>
  static std::string default_path(const RunSettings& settings);
  // The run folder that holds `file`, "" when it stands in none.
  static std::string of_file(const std::string& file);

  const std::string& path() const { return path_; }
  std::string file(const char* name) const { return path_ + '/' + name; }
  std::string policy() const { return file("policy.rdm"); }
  std::string checkpoint() const { return file("checkpoint.rdm"); }
  std::string progress() const { return file("progress.csv"); }

  // config.json with the defaults written out, as the pool and the agent have them.
  void write_config(const RunSettings& settings, const redman::Pool& pool, const redman::Agent& agent,
                    const std::vector<double>& limits, int64_t steps_per_epoch) const;
  RunSettings read_config() const;

  // progress.csv: a row is appended whole; resuming cuts it back to the checkpoint.
  void start_progress(const std::string& header) const;
  size_t append_progress(const std::string& row) const;  // returns the new length, bytes
  void cut_progress(size_t bytes) const;                 // Failure when it is shorter

 private:
  explicit RunFolder(std::string path) : path_(std::move(path)) {}
  std::string path_;
};

}  // namespace tool

// A run folder: config.json, progress.csv, policy.rdm, checkpoint.rdm, and progress.csv as an event file for
// TensorBoard. A kill at any moment leaves one that can be read and continued.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "run/config.hpp"

namespace tool {

class RunFolder {
 public:
  // Makes the folder and its parents, for this process alone to write in. A run that stands there already is
  // a Failure unless `overwrite`; nothing of it goes before start(). Files of a run's names that redman did
  // not write are a Failure always; others in the folder stay as they are.
  static RunFolder create(const std::string& path, bool overwrite);
  // Failure where the folder is not there and cannot be made, or cannot be written in. Makes nothing.
  static void check_place(const std::string& path);
  // Whether create() would succeed, as far as it can be told without making anything: before work whose result goes there.
  static void check_new(const std::string& path, bool overwrite);
  static std::string default_path(const RunSettings& settings);  // runs/<algo>-{<task>}/seed-000-<local time>
  // A folder of its own, that path, with -2, -3, ... where there is one.
  static RunFolder create_default(const RunSettings& settings);
  // An existing run, for this process alone to write in. Failure when there is no config.json, or another
  // process trains there.
  static RunFolder go_on(const std::string& path);

  ~RunFolder();
  RunFolder(RunFolder&& other) noexcept;
  RunFolder& operator=(RunFolder&& other) = delete;

  const std::string& path() const { return path_; }
  std::string file(const char* name) const { return path_ + '/' + name; }
  std::string config() const { return file("config.json"); }
  std::string policy() const { return file("policy.rdm"); }
  std::string checkpoint() const { return file("checkpoint.rdm"); }
  std::string progress() const { return file("progress.csv"); }
  const std::string& header() const { return header_; }  // of progress.csv, of a run that began or goes on

  // Begins a run. What stood in the folder goes when all of this has been written beside it.
  void start(const std::string& config, const std::string& header, const std::string& policy,
             bool with_events);

  void write_config(const std::string& text) const;
  void write_policy(const std::string& bytes) const;

  // progress.csv: a row is appended whole or not at all; resuming cuts it back to the checkpoint. The event
  // file follows it.
  size_t append_progress(const std::string& row) const;  // returns the new length, bytes
  void cut_progress(size_t bytes, bool with_events);     // Failure when it is shorter
  // Failure when the folder was removed, or another one stands in its place.
  void check() const;

 private:
  RunFolder(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  static void check_free(const std::string& path, bool overwrite);
  std::vector<std::string> event_files() const;  // names of redman's, in order
  void write_events(const std::string& progress);

  std::string path_;
  std::string header_, events_;  // of progress.csv; the event file's name, "" without one
  int64_t begun_ = 0;            // unix seconds, as that name says
  bool goes_on_ = false;         // an existing run, which may begin again when it has no checkpoint yet
  int lock_;  // the open folder; the kernel lets its lock go when the process ends, however it does
};

// The settings of the run in a folder. Failure when there is none, or its config.json is none.
RunSettings run_settings(const std::string& folder);
// The run folder that holds `file`, "" when it stands in none.
std::string run_folder_of(const std::string& file);

}  // namespace tool

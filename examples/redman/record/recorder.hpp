// Rollouts as data: every control step of episodes as they are played, in one file.
//
// Steps stand in the order of their episode, and within it in time, for any number of worlds. What has been
// played waits on the disk: an episode of each world is held in memory, no more.
#pragma once
#include <string>
#include <vector>

#include "common/files.hpp"
#include "common/report.hpp"
#include "common/setup.hpp"

namespace tool {

// What the file says beside its arrays, so that the rollout can be played again.
struct RecordNote {
  std::string policy;  // who acted, as --policy had it
  Options options;     // of the task
  uint64_t seed = 0;
};

inline constexpr const char* kRecordEndings = ".npz .csv";

class Recorder {
 public:
  // For the file of this name: named columns of text where it ends in .csv, else arrays of numpy (.npz).
  // `states`: the world's state before each step too. `labels`: the action before noise, as label() finds
  // it. More episodes than that grow. Failure when the file cannot be written. Borrows the pool.
  Recorder(const std::string& path, const redman::Pool& pool, size_t episodes, bool states,
           bool labels = false);

  void label(size_t env);  // the actions that were meant stand in the pool

  void before(size_t env, size_t episode);  // the actions stand in the pool, the step is to come
  void after(size_t env, size_t episode);   // the step is done
  // The episode that world env plays goes back to its first `steps` steps.
  void rewind(size_t env, int32_t steps);
  // Writes the file; returns the number of steps.
  uint64_t finish(const RecordNote& note);

 private:
  struct Column {
    std::string name, type, help;
    std::vector<uint64_t> shape;  // of a step, or of an episode
    const void* rows;             // [num_envs]
    size_t bytes;                 // of a row
    bool before;                  // taken before the step
    bool of_episode;              // one row an episode
  };
  struct Span {
    uint64_t offset = 0, steps = 0, first = 0;
  };
  template <class T>
  void add(const char* name, const char* help, const T* rows, std::vector<uint64_t> shape, bool before,
           bool of_episode = false);
  void take(size_t env, bool before, bool of_episode);
  // Gives the bytes of a column of an episode to `use`, in parts.
  template <class Use>
  void read_column(const Span& span, size_t column, Use use) const;
  std::string metadata(const RecordNote& note, uint64_t steps) const;
  void write_arrays(const RecordNote& note, uint64_t steps);
  void write_table();

  const redman::Pool& pool_;
  bool table_, states_;
  PreparedFile file_;
  ScratchFile scratch_;
  size_t state_bytes_ = 0;
  std::vector<int32_t> env_, episode_, step_;  // [num_envs]
  std::vector<float> label_;                   // [num_envs][action_dim]
  std::vector<uint8_t> state_, start_;         // [num_envs][state_bytes]
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> waiting_;  // [num_envs][columns] of the episode that is played
  std::vector<Span> episodes_;
};

}  // namespace tool

// A data set: whole episodes with what was seen, done and met in them, and what the set says of itself.
//
// Files are archives of numpy arrays (.npz), as `rollout --record` and rdm_recording_write_file write them: rows in
// the order of their episodes. A data set says more in its member `metadata` (JSON), and of each episode which policy
// played it (`source`) and what it led to (`final_obs`).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/report.hpp"

namespace tool {

// One episode; each list has a row a decision.
struct DataEpisode {
  std::vector<float> obs, action, label, reward, cost;
  std::vector<uint8_t> terminated, truncated, success;
  std::vector<float> final_obs;  // [obs_dim] after the last row; empty: unknown
  uint8_t source = 0;
  size_t rows() const { return reward.size(); }
  bool ended() const { return rows() > 0 && (terminated.back() || truncated.back()); }
  double sum_of_rewards() const;
  double sum_of_costs(size_t column, size_t cost_dim) const;
};

struct DataSet {
  std::string task;  // "": unknown
  uint64_t layout_hash = 0;
  size_t obs_dim = 0, action_dim = 0, cost_dim = 0;
  bool labels = false, sources = false;  // what the episodes have
  std::vector<DataEpisode> episodes;
  Json metadata = Json::object();

  uint64_t rows() const;
  bool finals() const;  // every episode that ended has final_obs
};

inline constexpr const char* kDataFormat = "redman data 1";

// Of the numbers alone: FNV-1a over the names and CRC-32s of the arrays (data.md says which). The same for a file that
// numpy has saved again, on any machine.
uint64_t hash_of(const DataSet& set);
std::string hash_text(const DataSet& set);

// Failure when the file is no recording.
DataSet read_set(const std::string& path);
void write_set(const DataSet& set, const std::string& path);

// What is wrong with the lengths of its lists, "" when they fit.
std::string fault_of(const DataSet& set);

}  // namespace tool

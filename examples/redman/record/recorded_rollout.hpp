// A rollout that was recorded, to be played again.
#pragma once
#include <string>
#include <vector>

#include "common/setup.hpp"
#include "record/zip.hpp"

namespace tool {

struct Recording {
  PoolSettings pool;   // task, options, seed, number of worlds
  std::string policy;  // who acted
  std::string hash;    // of all worlds' states at the end
  size_t action_dim = 0, state_bytes = 0;
  std::vector<uint64_t> begin;  // [episodes + 1] first step of each
  std::vector<float> action;    // [steps][action_dim]
  std::string state;            // [episodes][state_bytes] before their first steps

  size_t episodes() const { return begin.size() - 1; }
  size_t length(size_t episode) const { return static_cast<size_t>(begin[episode + 1] - begin[episode]); }
};

// Failure when the file is no rollout that `redman rollout --record` wrote, or numpy saved again.
Recording read_recording(const std::string& path);
// The same of an archive; the text names no file.
Recording parse_recording(const ZipReader& zip);

}  // namespace tool

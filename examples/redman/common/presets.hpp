// What the words "state", "vision", "touch" and "proprioception" of the options actor_obs and critic_obs mean
// for an observation: asked of the library, which alone knows.
#pragma once
#include <redman/redman.h>

#include <string>
#include <vector>

namespace tool {

struct ObsPreset {
  std::string name;
  std::vector<int32_t> columns;  // entries of a row that it leaves, ascending
};
// Those that this observation has, "state" first.
std::vector<ObsPreset> obs_presets(int32_t obs_dim, const std::vector<rdm_field>& fields);

bool has_columns(const ObsPreset& preset, const rdm_field& field);

// Entries that a policy sees, ascending.
std::vector<int32_t> policy_columns(const rdm_policy* policy);
// "0..23 48..94": first and last of each run of columns.
std::string ranges_text(const std::vector<int32_t>& columns);

}  // namespace tool

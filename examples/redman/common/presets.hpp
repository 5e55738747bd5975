// What the words "state", "vision", "touch" and "proprioception" of the options actor_obs and critic_obs mean
// for an observation: asked of the library, which alone knows.
#pragma once
#include <redman/redman.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace tool {

struct ObsPreset {
  std::string name;
  std::vector<int32_t> columns;  // entries of a row that it leaves, ascending
};
// Those that this observation has, "state" first.
std::vector<ObsPreset> obs_presets(int32_t obs_dim, const std::vector<rdm_field_info>& fields);

// The same for many observations whose fields are among these: asked once for each name, for what a preset does
// with a field follows from the field's name.
class Presets {
 public:
  explicit Presets(const std::vector<rdm_field_info>& fields);
  std::vector<ObsPreset> of(int32_t obs_dim, const std::vector<rdm_field_info>& fields) const;

 private:
  std::vector<std::string> names_;                       // of the presets
  std::map<std::string, unsigned, std::less<>> fields_;  // which presets keep it: bit i the i-th
  unsigned others_ = 0;                                  // the same of entries of no field
};

bool has_columns(const ObsPreset& preset, const rdm_field_info& field);

// Entries that a policy sees, ascending.
std::vector<int32_t> policy_columns(const rdm_policy* policy);
// "0..23 48..94": first and last of each run of columns.
std::string ranges_text(const std::vector<int32_t>& columns);

}  // namespace tool

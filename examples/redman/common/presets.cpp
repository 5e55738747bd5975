#include "common/presets.hpp"

#include <algorithm>

#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/redman.hpp>

namespace tool {

std::vector<int32_t> policy_columns(const rdm_policy* policy) {
  int32_t count = 0;
  redman::check(rdm_policy_columns(policy, nullptr, 0, &count));
  std::vector<int32_t> columns(static_cast<size_t>(count));
  redman::check(rdm_policy_columns(policy, columns.data(), count, &count));
  return columns;
}

std::vector<ObsPreset> obs_presets(int32_t obs_dim, const std::vector<rdm_field>& fields) {
  std::vector<ObsPreset> out;
  for (const char* name : {"state", "vision", "touch", "proprioception"}) {
    rdm_agent_config config = redman::agent_config(obs_dim, 1, 1);
    config.fields = fields.data();
    config.num_fields = static_cast<int32_t>(fields.size());
    const std::string settings =
        std::string("hidden=1\ncritic_hidden=1\nhorizon=1\nminibatches=1\nactor_obs=") + name;
    config.settings = settings.c_str();
    try {
      const redman::Policy policy(redman::Agent(config).policy());
      out.push_back({name, policy_columns(policy.get())});
    } catch (const redman::Error& e) {
      if (e.code() != RDM_NOT_FOUND && e.code() != RDM_UNSUPPORTED) throw;
    }
  }
  return out;
}

bool has_columns(const ObsPreset& preset, const rdm_field& field) {
  const auto first = std::lower_bound(preset.columns.begin(), preset.columns.end(), field.offset);
  return first != preset.columns.end() && *first < field.offset + field.count;
}

std::string ranges_text(const std::vector<int32_t>& columns) {
  std::string out;
  for (size_t i = 0, end = 0; i < columns.size(); i = end) {
    for (end = i + 1; end < columns.size() && columns[end] == columns[end - 1] + 1;) ++end;
    out += (out.empty() ? "" : " ") + std::to_string(columns[i]) + ".." + std::to_string(columns[end - 1]);
  }
  return out;
}

}  // namespace tool

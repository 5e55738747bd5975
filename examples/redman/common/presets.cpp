#include "common/presets.hpp"

#include <algorithm>
#include <string_view>

#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/redman.hpp>

#include "common/names.hpp"

namespace tool {
namespace {

constexpr const char* kPresetNames[] = {"state", "vision", "touch", "proprioception"};

}  // namespace

std::vector<int32_t> policy_columns(const rdm_policy* policy) {
  size_t count = 0;
  redman::check(rdm_policy_get_columns(policy, nullptr, 0, &count));
  std::vector<int32_t> columns(count);
  redman::check(rdm_policy_get_columns(policy, columns.data(), count, &count));
  return columns;
}

std::vector<ObsPreset> obs_presets(int32_t obs_dim, const std::vector<rdm_field_info>& fields) {
  std::vector<ObsPreset> out;
  std::vector<rdm_field> rows;
  for (const rdm_field_info& f : fields) rows.push_back({f.name, f.unit, f.offset, f.count});
  for (const char* name : kPresetNames) {
    rdm_agent_config config = redman::agent_config(obs_dim, 1, 1);
    config.fields = rows.data();
    config.num_fields = static_cast<int32_t>(rows.size());
    const std::string settings =
        std::string("hidden=1\ncritic_hidden=1\nhorizon=1\nminibatches=1\nactor_obs=") + name;
    config.settings = settings.c_str();
    try {
      const redman::Policy policy(redman::Agent(config).policy());
      out.push_back({name, policy_columns(policy.get())});
    } catch (const redman::Error& e) {
      if (e.code() != RDM_ERROR_NOT_FOUND && e.code() != RDM_ERROR_UNSUPPORTED) throw;
    }
  }
  return out;
}

Presets::Presets(const std::vector<rdm_field_info>& fields) {
  for (const rdm_field_info& f : fields) fields_.emplace(f.name, 0);
  for (const char* name : kPresetNames)  // a field of that name hides the preset, where it is
    for (auto f = fields_.begin(); f != fields_.end();)
      f = same_name(f->first, name) ? fields_.erase(f) : ++f;
  std::vector<rdm_field_info> once;
  for (const auto& [name, kept] : fields_) {
    rdm_field_info f{};
    f.name = name.c_str();
    f.unit = "";
    f.offset = static_cast<int32_t>(once.size());
    f.count = 1;
    once.push_back(f);
  }
  const auto count = static_cast<int32_t>(once.size());
  if (count == 0) return;
  for (const ObsPreset& p : obs_presets(count + 1, once)) {  // the last entry is of no field
    const unsigned bit = 1u << names_.size();
    names_.push_back(p.name);
    auto at = fields_.begin();
    for (int32_t i = 0; i < count; ++i, ++at)
      if (std::binary_search(p.columns.begin(), p.columns.end(), i)) at->second |= bit;
    if (p.columns.back() == count) others_ |= bit;
  }
}

std::vector<ObsPreset> Presets::of(int32_t obs_dim, const std::vector<rdm_field_info>& fields) const {
  std::vector<unsigned> kept(static_cast<size_t>(obs_dim), others_), by(fields.size());
  for (size_t i = 0; i < fields.size(); ++i) {
    const auto known = fields_.find(std::string_view(fields[i].name));
    if (known == fields_.end()) return obs_presets(obs_dim, fields);
    by[i] = known->second;
    std::fill_n(kept.begin() + fields[i].offset, fields[i].count, 0u);
  }
  for (size_t i = 0; i < fields.size(); ++i)
    for (int32_t k = 0; k < fields[i].count; ++k) kept[static_cast<size_t>(fields[i].offset + k)] |= by[i];
  std::vector<ObsPreset> out;
  for (size_t p = 0; p < names_.size(); ++p) {
    std::vector<int32_t> columns;
    for (int32_t i = 0; i < obs_dim; ++i)
      if (kept[static_cast<size_t>(i)] >> p & 1) columns.push_back(i);
    if (!columns.empty()) out.push_back({names_[p], std::move(columns)});
  }
  return out;
}

bool has_columns(const ObsPreset& preset, const rdm_field_info& field) {
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

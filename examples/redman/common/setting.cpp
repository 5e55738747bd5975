#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include "common/setting.hpp"

#include <sstream>

#include "common/names.hpp"
#include "common/text.hpp"

namespace tool {

Options read_settings(const std::string& lines) {
  Options out;
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);)
    if (const size_t equals = line.find('='); equals != std::string::npos)
      out.emplace_back(line.substr(0, equals), line.substr(equals + 1));
  return out;
}

std::string option_of(const Options& options, const std::string& key) {
  std::string out;
  for (const auto& [name, value] : options)
    if (same_name(name, key)) out = value;
  return out;
}

// The lines leave out what option level draws, and the call gives texts of at most RDM_TEXT_SIZE: one of them has it.
Options pool_settings(const redman::Pool& pool) {
  Options out;
  for (int32_t i = 0;; ++i) {
    const char* key = nullptr;
    char text[RDM_TEXT_SIZE];
    const rdm_result r = rdm_pool_setting_at(pool.get(), i, &key, text);
    if (r == RDM_ERROR_RANGE && !key) return out;  // there are no more
    if (r != RDM_ERROR_RANGE) redman::check(r);
    out.emplace_back(key, r == RDM_OK ? text : option_of(read_settings(pool.settings()), key));
  }
}

std::string agent_setting(const redman::Agent& agent, const std::string& algo, const std::string& wanted) {
  const std::vector<rdm_option_spec> table = algo_options(find_algo(algo));
  for (size_t i = 0; i < table.size(); ++i) {
    if (!same_name(table[i].key, wanted)) continue;
    const char* key = nullptr;
    char text[RDM_TEXT_SIZE];
    const rdm_result r = rdm_agent_setting_at(agent.get(), static_cast<int32_t>(i), &key, text);
    if (r == RDM_ERROR_RANGE) return option_of(read_settings(agent.settings()), key);
    redman::check(r);
    return text;
  }
  throw Failure("algorithm " + algo + " has no option " + wanted);
}

}  // namespace tool

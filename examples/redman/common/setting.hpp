// What the options of a pool or an agent are set to, as text of any length.
#pragma once

#include <cstdint>
#include <string>

#include "common/setup.hpp"

namespace tool {

// Of lines key=value, as pools, agents and shields print their settings.
Options read_settings(const std::string& lines);
// The last value of this key, "" without one.
std::string option_of(const Options& options, const std::string& key);
// Of option i of the task, whose key that is.
std::string pool_setting(const redman::Pool& pool, int32_t i, const std::string& key);
// Of an option of its algorithm; Failure where the algorithm has none of that name.
std::string agent_setting(const redman::Agent& agent, const std::string& algo, const std::string& wanted);

}  // namespace tool

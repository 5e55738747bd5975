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
// All of a pool by their own keys: those of joints and links are of the robots that it has.
Options pool_settings(const redman::Pool& pool);
// Of an option of its algorithm; Failure where the algorithm has none of that name.
std::string agent_setting(const redman::Agent& agent, const std::string& algo, const std::string& wanted);

}  // namespace tool

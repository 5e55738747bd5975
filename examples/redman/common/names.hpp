// Tasks, algorithms and option keys by the names that people type.
#pragma once
#include <redman/redman.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/report.hpp"

namespace CLI {
class Validator;
}
namespace redman {
class Pool;
}

namespace tool {

// Case is ignored and '-' equals '_'.
bool same_name(const std::string& a, const std::string& b);
// "; nearest is NAME", or several, or "" when none of `names` is near: as the library's texts.
std::string nearest_hint(const std::string& word, const std::vector<std::string>& names);
// Refuses a flag's value that is none of the words, with the nearest; the value becomes the word as it stands there.
CLI::Validator one_of(const std::vector<std::string>& words);

// Index by name, of a task by its file too; Usage with the nearest known name.
int32_t find_task(const std::string& name);
int32_t find_algo(const std::string& name);
rdm_task task_at(int32_t index);
rdm_algo algo_at(int32_t index);

std::vector<rdm_field_info> task_fields(int32_t task);
std::vector<rdm_cost_info> task_costs(int32_t task);
// The task's own defaults of agent options, and the mean action of its new policies.
std::vector<rdm_option> task_defaults(int32_t task);
std::vector<rdm_option_spec> task_options(int32_t task);
std::vector<rdm_option_spec> algo_options(int32_t algo);
// What the entries of a pool's rows are: of its observations, and the joints that entries of its actions move. The names are
// the pool's.
std::vector<rdm_field_info> fields_of(const redman::Pool& pool);
using Motors = std::map<int32_t, rdm_joint_info>;  // by entry of the action
Motors motors_of(const redman::Pool& pool);
bool has_option(const std::vector<rdm_option_spec>& table, const std::string& key);

// Versions and how the library was built.
Json build_json();

// A table of options as the tool's JSON has it, and as text for people.
Json options_json(const std::vector<rdm_option_spec>& table);
std::string default_text(const rdm_option_spec& option);  // "" of a text without one
std::string options_text(const std::vector<rdm_option_spec>& table);

}  // namespace tool

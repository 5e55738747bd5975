// The groups of a team: which entries of the action belong to whom, and what each observes. Option groups:
//
//   groups=auto            the first set that the task has, or one group of all where it has none
//   groups=hands           the set of this name: the task's default "groups.hands"
//   groups=right:right.*,object.*,goal.*:0-19;left:left.*,object.*,goal.*:20-39
//                          groups between semicolons: a name, fields as in actor_obs, the first and last entry
//   groups=all             one group
//
// Groups come in the order of their entries and leave none out, so that each entry has one owner. Of its fields a group
// sees what option actor_obs has too.
#pragma once
#include "algos/core/agent_types.hpp"
#include "base/option_rows.hpp"
#include "nn/actor_group.hpp"

namespace rdm {

inline constexpr int32_t kLongestGroups = 2047;  // characters of a list
struct GroupOptions {
  const char* groups;
};
inline constexpr auto kGroupRows = option_rows<GroupOptions>(row<&GroupOptions::groups>(basic(
    text_option("groups", "auto", nullptr,
                "agents of a team: a set that the task has, all, or NAME:FIELDS:FIRST-LAST;... of the action",
                kLongestGroups))));

// Prefix of the keys under which a task's defaults hold its sets.
inline constexpr char kGroupSet[] = "groups.";
// Whether a default is such a set, which is no option.
bool is_group_set(const char* key);

// One group as the text says it.
struct GroupSpec {
  char name[kGroupNameSize];
  Vector<int32_t> columns;  // empty: all
  int32_t first = 0, count = 0;
};
// Error(kNotFound) for a set that the task has not, with those that it has; kArgument, kRange for a list that is
// not one. Empty for one group that is all entries and sees what actor_obs says.
Vector<GroupSpec> parse_groups(const AgentConfig& config, const char* text);

}  // namespace rdm

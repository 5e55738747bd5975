// redman/team.hpp: the policies of a team. C++17, experimental.
//
//   redman::Policy team("team.rdm");
//   for (const std::string& name : redman::groups(team)) ...     // right, left
//   redman::Policy left(redman::group_bytes(team, 1));           // its file, and its policy
#ifndef REDMAN_TEAM_HPP
#define REDMAN_TEAM_HPP
#include <redman/team.h>

#include <redman/policy.hpp>
#include <string>

namespace redman {

// Names of a policy's groups, in the order of the action; none for a policy of one network.
inline std::vector<std::string> groups(const Policy& policy) {
  std::vector<std::string> out;
  while (const char* name = rdm_policy_group_name(policy.get(), static_cast<int32_t>(out.size())))
    out.emplace_back(name);
  return out;
}

// The policy file of one group alone.
inline Bytes group_bytes(const Policy& policy, int32_t i) {
  size_t size = 0;
  check(rdm_policy_write_group(policy.get(), i, nullptr, 0, &size));
  Bytes out(size);
  check(rdm_policy_write_group(policy.get(), i, out.data(), out.size(), &size));
  return out;
}

}  // namespace redman
#endif

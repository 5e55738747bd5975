// Handles of the C ABI that end with their scope.
#pragma once
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <memory>

struct EndHandle {
  void operator()(rdm_pool* p) const { rdm_pool_destroy(p); }
  void operator()(rdm_agent* a) const { rdm_agent_destroy(a); }
  void operator()(rdm_policy* p) const { rdm_policy_destroy(p); }
  void operator()(rdm_actor* a) const { rdm_actor_destroy(a); }
  void operator()(rdm_planner* p) const { rdm_planner_destroy(p); }
  void operator()(rdm_shield* s) const { rdm_shield_destroy(s); }
};
using Pool = std::unique_ptr<rdm_pool, EndHandle>;
using Agent = std::unique_ptr<rdm_agent, EndHandle>;
using Policy = std::unique_ptr<rdm_policy, EndHandle>;
using Actor = std::unique_ptr<rdm_actor, EndHandle>;
using Planner = std::unique_ptr<rdm_planner, EndHandle>;
using Shield = std::unique_ptr<rdm_shield, EndHandle>;

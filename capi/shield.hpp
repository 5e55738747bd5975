// A shield's handle, which rollouts of an agent use too.
#pragma once
#include "capi/frozen_mean.hpp"
#include "shield/shield.hpp"

struct rdm_shield {
  static constexpr rdm::capi::Tag kTag = rdm::capi::Tag::kShield;
  static constexpr bool kOneAtATime = false;
  rdm::capi::Tag tag = kTag;
  mutable rdm::capi::InUse in_use;
  rdm::HostHooks hooks;
  mutable char error[rdm::kErrorTextSize] = "";  // also of calls that only read
  rdm::Shield* shield = nullptr;
  rdm_spec spec{};  // of its pool
#if RDM_WITH_SIM && RDM_WITH_POLICY
  rdm::capi::FrozenMean backups[rdm::Shield::kMostPolicies];
  int32_t num_backups = 0;
#endif
};

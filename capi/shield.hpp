// A shield's handle, which rollouts of an agent use too.
#pragma once
#include "capi/handles.hpp"
#include "shield/shield.hpp"

#if RDM_WITH_POLICY
namespace rdm::capi {

// A policy's mean action, for any rows.
class Backup final : public ShieldPolicy {
 public:
  void open(const HostHooks& hooks, const Policy* policy) {
    policy_ = policy;
    arena_ = Arena(hooks, policy->scratch_bytes(kRows));
    scratch_ = arena_.make<unsigned char>(policy->scratch_bytes(kRows));
  }
  void act(const float* obs, int32_t rows, float* action) override {
    const auto& v = policy_->view();
    for (int32_t first = 0; first < rows; first += kRows) {
      const auto at = static_cast<size_t>(first);
      policy_->act(obs + at * static_cast<size_t>(v.obs_dim()), std::min(kRows, rows - first), nullptr,
                   action + at * static_cast<size_t>(v.action_dim()), scratch_);
    }
  }

 private:
  static constexpr int32_t kRows = 64;
  const Policy* policy_ = nullptr;
  Arena arena_;
  unsigned char* scratch_ = nullptr;
};

}  // namespace rdm::capi
#endif

struct rdm_shield {
  static constexpr rdm::capi::Tag kTag = rdm::capi::Tag::kShield;
  static constexpr bool kOneAtATime = false;
  rdm::capi::Tag tag = kTag;
  mutable rdm::capi::InUse in_use;
  rdm::HostHooks hooks;
  mutable char error[rdm::kErrorTextSize] = "";  // also of calls that only read
  rdm::Shield* shield = nullptr;
  rdm_spec spec{};  // of its pool
#if RDM_WITH_POLICY
  rdm::capi::Backup backups[rdm::Shield::kMostPolicies];
  int32_t num_backups = 0;
#endif
};

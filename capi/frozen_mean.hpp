// A policy's mean action, for planners and shields.
#pragma once
#include "capi/handles.hpp"

#if RDM_WITH_SIM && RDM_WITH_POLICY
#include "env/mean_policy.hpp"

namespace rdm::capi {

class FrozenMean final : public MeanPolicy {
 public:
  // It acts on so many rows at a time.
  void open(const HostHooks& hooks, const Policy* policy, int32_t rows) {
    policy_ = policy;
    rows_ = rows;
    const size_t bytes = policy->scratch_bytes(rows);
    arena_ = Arena(hooks, bytes);
    scratch_ = arena_.make<unsigned char>(bytes);
  }
  void act(const float* obs, int32_t rows, float* state, float* action) override {
    const auto& v = policy_->view();
    for (int32_t first = 0; first < rows; first += rows_) {
      const auto at = static_cast<size_t>(first);
      policy_->act(obs + at * static_cast<size_t>(v.obs_dim()), std::min(rows_, rows - first), nullptr,
                   action + at * static_cast<size_t>(v.action_dim()), scratch_, {},
                   state_dim() ? state + at * static_cast<size_t>(state_dim()) : nullptr);
    }
  }
  int32_t state_dim() const override { return policy_->view().state_dim(); }
  int32_t repeat() const override { return policy_->view().action_repeat; }

 private:
  const Policy* policy_ = nullptr;
  int32_t rows_ = 0;
  Arena arena_;
  unsigned char* scratch_ = nullptr;
};

}  // namespace rdm::capi
#endif

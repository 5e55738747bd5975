// A throw task whose cost is the right first finger's joints leaving their windows.
#pragma once
#include "tasks/throw/safety_costs.hpp"
#include "tasks/throw/throw_task.hpp"

namespace rdm {

struct SafeThrowConfig : ThrowConfig {
  // The pose that learning starts from, into a row of hold_arms.
  void (*flat_mean)(const HandControl& hands, FirstFinger first, float* mean);
  SafetyDefaults safety;
};

class SafeThrow final : public ThrowTask {
 public:
  SafeThrow(const SafeThrowConfig* config, SafetyKind kind, const Options& options);
  bool guard_at(int32_t i, Guard* guard, float* normal) const override;

 private:
  void judge_costs(const Step& step, Verdict* verdict) const override;
  SafetyCosts costs_;
  Vector<EntryGuard> guards_;
};

void add_safe_throw_options(const SafeThrowConfig& config, OptionTable& table);

// The same as a function for a row of the registry.
template <const SafeThrowConfig& kConfig>
void safe_throw_options(OptionTable& table) {
  add_safe_throw_options(kConfig, table);
}

}  // namespace rdm

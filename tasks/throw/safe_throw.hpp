// A throw task whose cost is the right first finger's joints leaving their windows.
#pragma once
#include "tasks/throw/safety_costs.hpp"
#include "tasks/throw/throw_task.hpp"

namespace rdm {

struct SafeThrowConfig : ThrowConfig {
  // The pose that learning starts from, into a row of zeros; `window`: the first finger inside its windows.
  void (*flat_mean)(const HandControl& rig, bool window, float* mean);
  SafetyWords words;
};

void add_safe_throw_options(const SafeThrowConfig& plan, OptionTable& table);

class SafeThrow : public ThrowTask {
 public:
  SafeThrow(const SafeThrowConfig& plan, SafetyKind kind, const Options& options);

 private:
  void judge_costs(const Step& step, Verdict* verdict) const override;
  SafetyCosts costs_;
};

// The parts of a TaskInfo that a constant plan decides.
template <const SafeThrowConfig& plan>
void add_planned_options(OptionTable& table) {
  add_safe_throw_options(plan, table);
}
template <const SafeThrowConfig& plan, SafetyKind kind>
struct PlannedThrow final : SafeThrow {
  explicit PlannedThrow(const Options& options) : SafeThrow(plan, kind, options) {}
};

}  // namespace rdm

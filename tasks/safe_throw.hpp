// A throw task whose cost is the right first finger's joints leaving their windows.
#pragma once
#include "tasks/safety_costs.hpp"
#include "tasks/throw_task.hpp"

namespace rdm {

struct SafeThrowPlan : ThrowPlan {
  // The pose that learning starts from, into a row of zeros; `window`: the first finger inside its windows.
  void (*flat_mean)(const HandRig& rig, bool window, float* mean);
  SafetyWords words;
};

void add_safe_throw_options(const SafeThrowPlan& plan, OptionTable& table);

class SafeThrow : public ThrowTask {
 public:
  SafeThrow(const SafeThrowPlan& plan, SafetyKind kind, const Options& options);

 private:
  void judge_costs(const Step& step, Verdict* verdict) const override;
  SafetyCosts costs_;
};

// The parts of a TaskInfo that a constant plan decides.
template <const SafeThrowPlan& plan>
void add_planned_options(OptionTable& table) {
  add_safe_throw_options(plan, table);
}
template <const SafeThrowPlan& plan, SafetyKind kind>
struct PlannedThrow final : SafeThrow {
  explicit PlannedThrow(const Options& options) : SafeThrow(plan, kind, options) {}
};

}  // namespace rdm

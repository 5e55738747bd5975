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

class SafeThrow final : public ThrowTask {
 public:
  SafeThrow(const SafeThrowPlan& plan, SafetyKind kind, const Options& options);

 private:
  void judge_costs(const Step& step, Verdict* verdict) const override;
  SafetyCosts costs_;
};

// TaskInfo's functions for a constant plan.
template <const SafeThrowPlan& plan>
const OptionSpec* safe_throw_options(int32_t* count) {
  struct Table : OptionTable {
    Table() { add_safe_throw_options(plan, *this); }
  };
  static const Table table;
  *count = table.count();
  return table.rows();
}

template <const SafeThrowPlan& plan, SafetyKind kind>
Task* make_safe_throw(const Options& options, const HostHooks& hooks) {
  const HostScope scope(hooks);
  return host_new<SafeThrow>(hooks, plan, kind, options);
}

void destroy_safe_throw(Task* task, const HostHooks& hooks);

}  // namespace rdm

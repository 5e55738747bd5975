#include "tasks/throw/safe_throw.hpp"

namespace rdm {
namespace {

constexpr OptionSpec kRows[] = {
    text_option(
        "initial_mean", "auto", "auto|flat|window|hold|zero",
        "start of a new policy: right hand flat, the same with the first finger inside its cost window, "
        "the hold action, or 0; auto: window for the finger cost, else flat"),
};

}  // namespace

void add_safe_throw_options(const SafeThrowConfig& plan, OptionTable& table) {
  add_throw_task_options(plan, table);
  add_safety_options(plan.words, table);
  table.add(kRows);
}

SafeThrow::SafeThrow(const SafeThrowConfig& plan, SafetyKind kind, const Options& o)
    : ThrowTask(plan, o, make_throw_scene(plan, o)),
      costs_(safety_costs_from(o, kind, scene(), rig().hand(0))) {
  const char* mean = o.text("initial_mean");
  choose_mean(mean, plan.flat_mean,
              same_name(mean, "window") || (same_name(mean, "auto") && kind == SafetyKind::kFinger));
}

void SafeThrow::judge_costs(const Step& step, Verdict* verdict) const {
  const float* base = rig().flying() ? step.action + rig().base_entries(0) : nullptr;
  judge_safety(costs_, {step.world, rig().hands(), step.command, base}, step.release, verdict);
}

}  // namespace rdm

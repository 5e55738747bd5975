#include "tasks/throw/safe_throw.hpp"

namespace rdm {
namespace {

struct MeanOptions {
  ThrowMean initial_mean;
};
constexpr auto kRows = row<&MeanOptions::initial_mean, ThrowMean::kAuto, ThrowMean::kFlat, ThrowMean::kWindow,
                           ThrowMean::kHold, ThrowMean::kZero>(text_option(
    "initial_mean", "auto", "auto|flat|window|hold|zero",
    "start of a new policy: right hand flat, the same with the first finger inside its cost window, "
    "the hold action, or 0; auto: window for the finger cost, else flat"));

}  // namespace

void add_safe_throw_options(const SafeThrowConfig& config, OptionTable& table) {
  add_throw_task_options(config, table);
  add_safety_options(config.safety, table);
  table.add(kRows);
}

SafeThrow::SafeThrow(const SafeThrowConfig* config, SafetyKind kind, const Options& o)
    : ThrowTask(*config, o, make_throw_scene(*config, o)),
      costs_(safety_costs_from(o, kind, setup().fall_height, scene(), hands().hand(0))) {
  const ThrowMean mean = kRows.read(o).initial_mean;
  choose_mean(mean, config->flat_mean,
              mean == ThrowMean::kWindow || (mean == ThrowMean::kAuto && kind == SafetyKind::kFinger));
}

void SafeThrow::judge_costs(const Step& step, Verdict* verdict) const {
  const float* base = hands().flying(0) ? step.action + hands().base_entries(0) : nullptr;
  judge_safety(costs_, {step.world, &hands().hand(0), step.command, base}, step.release, verdict);
}

}  // namespace rdm

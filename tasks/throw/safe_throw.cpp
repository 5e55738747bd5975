#include "tasks/throw/safe_throw.hpp"

#include <algorithm>

namespace rdm {
namespace {

enum class StartFinger { kAuto, kWindow, kPaper };
struct SafeThrowOptions {
  ThrowMean initial_mean;
  StartFinger start_finger;
};
constexpr auto kRows = option_rows<SafeThrowOptions>(
    row<&SafeThrowOptions::initial_mean, ThrowMean::kAuto, ThrowMean::kFlat, ThrowMean::kWindow,
        ThrowMean::kHold, ThrowMean::kZero>(
        text_option("initial_mean", "auto", "auto|flat|window|hold|zero",
                    "mean action of a new policy: hand flat; window: first finger in its window; hold; zero; "
                    "auto: by the cost")),
    row<&SafeThrowOptions::start_finger, StartFinger::kAuto, StartFinger::kWindow, StartFinger::kPaper>(
        text_option("start_finger", "auto", "auto|window|paper",
                    "first finger at the start: window: inside its windows; paper: straight; auto: window if "
                    "angles cost")));

// How far inside a window the finger begins, in the window's width.
constexpr double kMargin = 0.1;

// The first finger begins inside the windows that count, its joints no further from the paper's start than
// that takes, and is drawn inside them. False, and nothing done, where one of its joints cannot be there.
bool begin_inside(const SafetyCosts& costs, HandControl* hands) {
  const Hand& right = hands->hand(0);
  double low[kNumWindows] = {}, high[kNumWindows] = {};
  for (int i = 0; i < kNumWindows; ++i) {
    const JointWindow& w = costs.windows[i];
    if (!costs.counts[i] || w.joint < 0) continue;
    const double margin = kMargin * (w.high - w.low);
    low[i] = std::max(w.low, right.lower[w.joint]) + margin;
    high[i] = std::min(w.high, right.upper[w.joint]) - margin;
    const bool led = right.robot->action_of(w.joint) < 0;  // it goes where another joint goes
    if (led ? w.excess(hands->start(0, w.joint)) > 0 : low[i] > high[i]) return false;
  }
  for (int i = 0; i < kNumWindows; ++i) {
    const int32_t joint = costs.windows[i].joint;
    if (!costs.counts[i] || joint < 0 || right.robot->action_of(joint) < 0) continue;
    hands->begin_at(0, joint, std::clamp(hands->start(0, joint), low[i], high[i]), low[i], high[i]);
  }
  return true;
}

}  // namespace

void add_safe_throw_options(const SafeThrowConfig& config, OptionTable& table) {
  add_throw_task_options(config, table);
  add_safety_options(config.safety, table);
  table.add(kRows);
}

SafeThrow::SafeThrow(const SafeThrowConfig* config, SafetyKind kind, const Options& o)
    : ThrowTask(*config, o, make_throw_scene(*config, o)),
      costs_(safety_costs_from(o, kind, setup().fall_height, scene(), hands().hand(0))),
      guards_(safety_guards(costs_, hands())) {
  const SafeThrowOptions own = kRows.read(o);
  const bool inside = (own.start_finger == StartFinger::kWindow ||
                       (own.start_finger == StartFinger::kAuto && costs_.angle)) &&
                      begin_inside(costs_, &hands());
  const bool window = own.initial_mean == ThrowMean::kWindow ||
                      (own.initial_mean == ThrowMean::kAuto && kind == SafetyKind::kFinger);
  choose_mean(own.initial_mean, config->flat_mean,
              !window  ? FirstFinger::kFlat
              : inside ? FirstFinger::kStart
                       : FirstFinger::kBent);
}

bool SafeThrow::guard_at(int32_t i, Guard* guard, float* normal) const {
  if (i < 0 || static_cast<size_t>(i) >= guards_.size()) return false;
  const EntryGuard& g = guards_[static_cast<size_t>(i)];
  *guard = {g.column, g.bound};
  std::fill_n(normal, action_dim(), 0.0f);
  normal[g.entry] = g.sign;
  return true;
}

void SafeThrow::judge_costs(const Step& step, Verdict* verdict) const {
  const float* base = hands().flying(0) ? step.action + hands().base_entries(0) : nullptr;
  judge_safety(costs_, {step.world, &hands().hand(0), step.command, base}, step.release, verdict);
}

}  // namespace rdm

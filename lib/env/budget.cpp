#include "env/budget.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/elementary.hpp"

namespace rdm {
namespace {

constexpr double kMostLeft = 1e30;  // of what any costs and discounts leave

}  // namespace

BudgetTask::BudgetTask(const Task& inner, const Budget& budget)
    : TaskAround(inner),
      budget_(budget),
      offset_((inner.state_bytes() + sizeof(double) - 1) / sizeof(double) * sizeof(double)) {
  add_field(own_fields(), "budget", "left", "1", 1);
  if (budget_.ranged()) add_field(own_fields(), "budget", "limit", "1", 1, 0);
  const double g = budget_.discount, steps = inner.max_steps();
  if (g < 1) scale_ = (1 - elementary::pow(g, inner.max_steps())) / ((1 - g) * steps);
}

BudgetTask::State BudgetTask::read(const void* state) const {
  State s;
  std::memcpy(&s, static_cast<const unsigned char*>(state) + offset_, sizeof s);
  return s;
}

void BudgetTask::write(void* state, const State& s) const {
  std::memcpy(static_cast<unsigned char*>(state) + offset_, &s, sizeof s);
}

void BudgetTask::check_state(const void* state) const {
  inner().check_state(state);
  const State s = read(state);
  const double low = budget_.ranged() ? budget_.range.low : budget_.limit;
  const double high = budget_.ranged() ? budget_.range.high : budget_.limit;
  const bool given = s.limit == 0 || s.limit == budget_.limit;  // 0: before the first episode
  if (!given && !(s.limit >= low && s.limit <= high))
    fail(Code::kFormat, "state: the limit of a budget is %g, which is outside [%g, %g]", s.limit, low, high);
  if (!(std::abs(s.left) <= kMostLeft)) fail(Code::kFormat, "state: what is left of a budget is not finite");
}

void BudgetTask::begin(void* state, Stream& stream) const {
  State s;
  s.limit = draws_limit() ? budget_.range.draw(stream) : budget_.limit;
  double share = 1;
  if (simmers()) {
    int64_t steps = 0;
    std::memcpy(&steps, static_cast<const unsigned char*>(state) + offset_ + sizeof s, sizeof steps);
    const double grown = static_cast<double>(std::max<int64_t>(steps, 0)) / budget_.simmer_steps;
    share = std::min(1.0, budget_.simmer_start + (1 - budget_.simmer_start) * grown);
  }
  s.left = share * scale_ * s.limit;
  write(state, s);
}

void BudgetTask::spend(void* state, Verdict* verdict) const {
  State s = read(state);
  s.left = std::clamp((s.left - verdict->cost[0]) / budget_.discount, -kMostLeft, kMostLeft);
  write(state, s);
  if (simmers()) {
    unsigned char* const at = static_cast<unsigned char*>(state) + offset_ + sizeof s;
    int64_t steps = 0;
    std::memcpy(&steps, at, sizeof steps);
    steps = std::clamp<int64_t>(steps, 0, int64_t{1} << 62) + 1;
    std::memcpy(at, &steps, sizeof steps);
  }
  if (budget_.kind == BudgetKind::kShow || s.left >= 0) return;
  verdict->reward = budget_.unsafe_reward;
  if (budget_.kind == BudgetKind::kEnd) verdict->terminated = true;
}

void BudgetTask::show(const World&, const void* state, float* out) const {
  show_left(read(state), out);
}

void BudgetTask::show_left(const State& s, float* out) const {
  const double whole = scale_ * s.limit;
  out[0] = static_cast<float>(whole > 0 ? s.left / whole : s.left < 0 ? -1 : 0);
  if (budget_.ranged()) out[1] = static_cast<float>(s.limit / budget_.range.high);
}

double BudgetTask::limit(const void* state) const {
  if (state && budget_.ranged()) return read(state).limit;
  return draws_limit() ? budget_.range.middle() : budget_.limit;
}

// What was spent so far is spent under the new limit too.
void BudgetTask::set_limit(void* state, double limit, float* obs) const {
  if (!budget_.ranged())
    fail(Code::kUnsupported, "limit: option limit_range says between which limits an episode may change");
  if (!(limit >= budget_.range.low && limit <= budget_.range.high))
    fail(Code::kRange, "limit: %g is outside of limit_range, %g to %g", limit, budget_.range.low,
         budget_.range.high);
  State s = read(state);
  s.left = std::clamp(s.left + scale_ * (limit - s.limit), -kMostLeft, kMostLeft);
  s.limit = limit;
  write(state, s);
  show_left(s, obs + inner_dim());
}

void BudgetTask::reset(World& world, void* state, Stream& stream) const {
  inner().reset(world, state, stream);
  begin(state, stream);
}

Verdict BudgetTask::judge(World& world, void* state, int32_t step) const {
  Verdict v = inner().judge(world, state, step);
  spend(state, &v);
  return v;
}

void BudgetTask::reset_rows(const TaskRows& rows) const {
  inner().reset_rows(rows);
  for (int32_t i = 0; i < rows.count; ++i)
    if (rows.codes[i] == Code::kOk) begin(rows.states[i], *rows.streams[i]);
}

void BudgetTask::judge_rows(const TaskRows& rows) const {
  inner().judge_rows(rows);
  for (int32_t i = 0; i < rows.count; ++i)
    if (rows.codes[i] == Code::kOk) spend(rows.states[i], &rows.verdicts[i]);
}

}  // namespace rdm

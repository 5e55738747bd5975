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
  const double low = draws_limit() ? budget_.range.low : budget_.limit;
  const double high = draws_limit() ? budget_.range.high : budget_.limit;
  if (!(s.limit >= 0 && s.limit <= high) || (s.limit != 0 && s.limit < low))
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
  const State s = read(state);
  const double whole = scale_ * s.limit;
  out[0] = static_cast<float>(whole > 0 ? s.left / whole : s.left < 0 ? -1 : 0);
  if (budget_.ranged()) out[1] = static_cast<float>(s.limit / budget_.range.high);
}

double BudgetTask::limit(const void* state) const {
  if (!draws_limit()) return budget_.limit;
  return state ? read(state).limit : budget_.range.middle();
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

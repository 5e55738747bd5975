// Learning from recorded rows: the memory is filled once, and gradient steps are taken without a world.
//
// No episode finishes here, so J_c is what the critics make of it. With s_0 the first observations of the recorded
// episodes (at most 256 of them, evenly), over the discounts D that a value is over and n decisions of an episode:
//
//   J_c = n / D  mean of max(Q_c1, Q_c2, 0)(s_0, pi(s_0))
//
// which is the sum over an episode whose costs are spread evenly. With option discounted_limit n is the sum of an
// episode's discounts, with cost_limit_per_step it is the steps that the limit is over.
#include <algorithm>
#include <iterator>

#include "algos/off_policy/off_policy.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/fpmode.hpp"

namespace rdm {

void OffPolicy::feed(const LearnRows& rows) {
  const SharedOptions& o = resolved().shared;
  const char* const unknown = o.terminal_cost ? "terminal_cost" : o.raw_costs ? "cost_signal=raw" : nullptr;
  if (unknown)
    fail(Code::kUnsupported, "learn: option %s is of costs that a recording does not have", unknown);
  if (feed_.holds(resolved(), rows, replay_)) return;
  feed_.fill(resolved(), rows, replay_);
  fed_ = replay_.rows();
  take_statistics(rows);
}

double OffPolicy::limit_in_values(int32_t i) const {
  return resolved().limit[i] / sum_of_values(i);
}

// How many times the mean value of the first observations the sum that limit i is on is.
double OffPolicy::sum_of_values(int32_t i) const {
  const ResolvedAgentConfig& r = resolved();
  const bool rate = r.column[i] == 0 && r.rate_steps > 0;
  const double repeat = r.shared.action_repeat,
               d = elementary::pow(r.shared.discount, r.shared.action_repeat);
  double length = feed_.length(), discounts = feed_.discounts(), value_discounts = feed_.value_discounts();
  if (length == 0) {
    length = std::max(r.episode_steps / repeat, 1.0);
    discounts = d < 1 ? (1 - elementary::pow(d, static_cast<int64_t>(length))) / (1 - d) : length;
    value_discounts = d < 1 ? 1 / (1 - d) : length;
  }
  const double n = rate ? r.rate_steps / repeat : r.shared.discounted_limit ? discounts : length;
  return n / value_discounts;
}

void OffPolicy::judge_starts(JudgedCosts& out) {
  const ResolvedAgentConfig& r = resolved();
  out.count = r.num_limited;
  if (out.count == 0) return;
  const Vector<int32_t>& starts = feed_.starts();
  const auto all = static_cast<int64_t>(starts.size());
  const auto rows = static_cast<int32_t>(std::min<int64_t>(kPartRows, all));
  const size_t dim = r.obs_dim();
  for (int32_t i = 0; i < rows; ++i)
    std::copy_n(replay_.obs(starts[static_cast<size_t>(i * all / rows)]), dim, obs_ + count_of(i) * dim);
  if (normalizes()) normalizer_apply(normalizer(), obs_, rows, obs_);
  see(rows, seen_);
  // A policy's samples here must not be those that a call cut in two would not draw.
  const Stream noise = *noise_;
  judged_actions(seen_, rows, action_);
  *noise_ = noise;
  critics_.gather(obs_, action_, rows, row_);
  critics_.values(2, critics_.count(), false, row_, rows);
  for (int32_t k = 0; k < out.count; ++k) {
    double sum = 0;
    for (int32_t i = 0; i < rows; ++i)
      sum += static_cast<double>(std::max({critics_.out(2 * k + 2)[i], critics_.out(2 * k + 3)[i], 0.0f}));
    out.known[k] = out.fresh[k] = true;
    out.cost[k] = sum / rows * sum_of_values(k);
    out.limit[k] = r.limit[k];
    out.steps[k] = feed_.length() * r.shared.action_repeat;
  }
}

// The weights move at whole multiples, so it does not matter how many steps a call takes.
void OffPolicy::learn_steps(int64_t steps) {
  while (steps > 0) {
    const int64_t since = steps_ % kStepsOfWeights;
    if (since == 0) {
      JudgedCosts costs;
      judge_starts(costs);
      begin_epoch(costs, static_cast<int32_t>(std::min<int64_t>(steps_ / kStepsOfWeights + 1, INT32_MAX)));
    }
    left_ = std::min(kStepsOfWeights - since, steps);
    steps -= left_;
    for (stage_ = Stage::kDraw; left_ > 0; advance(true))
      if (stage_ == Stage::kDraw) check_cancel();
  }
}

LearnReport OffPolicy::learn(const LearnRows& rows, int64_t steps) {
  const FpMode mode;
  const HostScope scope(config().hooks);
  need_idle("learn");
  check_cancel();
  feed(rows);
  sums_ = Sums();
  const int64_t skipped_before = skipped();
  try {
    learn_steps(steps);
  } catch (...) {
    stage_ = Stage::kOver;
    end_learning();
    throw;
  }
  stage_ = Stage::kOver;
  end_learning();
  return learn_report(steps, skipped_before);
}

LearnReport OffPolicy::learn_report(int64_t steps, int64_t skipped_before) {
  LearnReport out;
  std::fill(std::begin(out.cost), std::end(out.cost), kNothing);
  JudgedCosts costs;
  judge_starts(costs);
  for (int32_t k = 0; k < costs.count; ++k) {
    out.cost[resolved().column[k]] = costs.cost[k];
    out.multiplier[resolved().column[k]] = cost_weight(k);
  }
  out.steps = steps;
  out.rows = replay_.rows();
  out.skipped = skipped() - skipped_before;
  if (sums_.steps == 0) return out;
  Learned learned;
  report(learned);
  if (sums_.actor_steps) out.loss_policy = learned.mean.loss;
  out.loss_reward_value = learned.mean.reward_loss;
  out.value_reward = mean_value(false);
  if (resolved().num_limited == 0) return out;
  out.loss_cost_value = learned.mean.cost_loss;
  out.value_cost = mean_value(true);
  return out;
}

}  // namespace rdm

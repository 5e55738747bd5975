// Learning from recorded rows: the memory is filled once, and gradient steps are taken without a world.
//
// No episode finishes here, so J_c is what the algorithm expects of its policy (judge_policy).
#include <algorithm>
#include <cmath>
#include <iterator>

#include "algos/off_policy/replay_agent.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/fpmode.hpp"

namespace rdm {

void ReplayAgent::feed_rows(const LearnRows& rows) {
  const SharedOptions& o = resolved().shared;
  const char* const unknown = o.terminal_cost ? "terminal_cost" : o.raw_costs ? "cost_signal=raw" : nullptr;
  if (unknown)
    fail(Code::kUnsupported, "learn: option %s is of costs that a recording does not have", unknown);
  if (feed_.holds(resolved(), rows, replay_)) return;
  feed_.fill(resolved(), rows, replay_);
  fed_ = replay_.rows();
  take_statistics(rows);
  rows_changed();
}

ReplayAgent::Horizons ReplayAgent::horizons() const {
  if (feed_.length() > 0) return {feed_.length(), feed_.discounts(), feed_.value_discounts()};
  const ResolvedAgentConfig& r = resolved();
  const double repeat = r.shared.action_repeat,
               d = elementary::pow(r.shared.discount, r.shared.action_repeat);
  const double n = std::max(r.episode_steps / repeat, 1.0);
  return {n, d < 1 ? (1 - elementary::pow(d, static_cast<int64_t>(n))) / (1 - d) : n,
          d < 1 ? 1 / (1 - d) : n};
}

// How many times the mean value of the first observations the sum that limit i is on is.
double ReplayAgent::sum_of_values(int32_t i) const {
  const ResolvedAgentConfig& r = resolved();
  const bool rate = r.column[i] == 0 && r.rate_steps > 0;
  const Horizons h = horizons();
  const double n = rate                        ? r.rate_steps / static_cast<double>(r.shared.action_repeat)
                   : r.shared.discounted_limit ? h.discounts
                                               : h.length;
  return n / h.values;
}

void ReplayAgent::judge_cost(int32_t i, double sum, JudgedCosts& out) const {
  out.known[i] = out.fresh[i] = !std::isnan(sum);
  out.cost[i] = sum;
  out.limit[i] = resolved().limit[i];
  out.steps[i] = feed_.length() * resolved().shared.action_repeat;
}

// The weights move, and the actor's mean is taken, at whole multiples, so it does not matter how many steps a call takes.
void ReplayAgent::learn_steps(int64_t steps) {
  while (steps > 0) {
    const int64_t since = steps_ % kStepsOfWeights;
    if (since == 0) {
      JudgedCosts costs;
      judge_policy(costs);
      begin_epoch(costs, static_cast<int32_t>(std::min<int64_t>(steps_ / kStepsOfWeights + 1, INT32_MAX)));
    }
    left_ = std::min(kStepsOfWeights - since, steps);
    steps -= left_;
    for (stage_ = Stage::kDraw; left_ > 0; advance(true))
      if (stage_ == Stage::kDraw) check_cancel();
    if (steps_ % kStepsOfWeights != 0) continue;
    begin_average(nets());  // the first is the actor to the bit
    average_actor(nets());
  }
}

LearnReport ReplayAgent::learn(const LearnRows& rows, int64_t steps) {
  const FpMode mode;
  const HostScope scope(config().hooks);
  need_idle("learn");
  check_cancel();
  feed_rows(rows);
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

LearnReport ReplayAgent::learn_report(int64_t steps, int64_t skipped_before) {
  LearnReport out;
  std::fill(std::begin(out.cost), std::end(out.cost), kNothing);
  JudgedCosts costs;
  judge_policy(costs);
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

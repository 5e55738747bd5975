#include "algos/off_policy/off_policy.hpp"

#include <algorithm>

namespace rdm {

void OffPolicy::carve(Arena& arena) {
  ReplayAgent::carve(arena);
  const ResolvedAgentConfig& r = resolved();
  critics_.carve(arena, r, options_.layer_norm);
  const size_t inputs = count_of(r.reward_critic.in) + r.action_dim();
  row_ = arena.make<float>(kRows * inputs);
  next_ = arena.make<float>(kRows * inputs);
  slope_ = arena.make<float>(kRows * r.action_dim());
  bonus_ = arena.make<float>(kRows);
}

void OffPolicy::opened() {
  ReplayAgent::opened();
  critics_.open(resolved(), workers());
}

void OffPolicy::read_live() {
  ReplayAgent::read_live();
  options_ = kOffPolicyRows.read(options());
}

void OffPolicy::begin_rows() {
  first_ = 0, net_ = 0;
  stage_ = Stage::kNext;
}

int32_t OffPolicy::group_end(bool whole) {
  return whole ? critics_.count() : std::min(net_ + workers().count(), critics_.count());
}

// A part of a batch through the actor or through some critics, or a step of these.
bool OffPolicy::step_on_rows(bool whole) {
  const int32_t rows = part_rows(), to = group_end(whole);
  const float share = 1 / static_cast<float>(options_.batch_rows);
  const auto last_group = [&] {
    const bool last = to == critics_.count();
    net_ = last ? 0 : to;
    return last;
  };
  switch (stage_) {
    case Stage::kNext:
      gather_next(rows);
      stage_ = Stage::kTargets;
      break;
    case Stage::kTargets:
      critics_.values(net_, to, true, next_, rows);
      if (!last_group()) break;
      make_targets(rows);
      stage_ = Stage::kGradients;
      break;
    case Stage::kGradients:
      critics_.gradients(net_, to, row_, rows, share, first_ == 0);
      if (!last_group()) break;
      see(obs(), rows, seen());
      add_to_critics(seen(), row_, rows);
      first_ += rows;
      stage_ = first_ < options_.batch_rows ? Stage::kNext : Stage::kCritics;
      break;
    case Stage::kCritics:
      critics_.step(net_, to, critics_rate(), most_norm(), options_.tau);
      if (!last_group()) break;
      end_critics_step(critics_rate(), most_norm());
      count_step();
      first_ = 0;
      stage_ = Stage::kOwn;
      if (steps() % options_.policy_delay == 0) break;
      end_gradient_step();
      return true;
    case Stage::kOwn:
      gather_own(rows);
      stage_ = Stage::kValues;
      break;
    case Stage::kValues:
      critics_.values(net_, to, false, row_, rows);
      if (!last_group()) break;
      weigh(rows);
      stage_ = Stage::kSlopes;
      break;
    case Stage::kSlopes:
      critics_.slopes(net_, to, row_, rows);
      if (!last_group()) break;
      learn_part(rows);
      first_ += rows;
      stage_ = first_ < options_.batch_rows ? Stage::kOwn : Stage::kActor;
      break;
    case Stage::kActor:
      step_actor();
      end_actor_step();
      end_gradient_step();
      return true;
  }
  return false;
}

void OffPolicy::gather_next(int32_t rows) {
  const size_t dim = resolved().action_dim();
  const int32_t* const list = ReplayAgent::drawn() + first_;
  load(list, true, rows, obs());
  see(obs(), rows, seen());
  next_actions(seen(), rows, action(), bonus_);
  critics_.gather(obs(), action(), rows, next_);
  load(list, false, rows, obs());
  for (int32_t i = 0; i < rows; ++i) std::copy_n(replay().action(list[i]), dim, action() + count_of(i) * dim);
  critics_.gather(obs(), action(), rows, row_);
}

void OffPolicy::make_targets(int32_t rows) {
  for (int32_t i = 0; i < rows; ++i) {
    const int32_t at = drawn(i);
    const float d = replay().discount(at);
    const float value = std::min(critics_.out(0)[i], critics_.out(1)[i]) + bonus_[i];
    critics_.y(0)[i] = replay().reward(at) + d * (counts(i) ? value : std::min(value, 0.0f));
    for (int32_t pair = 1; pair < critics_.pairs(); ++pair) {
      const float next = std::max({critics_.out(2 * pair)[i], critics_.out(2 * pair + 1)[i], 0.0f});
      critics_.y(pair)[i] = replay().cost(at)[pair - 1] + d * next;
    }
  }
}

void OffPolicy::gather_own(int32_t rows) {
  load(ReplayAgent::drawn() + first_, false, rows, obs());
  see(obs(), rows, seen());
  own_actions(seen(), rows, action());
  critics_.gather(obs(), action(), rows, row_);
}

// What a change of each critic's value is worth in the actor's loss.
void OffPolicy::weigh(int32_t rows) {
  double sum = 0;
  for (int32_t k = 1; k < critics_.pairs(); ++k) sum += cost_weight(k - 1);
  const double whole = mix() == Mix::kSum ? 1 + sum : 1, reward = mix() == Mix::kDifference ? 1 - sum : 1;
  const double share = critics_share(rows) / (whole * options_.batch_rows);
  for (int32_t pair = 0; pair < critics_.pairs(); ++pair) {
    const auto value = static_cast<float>(pair == 0 ? -reward * share : cost_weight(pair - 1) * share);
    const float *one = critics_.out(2 * pair), *other = critics_.out(2 * pair + 1);
    for (int32_t i = 0; i < rows; ++i) {
      const bool first = pair > 0 ? one[i] >= other[i] : !climbs_smaller() || one[i] <= other[i];
      const auto weight = static_cast<float>(weight_at(pair, i, value));
      critics_.weight(2 * pair)[i] = first ? weight : 0;
      critics_.weight(2 * pair + 1)[i] = first ? 0 : weight;
      sums().policy_loss += static_cast<double>(weight) * static_cast<double>(first ? one[i] : other[i]);
    }
  }
}

void OffPolicy::learn_part(int32_t rows) {
  const size_t count = count_of(rows) * resolved().action_dim();
  std::copy_n(critics_.slopes(0), count, slope_);
  for (int32_t net = 1; net < critics_.count(); ++net)
    for (size_t j = 0; j < count; ++j) slope_[j] += critics_.slopes(net)[j];
  double sum = 0;
  for (int32_t k = 1; k < critics_.pairs(); ++k) sum += cost_weight(k - 1);
  const double whole = mix() == Mix::kSum ? 1 + sum : 1;
  const auto share = static_cast<float>(1 / (whole * options_.batch_rows));
  sums().policy_loss += learn_actions(seen(), rows, slope_, share, actor_gradient(first_part()));
  add_actor_gradient(first_part());
}

void OffPolicy::end_gradient_step() {
  const double rows = options_.batch_rows;
  for (int32_t net = 0; net < critics_.count(); ++net) {
    const bool reward = net < 2;
    const double networks = reward ? 2 : critics_.count() - 2;
    (reward ? sums().reward_loss : sums().cost_loss) += critics_.loss(net) / (rows * networks);
    if (net < 4) (reward ? sums().value : sums().cost_value) += critics_.sum(net) / (2 * rows);
  }
}

void OffPolicy::judge_policy(JudgedCosts& out) {
  out.count = resolved().num_limited;
  if (out.count == 0) return;
  const Vector<int32_t>& starts = feed().starts();
  const auto all = static_cast<int64_t>(starts.size());
  const auto rows = static_cast<int32_t>(std::min<int64_t>(kPartRows, all));
  int32_t list[kPartRows];
  for (int32_t i = 0; i < rows; ++i) list[i] = starts[static_cast<size_t>(i * all / rows)];
  load(list, false, rows, obs());
  see(obs(), rows, seen());
  // A policy's samples here must not be those that a call cut in two would not draw.
  const Stream before = noise();
  judged_actions(seen(), rows, action());
  noise() = before;
  critics_.gather(obs(), action(), rows, row_);
  critics_.values(2, critics_.count(), false, row_, rows);
  for (int32_t k = 0; k < out.count; ++k) {
    double sum = 0;
    for (int32_t i = 0; i < rows; ++i)
      sum += static_cast<double>(std::max({critics_.out(2 * k + 2)[i], critics_.out(2 * k + 3)[i], 0.0f}));
    judge_cost(k, sum / rows * sum_of_values(k), out);
  }
}

}  // namespace rdm

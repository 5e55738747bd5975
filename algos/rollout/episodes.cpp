#include "algos/rollout/episodes.hpp"

#include <algorithm>

namespace rdm {
namespace {
constexpr double kBound = 1e60;  // on sums of floats over an episode
}  // namespace

void Episodes::carve(Arena& arena, int32_t num_envs, int32_t cost_dim, int32_t cost_window, int32_t ranks) {
  num_envs_ = num_envs;
  cost_dim_ = cost_dim;
  cost_window_ = cost_window;
  capacity_ = std::max(cost_window, kStatsWindow);
  const auto n = static_cast<size_t>(num_envs), k = static_cast<size_t>(cost_dim);
  const auto c = static_cast<size_t>(capacity_);
  ret_ = arena.make<double>(n);
  cost_ = arena.make<double>(n * k);
  weighed_ = arena.make<double>(n * k);
  length_ = arena.make<int64_t>(n);
  success_ = arena.make<uint8_t>(n);
  done_ret_ = arena.make<double>(c);
  done_cost_ = arena.make<double>(c * k);
  done_charged_ = arena.make<double>(c * k);
  done_length_ = arena.make<int64_t>(c);
  done_fall_ = arena.make<uint8_t>(c);
  done_success_ = arena.make<uint8_t>(c);
  if (ranks == 1) return;
  const size_t rows = c * wide();
  ended_ = arena.make<double>(rows);
  arrived_ = arena.make<double>(rows * static_cast<size_t>(ranks));
  counts_ = arena.make<int64_t>(static_cast<size_t>(ranks));
  next_ = arena.make<int32_t>(static_cast<size_t>(ranks));
}

void Episodes::add(int32_t env, double reward, const float* cost, int32_t steps, bool success,
                   double weight) {
  ret_[env] += reward;
  for (int32_t k = 0; k < cost_dim_; ++k) {
    cost_[at(env, k)] += static_cast<double>(cost[k]);
    weighed_[at(env, k)] += weight * static_cast<double>(cost[k]);
  }
  length_[env] += steps;
  if (success) success_[env] = 1;
}

void Episodes::finish(int32_t env, bool terminated, const double* charge) {
  double own[kOwn + 2 * kMaxCosts];
  double* const row = ended_ ? ended_ + static_cast<size_t>(ended_count_++ % capacity_) * wide() : own;
  row[kMoment] = static_cast<double>(moment_);
  row[kReturn] = ret_[env];
  row[kLength] = static_cast<double>(length_[env]);
  row[kFall] = terminated;
  row[kSuccess] = success_[env];
  double *const cost = row + kOwn, *const charged = cost + cost_dim_;
  for (int32_t k = 0; k < cost_dim_; ++k) {
    cost[k] = cost_[at(env, k)];
    charged[k] = weighed_[at(env, k)] + (charge ? charge[k] : 0);
    cost_[at(env, k)] = weighed_[at(env, k)] = 0;
  }
  ret_[env] = 0;
  length_[env] = 0;
  success_[env] = 0;
  if (!ended_) take(row);
}

void Episodes::take(const double* row) {
  const auto slot = static_cast<int32_t>(finished_ % capacity_);
  done_ret_[slot] = row[kReturn];
  done_length_[slot] = static_cast<int64_t>(row[kLength]);
  done_fall_[slot] = row[kFall] != 0;
  done_success_[slot] = row[kSuccess] != 0;
  std::copy_n(row + kOwn, cost_dim_, done_cost_ + at(slot, 0));
  std::copy_n(row + kOwn + cost_dim_, cost_dim_, done_charged_ + at(slot, 0));
  ++finished_;
}

// A rank keeps its last capacity_ ones: older ones are counted, and no number is of them.
void Episodes::settle(Ranks& ranks) {
  if (!ended_) return;
  const int32_t count = ranks.count();
  ranks.gather(&ended_count_, sizeof ended_count_, counts_);
  int64_t most = 0;
  for (int32_t r = 0; r < count; ++r) {
    const int64_t there = std::min<int64_t>(counts_[r], capacity_);
    most = std::max(most, there);
    finished_ += counts_[r] - there;
    counts_[r] = there;
    next_[r] = 0;
  }
  // from the oldest on
  const int64_t first = ended_count_ - std::min<int64_t>(ended_count_, capacity_);
  std::rotate(ended_, ended_ + static_cast<size_t>(first % capacity_) * wide(),
              ended_ + static_cast<size_t>(capacity_) * wide());
  const size_t each = static_cast<size_t>(most) * wide();
  ranks.gather(ended_, each * sizeof *ended_, arrived_);
  for (;;) {
    const double* soonest = nullptr;
    int32_t from = 0;
    for (int32_t r = 0; r < count; ++r) {
      if (next_[r] == counts_[r]) continue;
      const double* row = arrived_ + static_cast<size_t>(r) * each + static_cast<size_t>(next_[r]) * wide();
      // of one moment those of the lower rank come first, and a rank's own are in order
      if (!soonest || row[kMoment] < soonest[kMoment]) soonest = row, from = r;
    }
    if (!soonest) break;
    take(soonest);
    ++next_[from];
  }
  ended_count_ = moment_ = 0;
}

EpisodeStats Episodes::stats() const {
  EpisodeStats s;
  s.finished = finished_;
  s.fresh = finished_ > marked_;
  const int64_t shown = std::min<int64_t>(finished_, kStatsWindow);
  if (shown == 0) return s;
  s.ret = s.length = s.fall_rate = s.success_rate = s.cost_per_step = 0;
  std::fill_n(s.cost, kMaxCosts, 0.0);
  std::fill_n(s.charged_cost, kMaxCosts, 0.0);
  for (int64_t i = finished_ - shown; i < finished_; ++i) {
    const auto slot = static_cast<int32_t>(i % capacity_);
    s.ret += done_ret_[slot];
    s.length += static_cast<double>(done_length_[slot]);
    s.fall_rate += done_fall_[slot];
    s.success_rate += done_success_[slot];
    for (int32_t k = 0; k < cost_dim_; ++k) s.cost[k] += done_cost_[at(slot, k)];
  }
  const int64_t charged = std::min<int64_t>(finished_, cost_window_);
  for (int64_t i = finished_ - charged; i < finished_; ++i)
    for (int32_t k = 0; k < cost_dim_; ++k)
      s.charged_cost[k] += done_charged_[at(static_cast<int32_t>(i % capacity_), k)];
  if (s.length > 0) s.cost_per_step = s.cost[0] / s.length;
  for (double* sum : {&s.ret, &s.length, &s.fall_rate, &s.success_rate}) *sum /= static_cast<double>(shown);
  for (int32_t k = 0; k < cost_dim_; ++k) {
    s.cost[k] /= static_cast<double>(shown);
    s.charged_cost[k] /= static_cast<double>(charged);
  }
  return s;
}

void Episodes::visit(StateIo& io) {
  io.section("EPIS");
  const auto n = static_cast<size_t>(num_envs_), k = static_cast<size_t>(cost_dim_);
  const auto c = static_cast<size_t>(capacity_);
  io.integer(marked_, 0, io.integer(finished_, 0, kMaxCounter));
  io.share(ret_, n, -kBound, kBound);
  io.share(cost_, n * k, -kBound, kBound);
  io.share(weighed_, n * k, -kBound, kBound);
  io.share_counters(length_, n);
  io.share_flags(success_, n);
  io.numbers(done_ret_, c, -kBound, kBound);
  io.numbers(done_cost_, c * k, -kBound, kBound);
  io.numbers(done_charged_, c * k, -kBound, kBound);
  for (size_t i = 0; i < c; ++i) io.counter(done_length_[i]);
  io.flags(done_fall_, c);
  io.flags(done_success_, c);
}

}  // namespace rdm

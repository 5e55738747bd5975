#include "algos/off_policy/feed.hpp"

#include <algorithm>

#include "algos/core/by_episode.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"

namespace rdm {
namespace {

int64_t episode_of(const LearnRows& rows, int32_t i) {
  return rows.episode ? rows.episode[i] : 0;
}
bool set(const uint8_t* flags, int32_t i) {
  return flags && flags[i];
}

}  // namespace

// Nothing is done where the order is right already.
void Feed::put_in_order(const LearnRows& rows) {
  const auto n = static_cast<size_t>(rows.rows);
  const auto before = by_episode([&](int32_t i) { return episode_of(rows, i); });
  if (order_.size() == n && std::is_sorted(order_.begin(), order_.end(), before)) return;
  order_.resize(n);
  for (size_t i = 0; i < n; ++i) order_[i] = static_cast<int32_t>(i);
  std::sort(order_.begin(), order_.end(), before);
}

bool Feed::pass(const ResolvedAgentConfig& resolved, const LearnRows& rows, Replay& replay, Pass how) {
  const SharedOptions& o = resolved.shared;
  const double d = elementary::pow(o.discount, o.action_repeat);
  const auto factor = static_cast<float>(o.reward_factor);
  const size_t obs_dim = resolved.obs_dim(), action_dim = resolved.action_dim(), n = order_.size();
  const int32_t ring = replay.capacity() / resolved.config.num_envs;
  used_.assign(resolved.num_envs(), 0);
  starts_.clear();
  double episodes = 0;
  length_ = discounts_ = value_discounts_ = 0;
  for (size_t first = 0, end = 0; first < n; first = end) {
    bool over = false, terminated = false;
    for (end = first; end < n && !over; ++end) {
      terminated = set(rows.terminated, order_[end]);
      over = terminated || set(rows.truncated, order_[end]) || end + 1 == n ||
             episode_of(rows, order_[end]) != episode_of(rows, order_[end + 1]);
    }
    const auto env = static_cast<int32_t>(std::min_element(used_.begin(), used_.end()) - used_.begin());
    int32_t& used = used_[count_of(env)];
    const auto count = static_cast<int32_t>(end - first);
    if (count > ring - used) {
      if (how == Pass::kCompare) return false;
      fail(
          Code::kRange,
          "replay_rows: %d has no place for the recording's %lld rows in %d parts, one for each environment; "
          "give as many as it has, and its longest episode for each part",
          resolved.config.num_envs * (ring - 1), static_cast<long long>(rows.rows), resolved.config.num_envs);
    }
    if (count > 1 || terminated) starts_.push_back(env * ring + used);
    for (size_t i = first; i < end; ++i, ++used) {
      const auto at = static_cast<size_t>(order_[i]);
      const bool last = i + 1 == end, drawn = !last || terminated;
      float costs[kMaxCosts] = {};
      for (int32_t k = 0; k < resolved.num_limited; ++k) {
        costs[k] = rows.cost[at * count_of(rows.cost_dim) + count_of(resolved.column[k])];
        if (how == Pass::kCheck && costs[k] < 0)
          fail(Code::kArgument, "recording: row %zu has a cost of %g, which is below 0", at,
               static_cast<double>(costs[k]));
      }
      const ReplayRow row{rows.obs + at * obs_dim, rows.action + at * action_dim, factor * rows.reward[at],
                          costs, last ? 0.0f : static_cast<float>(d)};
      if (how == Pass::kCompare && !replay.is(env * ring + used, row, drawn)) return false;
      if (how == Pass::kFill && drawn) replay.push(env, row);
      if (how == Pass::kFill && !drawn) replay.end(env, row.obs);
    }
    const double sum = d < 1 ? (1 - elementary::pow(d, count)) / (1 - d) : count;
    episodes += 1, length_ += count, discounts_ += sum;
    value_discounts_ += terminated || d == 1 ? sum : 1 / (1 - d);
  }
  length_ /= episodes, discounts_ /= episodes, value_discounts_ /= episodes;
  return true;
}

void Feed::fill(const ResolvedAgentConfig& resolved, const LearnRows& rows, Replay& replay) {
  put_in_order(rows);
  pass(resolved, rows, replay, Pass::kCheck);
  if (starts_.empty())
    fail(Code::kArgument,
         "recording: no row is followed by another one or by a termination, so nothing can be learned");
  replay.clear();
  pass(resolved, rows, replay, Pass::kFill);
}

bool Feed::holds(const ResolvedAgentConfig& resolved, const LearnRows& rows, Replay& replay) {
  if (replay.rows() < 1 || rows.rows >= replay.capacity()) return false;
  put_in_order(rows);
  return pass(resolved, rows, replay, Pass::kCompare);
}

}  // namespace rdm

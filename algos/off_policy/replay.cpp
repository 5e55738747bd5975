#include "algos/off_policy/replay.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

namespace rdm {
namespace {

constexpr auto kMostOfRow = static_cast<double>(std::numeric_limits<float>::max());
constexpr auto kMost = static_cast<double>(kMaxReplayed);

float kept_reward(const ReplayRow& row) {
  return std::clamp(row.reward, -kMaxReplayed, kMaxReplayed);
}
float kept_cost(float cost) {
  return std::min(cost, kMaxReplayed);
}

}  // namespace

int32_t Replay::rows_of_world(int64_t rows, int32_t num_envs) {
  return static_cast<int32_t>((rows + num_envs - 1) / num_envs) + 1;
}

void Replay::carve(Arena& arena, const ResolvedAgentConfig& resolved, int64_t rows) {
  const size_t envs = resolved.num_envs(), n = envs * count_of(rows_of_world(rows, resolved.config.num_envs));
  obs_ = arena.make<float>(n * resolved.obs_dim());
  action_ = arena.make<float>(n * resolved.action_dim());
  cost_ = arena.make<float>(n * count_of(resolved.num_limited));
  reward_ = arena.make<float>(n);
  discount_ = arena.make<float>(n);
  drawable_ = arena.make<uint8_t>(n);
  head_ = arena.make<int32_t>(envs);
  size_ = arena.make<int32_t>(envs);
  foretold_ = arena.make<uint8_t>(envs);
  num_envs_ = resolved.config.num_envs;
  capacity_ = rows_of_world(rows, num_envs_);
}

void Replay::open(const ResolvedAgentConfig& resolved) {
  obs_dim_ = resolved.obs_dim();
  action_dim_ = resolved.action_dim();
  num_costs_ = count_of(resolved.num_limited);
}

// The row at the head of a ring, whose oldest one it may be until now. The head goes on.
int32_t Replay::take(int32_t env) {
  const int32_t at = env * capacity_ + head_[env];
  rows_ -= drawable_[at];
  drawable_[at] = 0;
  head_[env] = (head_[env] + 1) % capacity_;
  size_[env] = std::min(size_[env] + 1, capacity_);
  longest_ = std::max(longest_, size_[env]);
  return at;
}

void Replay::push(int32_t env, const ReplayRow& row) {
  int32_t at = env * capacity_ + head_[env];
  const size_t bytes = obs_dim_ * sizeof(float);
  if (foretold_[env] && std::memcmp(obs(at), row.obs, bytes) != 0)
    take(env), at = env * capacity_ + head_[env];
  foretold_[env] = 0;
  take(env);
  std::memcpy(obs_ + count_of(at) * obs_dim_, row.obs, bytes);
  std::copy_n(row.action, action_dim_, action_ + count_of(at) * action_dim_);
  for (size_t k = 0; k < num_costs_; ++k) cost_[count_of(at) * num_costs_ + k] = kept_cost(row.cost[k]);
  reward_[at] = kept_reward(row);
  discount_[at] = row.discount;
  drawable_[at] = 1;
  ++rows_;
}

// The row at the head has the observation, and is not counted as taken: nothing of it is drawn.
void Replay::follow(int32_t env, const float* obs) {
  const int32_t at = env * capacity_ + head_[env];
  if (foretold_[env]) return;
  rows_ -= drawable_[at];
  drawable_[at] = 0;
  std::memcpy(obs_ + count_of(at) * obs_dim_, obs, obs_dim_ * sizeof(float));
  foretold_[env] = 1;
}

void Replay::end(int32_t env, const float* obs) {
  follow(env, obs);
  foretold_[env] = 0;
  take(env);
}

bool Replay::is(int32_t i, const ReplayRow& row, bool drawn) const {
  if (drawable(i) != drawn || std::memcmp(obs(i), row.obs, obs_dim_ * sizeof(float)) != 0) return false;
  if (!drawn) return true;
  bool same = reward_[i] == kept_reward(row) && discount_[i] == row.discount &&
              std::equal(row.action, row.action + action_dim_, action(i));
  for (size_t k = 0; k < num_costs_; ++k) same = same && cost(i)[k] == kept_cost(row.cost[k]);
  return same;
}

void Replay::clear() {
  std::fill_n(drawable_, count_of(num_envs_) * count_of(capacity_), uint8_t{0});
  std::fill_n(head_, num_envs_, 0);
  std::fill_n(size_, num_envs_, 0);
  std::fill_n(foretold_, num_envs_, uint8_t{0});
  rows_ = 0, longest_ = 0;
}

// A place of the fullest ring's length is drawn until one is a row that can be.
void Replay::draw(Stream& stream, int32_t count, int32_t* drawn) const {
  const auto places = static_cast<uint32_t>(longest_);
  for (int32_t i = 0; i < count; ++i) {
    int32_t at = 0;
    do {
      const auto env =
          num_envs_ > 1 ? static_cast<int32_t>(stream.below(static_cast<uint32_t>(num_envs_))) : 0;
      at = env * capacity_ + static_cast<int32_t>(stream.below(places));
    } while (!drawable_[at]);
    drawn[i] = at;
  }
}

// What stands before such a row did not lead to it. Of a full ring the oldest row has nothing before it that is known.
int32_t Replay::first_rows(int32_t* out) const {
  int32_t count = 0;
  for (int32_t env = 0; env < num_envs_; ++env) {
    const int32_t begin = env * capacity_, rows = std::min(size_[env], capacity_);
    const bool full = rows == capacity_;
    const int32_t oldest = full ? (head_[env] + foretold_[env]) % capacity_ : -1;
    for (int32_t at = 0; at < rows; ++at) {
      const int32_t i = begin + at, before = begin + (at + capacity_ - 1) % capacity_;
      if (!drawable_[i] || at == oldest) continue;
      if ((!full && at == 0) || !drawable_[before] || discount_[before] == 0) out[count++] = i;
    }
  }
  return count;
}

void Replay::visit(StateIo& io) {
  io.section("RPLY");
  for (int32_t env = 0; env < num_envs_; ++env) {
    int64_t head = head_[env], size = size_[env], foretold = foretold_[env];
    const int64_t place = io.integer(head, 0, capacity_ - 1), rows = io.integer(size, 0, capacity_);
    const int64_t more = io.integer(foretold, 0, 1);
    const size_t first = count_of(env) * count_of(capacity_);
    io.require(rows == capacity_ || place == rows, "a ring of the replay memory that has gaps");
    // A ring that is not full begins at its first place; the foretold row is the one behind.
    const auto n = static_cast<size_t>(std::min<int64_t>(rows + more, capacity_));
    io.flags(drawable_ + first, n);
    io.numbers(obs_ + first * obs_dim_, n * obs_dim_, -kMostOfRow, kMostOfRow);
    io.numbers(action_ + first * action_dim_, n * action_dim_, -1, 1);
    io.numbers(reward_ + first, n, -kMost, kMost);
    io.numbers(cost_ + first * num_costs_, n * num_costs_, 0, kMost);
    io.numbers(discount_ + first, n, 0, 1);
    head_[env] = static_cast<int32_t>(head);
    size_[env] = static_cast<int32_t>(size);
    foretold_[env] = static_cast<uint8_t>(foretold);
  }
}

void Replay::after_load() {
  rows_ = 0, longest_ = 0;
  for (int32_t env = 0; env < num_envs_; ++env) {
    uint8_t* const drawable = drawable_ + count_of(env) * count_of(capacity_);
    const int32_t n = std::min(size_[env], capacity_);
    if (foretold_[env]) drawable[head_[env]] = 0;
    std::fill(drawable + n, drawable + capacity_, uint8_t{0});
    for (int32_t i = 0; i < n; ++i) rows_ += drawable[i];
    longest_ = std::max(longest_, size_[env]);
  }
}

}  // namespace rdm

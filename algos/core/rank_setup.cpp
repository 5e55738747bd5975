#include "algos/core/rank_setup.hpp"

#include <cstring>

#include "base/bit_cast.hpp"
#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {
namespace {

constexpr uint64_t kMark = 0x72616e6b73657475;  // of a message that is one

uint64_t hash_of(const char* text) {
  return hash_bytes(text, std::strlen(text));
}
template <class T>
uint64_t hash_of(const T* x, int32_t count) {
  return x ? hash_bytes(x, static_cast<size_t>(count) * sizeof *x) : 0;
}

}  // namespace

void RankSetup::add(const char* kind, const char* name, uint64_t value, bool number) {
  if (words_ == kMost) fail(Code::kInternal, "ranks: the setup has more than %zu words", kMost);
  if (word_) word_[words_] = {kind, name, number}, mine_[words_] = value;
  ++words_;
}

void RankSetup::carve(Arena& arena, const ResolvedAgentConfig& resolved) {
  const AgentConfig& c = resolved.config;
  count_ = c.ranks.count;
  words_ = 0;
  word_ = arena.make<Word>(kMost);
  mine_ = arena.make<uint64_t>(kMost);
  all_ = arena.make<uint64_t>(kMost * static_cast<size_t>(count_));
  const auto number = [&](const char* name, int64_t value) {
    add("", name, static_cast<uint64_t>(value), true);
  };
  const auto other = [&](const char* name, uint64_t value) { add("", name, value, false); };
  other("message", kMark);
  number("rank", c.ranks.rank);
  number("ranks", count_);
  number("version", c.ranks.version);
  other("algo", hash_of(c.algo));
  number("num_envs", c.num_envs);
  number("horizon", resolved.shared.horizon);
  number("seed", static_cast<int64_t>(c.seed));
  number("obs_dim", c.obs_dim);
  number("action_dim", c.action_dim);
  number("cost_dim", c.cost_dim);
  number("max_steps", c.max_steps);
  other("control_dt", bit_cast<uint32_t>(c.control_dt));
  other("task", hash_of(resolved.task));
  other("layout_hash", c.layout_hash);
  other("initial_mean", hash_of(c.initial_mean, c.action_dim));
  other("cost_limits",
        hash_of(resolved.column, resolved.num_limited) ^ hash_of(resolved.limit, resolved.num_limited));
  pool_ = words_;
  add("pool ", "seed", 0, true);
  add("pool ", "autoreset", 0, true);
  add("pool ", "options", 0, false);
  const Options& o = resolved.options;
  for (int32_t i = 0; i < o.count(); ++i) {
    const OptionSpec& s = o.spec(i);
    uint64_t value = 0;
    if (s.kind == OptionKind::kText)
      value = hash_of(o.text(s.key));
    else if (s.kind == OptionKind::kFlag)
      value = o.flag(s.key);
    else {
      const OptionRange range = o.range(s.key);
      value = hash_of(&range, 1);
    }
    add("option ", s.key, value, false);
  }
}

void RankSetup::set_pool(uint64_t seed, int32_t autoreset, uint64_t options) {
  if (!mine_) return;
  mine_[pool_] = seed;
  mine_[pool_ + 1] = static_cast<uint64_t>(autoreset);
  mine_[pool_ + 2] = options;
}

void RankSetup::compare() const {
  for (int32_t r = 0; r < count_; ++r) {
    if (of(r)[0] != kMark)
      fail(Code::kState, "ranks: the data received for rank %d is not a message of this library", r);
    if (of(r)[1] != static_cast<uint64_t>(r))
      fail(Code::kState, "ranks: the message received for rank %d says that it comes from rank %lld", r,
           static_cast<long long>(of(r)[1]));
  }
  for (size_t i = 2; i < words_; ++i)
    for (int32_t r = 1; r < count_; ++r) {
      if (of(r)[i] == of(0)[i]) continue;
      const Word& w = word_[i];
      if (!w.number)
        fail(Code::kState, "ranks: %s%s of rank %d differs from that of rank 0", w.kind, w.name, r);
      fail(Code::kState, "ranks: %s%s differs: rank %d has %lld, rank 0 has %lld", w.kind, w.name, r,
           static_cast<long long>(of(r)[i]), static_cast<long long>(of(0)[i]));
    }
}

}  // namespace rdm

// Saving, restoring and hashing worlds.
//
// A copy moves the same parts as memory, and nothing is checked: what a pool has is sound.
//
// A state is a file of two sections: HEAD says what it belongs to, WRLD holds one record a world: length,
// world, task struct, episode, observation row, and what the world's disturbances remember, where it has any.
// EPST has what went wrong so far in each episode, RDM_STATUS_*; states of version 1 have none: 0.
// Hashes are of the worlds alone.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/bytes.hpp"
#include "base/hash.hpp"
#include "env/pool_internal.hpp"

namespace rdm {
namespace {

constexpr char kMagic[8] = {'R', 'D', 'M', 'S', 'T', 'A', 'T', 'E'};
constexpr uint32_t kVersion = 2;  // 1, before redman 1.0: without EPST
constexpr size_t kTextSize = 64;
constexpr int32_t kFewCopies = 16;  // made sooner than other threads wake up
constexpr uint32_t kEveryStatus = kStatusContactOverflow | kStatusDiverged | kStatusBadAction | kStatusTask |
                                  kStatusUnconverged | kStatusSlowed;

struct Range {
  int32_t begin, end;
  int32_t count() const { return end - begin; }
};

Range range_of(int32_t env, int32_t num_envs) {
  if (env < -1 || env >= num_envs) fail(Code::kRange, "env: %d is outside [-1, %d)", env, num_envs);
  return env < 0 ? Range{0, num_envs} : Range{env, env + 1};
}

void write_episode(const Episode& e, int32_t costs, Writer& out) {
  out.value(e.seed);
  out.value(e.reset);
  out.value(e.policy);
  out.value(e.phase);
  out.value(e.step);
  out.value(e.terminated);
  out.value(e.truncated);
  out.value(e.sum_reward);
  for (int32_t k = 0; k < costs; ++k) out.value(e.sum_cost[k]);
}

bool read_flag(Reader& in) {
  const auto flag = in.value<uint8_t>();
  if (flag > 1) fail(Code::kFormat, "state: a flag is %u, not 0 or 1", flag);
  return flag != 0;
}

void read_episode(Reader& in, int32_t costs, Episode* e) {
  e->seed = in.value<uint64_t>();
  e->reset = in.value<Stream>();
  e->policy = in.value<Stream>();
  const auto phase = in.value<uint32_t>();
  if (phase > static_cast<uint32_t>(Phase::kEnded))
    fail(Code::kFormat, "state: a phase is %u, which does not exist", phase);
  e->phase = static_cast<Phase>(phase);
  e->step = in.value<int32_t>();
  e->terminated = read_flag(in);
  e->truncated = read_flag(in);
  e->sum_reward = in.value<double>();
  for (int32_t k = 0; k < costs; ++k) e->sum_cost[k] = in.value<double>();
}

void check_episode(const Episode& e, int32_t costs, int32_t max_steps) {
  // a running world has steps left, an ended one has taken some and says how it ended, a new one none of it
  const bool ended = e.phase == Phase::kEnded;
  const int32_t low = ended ? 1 : 0, high = e.phase == Phase::kNew ? 0 : max_steps - !ended;
  if (e.step < low || e.step > high)
    fail(Code::kFormat, "state: step %d is outside [%d, %d]", e.step, low, high);
  if (ended != (e.terminated || e.truncated))
    fail(Code::kFormat, "state: its phase and its end flags do not agree");
  bool good = std::abs(e.sum_reward) <= kMaxSum;
  for (int32_t k = 0; k < costs; ++k) good = good && std::abs(e.sum_cost[k]) <= kMaxSum;
  if (!good) fail(Code::kFormat, "state: a sum is not finite, or its magnitude is above %g", kMaxSum);
}

}  // namespace

void Pool::Impl::write_world(int32_t env, Writer& out) const {
  const Slot& s = slots[env];
  out.value(static_cast<uint64_t>(pristine_size));
  s.world->save(out);
  out.bytes(s.task_state, task->state_bytes());
  write_episode(s.episode, cost_dim, out);
  out.bytes(obs(env), sizeof(float) * static_cast<size_t>(obs_dim));
  if (disturbance.any()) s.disturbance.write(out);
}

void Pool::Impl::read_world(int32_t env, Reader& in, bool keep_streams) {
  Slot& s = slots[env];
  in.view(sizeof(uint64_t));
  s.world->take(in);
  in.bytes(s.task_state, task->state_bytes());
  read_episode(in, cost_dim, &s.episode);
  in.bytes(obs(env), sizeof(float) * static_cast<size_t>(obs_dim));
  if (disturbance.any()) s.disturbance.read(in, keep_streams);
}

Phase Pool::Impl::check_world(Reader& in) {
  if (in.value<uint64_t>() != pristine_size || in.left() < pristine_size)
    fail(Code::kFormat, "state: the record of a world has a different length");
  slots[0].world->check(in);
  in.bytes(tried_state, task->state_bytes());
  Episode e{};
  read_episode(in, cost_dim, &e);
  check_episode(e, cost_dim, task->max_steps());
  for (int32_t i = 0; i < obs_dim; ++i) {
    const auto x = in.value<float>();
    if (!std::isfinite(x) || std::abs(x) > obs_limit)
      fail(Code::kFormat, "state: observation %d is not finite, or its magnitude is above %g", i,
           static_cast<double>(obs_limit));
  }
  if (disturbance.any()) tried.read(in);
  // of a world that is not running, the next reset zeroes the struct before anything reads it
  if (e.phase == Phase::kRunning) {
    task->check_state(tried_state);
    if (disturbance.any()) tried.check(disturbance);
  }
  return e.phase;
}

size_t Pool::state_size(int32_t env) const {
  Writer count(nullptr, 0);
  get_state(env, count);
  return count.size();
}

void Pool::get_state(int32_t env, Writer& out) const {
  const FpMode mode;
  const Impl& m = *impl_;
  const Range range = range_of(env, m.config.num_envs);
  out.begin_file(kMagic, kVersion);
  out.begin_section("HEAD");
  out.text(m.info->name);
  out.value(static_cast<int32_t>(m.slots[0].world->engine()));
  out.value(m.options_hash);
  out.value(m.layout);
  out.value(range.count());
  out.end_section();
  out.begin_section("WRLD");
  for (int32_t i = range.begin; i < range.end; ++i) m.write_world(i, out);
  out.end_section();
  out.begin_section("EPST");
  for (int32_t i = range.begin; i < range.end; ++i) out.value(m.slots[i].status);
  out.end_section();
  if (env < 0 && m.starts.count > 0) {
    out.begin_section("STRT");
    out.value(m.starts.mark);
    out.value(m.starts.share);
    for (int32_t i = range.begin; i < range.end; ++i) out.value(m.slots[i].start);
    out.end_section();
  }
  out.end_file();
}

int32_t Pool::Impl::open_state(Reader& in, int32_t worlds, int32_t other, uint32_t* version) const {
  const uint32_t written = in.begin_file(kMagic, kVersion);
  if (version) *version = written;
  in.need_section("HEAD");
  char name[kTextSize];
  in.text(name, sizeof name);
  if (!same_name(name, info->name))
    fail(Code::kFormat, "state: it belongs to task %s, but the pool has task %s", name, info->name);
  if (in.value<int32_t>() != static_cast<int32_t>(slots[0].world->engine()))
    fail(Code::kFormat, "state: it belongs to another physics engine");
  if (in.value<uint64_t>() != options_hash)
    fail(Code::kFormat, "state: it belongs to a pool of task %s with other options", info->name);
  if (in.value<uint64_t>() != layout) fail(Code::kFormat, "state: it has another layout");
  const auto count = in.value<int32_t>();
  if (count != worlds && count != other)
    fail(Code::kFormat, "state: it holds %d worlds, but %d are to be set", count, worlds);
  in.expect_end();
  in.need_section("WRLD");
  return count;
}

void Pool::set_state(int32_t env, const void* bytes, size_t size) {
  const FpMode mode;
  Impl& m = *impl_;
  const Range range = range_of(env, m.config.num_envs);
  Reader in(bytes, size, "state");
  const int32_t own = range.count(), all = env < 0 ? own * m.ranks : own;
  uint32_t version = 0;
  const int32_t held = m.open_state(in, own, all, &version), before = held == own ? 0 : own * m.rank;
  Reader drawn = in, flags = in;  // checked once, which is most of what reading a state costs
  double share = m.starts.share;
  bool with_starts = false;
  if (env < 0) {
    with_starts = drawn.find_section("STRT");
    if (with_starts) {
      if (drawn.value<uint64_t>() != m.starts.mark)
        fail(Code::kFormat,
             "state: its episodes start from states of a recording that this pool does not have; set them "
             "first");
      share = drawn.value<double>();
      if (!(share >= 0 && share <= 1))
        fail(Code::kFormat, "state: a share of starts is %g, which is outside [0, 1]", share);
      if (drawn.left() != sizeof(Stream) * static_cast<size_t>(held))
        fail(Code::kFormat, "state: it does not have a stream of starts for each world");
      drawn.view(sizeof(Stream) * static_cast<size_t>(before));
    }
  }

  const bool flagged = version > 1;
  if (flagged) {
    flags.need_section("EPST");
    if (flags.left() != sizeof(uint32_t) * static_cast<size_t>(held))
      fail(Code::kFormat, "state: it does not have a status for the episode of each world");
    for (Reader all_flags = flags; all_flags.left() > 0;)
      if (all_flags.value<uint32_t>() & ~kEveryStatus)
        fail(Code::kFormat, "state: it has an unknown status bit");
    flags.view(sizeof(uint32_t) * static_cast<size_t>(before));
  }

  // a record that is bad must leave no trace
  Reader look = in;
  for (int32_t i = 0; i < before + own; ++i) {
    m.check_world(look);
    if (i < before) in = look;  // of other ranks
  }
  if (held == own) look.expect_end();
  for (int32_t i = range.begin; i < range.end; ++i) {
    m.read_world(i, in);
    ++m.slots[i].course;
    m.slots[i].status = flagged ? flags.value<uint32_t>() : 0;
    m.clear_rows(i);
    // the flags of an ended world that waits for its reset belong to its state; all else is of a step
    m.buffers.terminated[i] = m.slots[i].episode.terminated;
    m.buffers.truncated[i] = m.slots[i].episode.truncated;
    if (with_starts) m.slots[i].start = drawn.value<Stream>();
  }
  m.starts.share = share;
  m.see_again(range.begin, range.end);
}

void Pool::join_states(const StateBytes* parts, int32_t count, Writer& out) {
  const auto each = [&](const char tag[4], auto&& f) {
    bool found = true;
    for (int32_t i = 0; i < count; ++i) {
      Reader in(parts[i].bytes, parts[i].size, "state");
      in.begin_file(kMagic, kVersion);
      found = found && in.find_section(tag);
      if (found) f(i, in);
    }
  };
  int32_t worlds = 0;
  each("HEAD", [&](int32_t, Reader& in) {
    in.view(in.left() - sizeof worlds);
    worlds += in.value<int32_t>();
  });
  const auto copy = [&](Reader& in) {
    const size_t size = in.left();
    out.bytes(in.view(size), size);
  };
  out.begin_file(kMagic, kVersion);
  out.begin_section("HEAD");
  each("HEAD", [&](int32_t i, Reader& in) {
    const size_t size = in.left() - sizeof worlds;
    if (i == 0) out.bytes(in.view(size), size);
  });
  out.value(worlds);
  out.end_section();
  out.begin_section("WRLD");
  each("WRLD", [&](int32_t, Reader& in) { copy(in); });
  out.end_section();
  out.begin_section("EPST");
  each("HEAD", [&](int32_t i, Reader& in) {
    in.view(in.left() - sizeof worlds);
    const auto own = in.value<int32_t>();
    Reader flags(parts[i].bytes, parts[i].size, "state");
    if (flags.begin_file(kMagic, kVersion) > 1) {
      flags.need_section("EPST");
      return copy(flags);
    }
    for (int32_t k = 0; k < own; ++k) out.value(uint32_t{0});
  });
  out.end_section();
  bool begun = false;
  each("STRT", [&](int32_t i, Reader& in) {
    if (i == 0) out.begin_section("STRT"), begun = true;
    if (i > 0) in.view(sizeof(uint64_t) + sizeof(double));  // mark and share, as the first one's
    copy(in);
  });
  if (begun) out.end_section();
  out.end_file();
}

void Pool::Impl::copy_world(int32_t env, const Impl& from, int32_t source) {
  Slot& to = slots[env];
  const Slot& s = from.slots[source];
  if (&to == &s) return;
  to.world->copy(*s.world);
  std::memcpy(to.task_state, s.task_state, task->state_bytes());
  to.episode = s.episode;
  if (disturbance.any()) to.disturbance.copy(s.disturbance);
  to.status = s.status;
  to.taken = s.taken;
  ++to.course;
  to.goes_on = s.goes_on;
  std::copy_n(s.magnitude, cost_dim, to.magnitude);
  std::copy_n(from.obs(source), obs_dim, obs(env));
  std::copy_n(from.final_obs(source), obs_dim, final_obs(env));
  const auto cost = [&](float* mine, const float* theirs) {
    std::copy_n(theirs + source * static_cast<ptrdiff_t>(cost_dim), cost_dim, cost_row(mine, env));
  };
  cost(buffers.cost, from.buffers.cost);
  cost(buffers.cost_raw, from.buffers.cost_raw);
  cost(buffers.episode_cost, from.buffers.episode_cost);
  buffers.reward[env] = from.buffers.reward[source];
  buffers.episode_return[env] = from.buffers.episode_return[source];
  buffers.episode_step[env] = from.buffers.episode_step[source];
  buffers.status[env] = from.buffers.status[source];
  buffers.episode_status[env] = from.buffers.episode_status[source];
  buffers.terminated[env] = from.buffers.terminated[source];
  buffers.truncated[env] = from.buffers.truncated[source];
  buffers.success[env] = from.buffers.success[source];
}

void Pool::redraw(int32_t env, Stream& stream) {
  const FpMode mode;
  Impl& m = *impl_;
  Slot& s = m.slots[env];
  m.task->redraw(*s.world, stream);
  if (m.disturbance.any()) s.disturbance.name(stream.next(), static_cast<uint32_t>(env));
  ++s.course;
}

void Pool::need_same(const Pool& from, const char* name, const char* own) const {
  const Impl &m = *impl_, &f = *from.impl_;
  if (m.info != f.info)
    fail(Code::kArgument, "%s: it is a pool of task %s, but %s has task %s", name, f.info->name, own,
         m.info->name);
  if (m.slots[0].world->engine() != f.slots[0].world->engine())
    fail(Code::kArgument, "%s: it is a pool of another physics engine", name);
  if (m.options_hash != f.options_hash)
    fail(Code::kArgument, "%s: it is a pool of task %s with other options", name, m.info->name);
  if (m.layout != f.layout) fail(Code::kArgument, "%s: it is a pool with another layout", name);
}

void Pool::copy(int32_t env, const Pool& from, int32_t source) {
  const FpMode mode;
  Impl& m = *impl_;
  const Impl& f = *from.impl_;
  const Range range = range_of(env, m.config.num_envs);
  if (source < 0 || source >= f.config.num_envs)
    fail(Code::kRange, "src_env: %d is outside [0, %d)", source, f.config.num_envs);
  need_same(from, "src", "dst");
  if (range.count() < kFewCopies) {
    for (int32_t i = range.begin; i < range.end; ++i) m.copy_world(i, f, source);
    return;
  }
  m.each_world(nullptr, [&](int32_t i, Block&) { m.copy_world(i, f, source); });
}

uint64_t Pool::hash(int32_t env) const {
  const FpMode mode;
  const Impl& m = *impl_;
  const Range range = range_of(env, m.config.num_envs);
  uint64_t hash = kHashSeed;
  Writer out(&hash);
  for (int32_t i = range.begin; i < range.end; ++i) m.write_world(i, out);
  return hash;
}

}  // namespace rdm

// Episodes of a task whose functions take many worlds at once.
//
// The functions run on the thread that called the pool, for all worlds that the call is about: a function that
// has to take a lock, or that an interpreter runs, is entered once a step and not once a world. Between control
// and judge the workers step the engine. Each world's bytes are those of a task that takes one world at a time.
#include <algorithm>
#include <cstring>

#include "base/text.hpp"
#include "env/fields.hpp"
#include "env/pool_internal.hpp"

namespace rdm {

void RowWork::carve(Arena& arena, const ResolvedPoolConfig& plan) {
  const size_t n = plan.num();
  rows.worlds = arena.make<World*>(n);
  rows.states = arena.make<void*>(n);
  rows.codes = arena.make<Code>(n);
  rows.texts = arena.make<char*>(n);
  rows.streams = arena.make<Stream*>(n);
  rows.actions = arena.make<float>(n * static_cast<size_t>(plan.action_dim));
  rows.steps = arena.make<int32_t>(n);
  rows.verdicts = arena.make<Verdict>(n);
  rows.obs = arena.make<float>(n * static_cast<size_t>(plan.obs_dim));
  env = arena.make<int32_t>(n);
  waits = arena.make<uint8_t>(n);
  ended = arena.make<uint8_t>(n);
  before = arena.make<Episode>(n);
  result = arena.make<Code>(n);
}

// The worlds for which wanted(env) become the rows.
template <class F>
void Pool::Impl::pick(F&& wanted) {
  TaskRows& r = work.rows;
  r.count = 0;
  for (int32_t i = 0; i < config.num_envs; ++i) {
    if (!wanted(i)) continue;
    Slot& s = slots[i];
    s.world->borrow(*slots[0].world);  // nobody else works meanwhile
    work.env[r.count] = i;
    r.worlds[r.count] = s.world;
    r.states[r.count] = s.task_state;
    r.streams[r.count] = &s.episode.reset;
    r.steps[r.count] = s.episode.step + 1;
    r.codes[r.count] = Code::kOk;
    r.texts[r.count] = task_errors + static_cast<size_t>(i) * kErrorTextSize;
    ++r.count;
  }
}

// One of the task's functions. What comes out of it is every row's; each world keeps the text.
template <class F>
void Pool::Impl::call_rows(F&& f) {
  const TaskRows& r = work.rows;
  if (r.count == 0) return;
  try {
    f();
  } catch (const Error& e) {
    std::fill_n(r.codes, r.count, e.code);
    for (int32_t k = 0; k < r.count; ++k) keep_error(work.env[k], e.text);
    return;
  }
  for (int32_t k = 0; k < r.count; ++k) {
    if (r.codes[k] == Code::kOk) continue;
    char text[kErrorTextSize];
    copy_text(text, sizeof text, r.texts[k]);
    keep_error(work.env[k], text);
  }
}

// The rows that are well go on, in their order; failed(k) ends each other one.
template <class F>
void Pool::Impl::drop_failed(F&& failed) {
  TaskRows& r = work.rows;
  int32_t good = 0;
  for (int32_t k = 0; k < r.count; ++k) {
    if (r.codes[k] != Code::kOk) {
      failed(k);
      continue;
    }
    if (good < k) {
      work.env[good] = work.env[k];
      work.before[good] = work.before[k];
      r.worlds[good] = r.worlds[k], r.states[good] = r.states[k], r.texts[good] = r.texts[k];
      r.verdicts[good] = r.verdicts[k];
      r.codes[good] = Code::kOk;
    }
    ++good;
  }
  r.count = good;
}

// Episodes of the rows, which pick has named: rows that could not begin keep their codes.
void Pool::Impl::begin_rows() {
  const TaskRows& r = work.rows;
  for (int32_t k = 0; k < r.count; ++k) work.before[k] = open_episode(work.env[k]);
  call_rows([&] { task->reset_rows(r); });
  drop_failed([&](int32_t k) {
    const int32_t i = work.env[k];
    work.result[i] = settle_episode(i, work.before[k], r.codes[k], false);
  });
  for (int32_t k = 0; disturbance.any() && k < r.count; ++k)
    slots[work.env[k]].disturbance.begin(disturbance, *task);
  call_rows([&] { task->observe_rows(r); });
  for (int32_t k = 0; k < r.count; ++k) {
    const int32_t i = work.env[k];
    bool finite = true;
    Code code = r.codes[k];
    if (code == Code::kOk) {
      std::copy_n(r.obs + k * static_cast<ptrdiff_t>(obs_dim), obs_dim, obs(i));
      code = attempt_task(i, [&] { finite = show_first(i); });
    }
    work.result[i] = settle_episode(i, work.before[k], code, finite);
  }
}

void Pool::Impl::reset_rows(const uint64_t* seeds, const uint8_t* mask) {
  const auto named = [&](int32_t i) { return !mask || mask[i]; };
  pick(named);
  for (int32_t k = 0; seeds && k < work.rows.count; ++k) name_streams(work.env[k], seeds[work.env[k]], 0);
  begin_rows();
  each_world(mask, [&](int32_t i, Block& block) {
    clear_rows(i);
    buffers.status[i] = slots[i].status;
    if (work.result[i] == Code::kOk) return see(i, block);
    forget_episode(i);
    fail(work.result[i], "%s", task_errors + static_cast<size_t>(i) * kErrorTextSize);
  });
}

void Pool::Impl::step_rows(const uint8_t* mask) {
  const auto named = [&](int32_t i) { return !mask || mask[i]; };
  for (int32_t i = 0; i < config.num_envs; ++i)
    if (named(i)) slots[i].taken = 0;
  control_step_rows(named);
  for (int32_t k = 1; k < repeat; ++k)
    control_step_rows([&](int32_t i) { return named(i) && slots[i].goes_on; });
  if (!sense.any()) return;
  each_block([&](int32_t begin, int32_t end, Block& block) { look_round(begin, end, block, named); });
}

template <class F>
void Pool::Impl::control_step_rows(F&& wanted) {
  const TaskRows& r = work.rows;
  std::fill_n(work.ended, config.num_envs, uint8_t{0});
  for (int32_t i = 0; i < config.num_envs; ++i) work.waits[i] = wanted(i);
  // next-step mode, or a reset that failed: this step only resets
  pick([&](int32_t i) { return work.waits[i] && slots[i].episode.phase == Phase::kEnded; });
  if (r.count > 0) {
    for (int32_t k = 0; k < r.count; ++k) {
      work.ended[work.env[k]] = 1;
      work.waits[work.env[k]] = 0;
      slots[work.env[k]].goes_on = false;
    }
    begin_rows();
    for (int32_t i = 0; i < config.num_envs; ++i)
      if (work.ended[i]) show_reset(i, work.result[i]), work.ended[i] = 0;
  }
  pick([&](int32_t i) {
    if (!work.waits[i]) return false;
    float* row = r.actions + r.count * static_cast<ptrdiff_t>(action_dim);
    if (!clip_action(action(i), action_dim, row)) {
      work.waits[i] = 0;
      lose_step(i, kStatusBadAction);
      return false;
    }
    if (disturbance.delays_actions())
      slots[i].disturbance.delay_action(disturbance, slots[i].episode.step, action_dim, row);
    return true;
  });
  call_rows([&] { task->control_rows(r); });
  for (int32_t k = 0; k < r.count; ++k) {
    if (r.codes[k] == Code::kOk) continue;
    work.waits[work.env[k]] = 0;
    lose_step(work.env[k], kStatusTask);
  }
  engine_rows();
  finish_rows();
  pick([&](int32_t i) { return work.ended[i] != 0; });
  if (r.count == 0) return;
  begin_rows();
  for (int32_t i = 0; i < config.num_envs; ++i)
    if (work.ended[i]) buffers.status[i] |= slots[i].status;  // what went wrong in the reset
}

void Pool::Impl::engine_rows() {
  each_block([&](int32_t begin, int32_t end, Block& block) {
    block.waiting = 0;
    const auto step = [&] {
      World::step_together(block.group, block.waiting);
      block.waiting = 0;
    };
    for (int32_t i = begin; i < end; ++i) {
      if (!work.waits[i]) continue;
      block.group[block.waiting++] = slots[i].world;
      if (block.waiting == group_size) step();
    }
    step();
  });
}

void Pool::Impl::finish_rows() {
  const TaskRows& r = work.rows;
  pick([&](int32_t i) { return work.waits[i] && !engine_failed(i); });
  std::fill_n(r.verdicts, r.count, Verdict{});
  call_rows([&] { task->judge_rows(r); });
  const auto lose = [&](int32_t k) {
    lose_step(work.env[k], slots[work.env[k]].world->status() | kStatusTask);
  };
  drop_failed(lose);
  call_rows([&] { task->observe_rows(r); });
  for (int32_t k = 0; k < r.count; ++k) {
    if (r.codes[k] != Code::kOk) {
      lose(k);
      continue;
    }
    const int32_t i = work.env[k];
    std::copy_n(r.obs + k * static_cast<ptrdiff_t>(obs_dim), obs_dim, final_obs(i));
    judged(i, &r.verdicts[k], show(i, slots[i].episode.step + 1, final_obs(i)));
  }
}

}  // namespace rdm

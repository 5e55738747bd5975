// Episodes: reset, control steps, their ends, and the baseline actions.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/text.hpp"
#include "env/fields.hpp"
#include "env/pool_internal.hpp"

namespace rdm {
namespace {

// Up to so many entries are drawn sooner than other threads wake up.
constexpr int32_t kFewActions = 4096;

bool sound(const Verdict& v, int32_t costs) {
  bool good = std::abs(v.reward) <= kMaxVerdict;
  for (int32_t k = 0; k < costs; ++k)
    good &= std::abs(v.cost[k]) <= kMaxVerdict && std::abs(v.cost_raw[k]) <= kMaxVerdict;
  return good;
}

// What a host's learner reads must be finite: such an entry becomes 0, and the world is flagged.
void mend_row(float* row, int32_t count) {
  for (int32_t i = 0; i < count; ++i)
    if (!std::isfinite(row[i])) row[i] = 0;
}

}  // namespace

void Pool::reset(const uint64_t* seeds, const uint8_t* mask) {
  const FpMode mode;
  Impl& m = *impl_;
  if (m.task->takes_rows()) return m.reset_rows(seeds, mask);
  m.each_world(mask, [&](int32_t env, Block& block) {
    if (seeds) m.name_streams(env, seeds[env], 0);
    const Code code = m.begin_episode(env);
    m.clear_rows(env);
    m.buffers.status[env] = m.slots[env].status;
    if (code == Code::kOk) return m.see(env, block);
    m.forget_episode(env);
    fail(code, "%s", task_error(env));
  });
}

void Pool::Impl::forget_episode(int32_t env) {
  Episode& e = slots[env].episode;
  e.phase = Phase::kNew;
  e.step = 0;
  e.terminated = e.truncated = 0;
}

void Pool::step(const uint8_t* mask) {
  const FpMode mode;
  Impl& m = *impl_;
  m.check_ready(mask);
  if (m.task->takes_rows()) return m.step_rows(mask);
  m.each_block(
      [&](int32_t begin, int32_t end, Block& block) {
        const auto named = [&](int32_t env) { return !mask || mask[env]; };
        for (int32_t env = begin; env < end; ++env)
          if (named(env)) m.slots[env].taken = 0;
        m.control_step(begin, end, block, named);
        for (int32_t r = 1; r < m.repeat; ++r)
          m.control_step(begin, end, block, [&](int32_t env) { return named(env) && m.slots[env].goes_on; });
        m.look_round(begin, end, block, named);
      },
      mask != nullptr);
}

void Pool::set_joints(int32_t env, const double* q, const double* qd) {
  const FpMode mode;
  Impl& m = *impl_;
  Slot& s = m.slots[env];
  const Phase phase = s.episode.phase;
  if (phase != Phase::kRunning)
    fail(Code::kState, "set_joints: world %d %s", env,
         phase == Phase::kNew ? "was not reset yet" : "has ended its episode; reset it first");
  s.world->place_joints(q, qd);
  ++s.course;
  float *const row = m.obs(env), *const next = m.final_obs(env);
  bool good = true;
  const Code code = m.attempt_task(env, [&] { good = m.observe(env, s.episode.step, next); });
  if (code == Code::kOk) std::copy_n(next, m.obs_dim, row);
  if (!good) {
    mend_row(row, m.obs_dim);
    m.count(env, kStatusDiverged);
  }
  m.clear_rows(env);
  if (code != Code::kOk) fail(code, "%s", task_error(env));
  if (!good) m.buffers.status[env] = kStatusDiverged;
  m.see_again(env, env + 1);
}

void Pool::set_limit(int32_t env, double limit) {
  Impl& m = *impl_;
  const int32_t first = env < 0 ? 0 : env, last = env < 0 ? m.config.num_envs : env + 1;
  for (int32_t i = first; i < last; ++i) {
    const Phase phase = m.slots[i].episode.phase;
    if (phase != Phase::kRunning)
      fail(Code::kState, "limit: world %d %s", i,
           phase == Phase::kNew ? "was not reset yet" : "has ended its episode; reset it first");
  }
  // only the first one can fail: all have the same range
  for (int32_t i = first; i < last; ++i) m.task->set_limit(m.slots[i].task_state, limit, m.obs(i));
}

void Pool::baseline(Baseline kind) {
  const FpMode mode;
  Impl& m = *impl_;
  const auto fill = [&](int32_t env) {
    float* row = m.action(env);
    switch (kind) {
      case Baseline::kZero:
        std::fill_n(row, m.action_dim, 0.0f);
        break;
      case Baseline::kHold:
        m.task->hold_action(row);
        break;
      case Baseline::kRandom:
        m.slots[env].episode.policy.signed_units(row, m.action_dim);
        break;
    }
  };
  if (m.config.num_envs * m.action_dim > kFewActions)
    m.each_world(nullptr, [&](int32_t env, Block&) { fill(env); });
  else
    for (int32_t env = 0; env < m.config.num_envs; ++env) fill(env);
}

void Pool::Impl::check_ready(const uint8_t* mask) const {
  for (int32_t i = 0; i < config.num_envs; ++i) {
    if (mask && !mask[i]) continue;
    const Phase phase = slots[i].episode.phase;
    if (phase == Phase::kNew) fail(Code::kState, "step: world %d was not reset yet", i);
    if (phase == Phase::kEnded && config.autoreset == Autoreset::kOff)
      fail(Code::kState, "step: the episode of world %d is over and autoreset is off; reset it first", i);
  }
}

void Pool::Impl::keep_error(int32_t env, const char* why) {
  char text[kErrorTextSize + 32];
  std::snprintf(text, sizeof text, "world %d: %s", env, why);
  copy_text(task_errors + static_cast<size_t>(env) * kErrorTextSize, kErrorTextSize, text);
}

const char* Pool::task_error(int32_t env) const {
  const char* texts = impl_->task_errors;
  return texts ? texts + static_cast<size_t>(env) * kErrorTextSize : "";
}

// The state that a new world has: nothing of the last episode is left in the engine.
void Pool::Impl::renew(int32_t env) {
  Reader in(pristine, pristine_size, "pristine world");
  slots[env].world->take(in);
  std::memset(slots[env].task_state, 0, task->state_bytes() - task->kept_bytes());
}

Code Pool::Impl::begin_episode(int32_t env) {
  const Slot& s = slots[env];
  const Episode before = open_episode(env);
  bool good = true;
  const Code code = attempt_task(env, [&] {
    task->reset(*s.world, s.task_state, slots[env].episode.reset);
    if (disturbance.any()) slots[env].disturbance.begin(disturbance, *task);
    task->observe(*s.world, s.task_state, obs(env));
    good = show_first(env);
  });
  return settle_episode(env, before, code, good);
}

Episode Pool::Impl::open_episode(int32_t env) {
  Slot& s = slots[env];
  Episode& e = s.episode;
  const Episode before = e;
  ++s.course;
  renew(env);
  e.phase = Phase::kRunning;
  e.step = 0;
  e.terminated = e.truncated = 0;
  e.sum_reward = 0;
  for (double& sum : e.sum_cost) sum = 0;
  return before;
}

bool Pool::Impl::show_first(int32_t env) {
  bool good = show(env, 0, obs(env));
  if (starts.share > 0) good |= begin_at_start(env);
  return good;
}

Code Pool::Impl::settle_episode(int32_t env, const Episode& before, Code code, bool good) {
  Slot& s = slots[env];
  s.status = 0;
  if (code == Code::kOk) {
    if (!good) count(env, kStatusDiverged);
    return code;
  }
  count(env, kStatusTask);
  renew(env);
  const Stream drawn = s.episode.reset;  // the next attempt draws others
  s.episode = before;
  s.episode.reset = drawn;
  std::memcpy(obs(env), final_obs(env), sizeof(float) * static_cast<size_t>(obs_dim));
  return code;
}

bool Pool::Impl::observe(int32_t env, int32_t step, float* row) {
  const Slot& s = slots[env];
  task->observe(*s.world, s.task_state, row);
  return show(env, step, row);
}

bool Pool::Impl::show(int32_t env, int32_t step, float* row) {
  const bool good = clip_row(row, obs_dim, obs_limit);
  if (!good && step == 0) mend_row(row, obs_dim);
  if (!disturbance.alters_rows() || (!good && step > 0)) return good;
  slots[env].disturbance.show(disturbance, step, row);
  return clip_row(row, obs_dim, obs_limit) && good;
}

void Pool::Impl::see(int32_t env, Block& block) {
  const Slot& s = slots[env];
  if (!sense.any()) return;
  // a saved state shows the same points when it is gone on with
  const auto stream = [&](int32_t step, Purpose purpose) {
    const uint64_t moment = s.episode.reset.counter() + static_cast<uint64_t>(step);
    return Stream(s.episode.seed + 0x9e3779b97f4a7c15u * moment, s.episode.reset.world(), purpose);
  };
  sense_world(sense, *s.world, task->focus(*s.world, s.task_state), task->goal_pose(s.task_state),
              stream(s.episode.step, Purpose::kSense), stream(0, Purpose::kCamera), block.sense, sensed,
              static_cast<size_t>(env));
}

void Pool::Impl::see_again(int32_t begin, int32_t end) {
  if (!sense.any()) return;
  each_world(nullptr, [&](int32_t env, Block& block) {
    if (env >= begin && env < end && slots[env].episode.phase != Phase::kNew) see(env, block);
  });
}

void Pool::Impl::clear_rows(int32_t env) {
  const size_t row = sizeof(float) * static_cast<size_t>(cost_dim);
  std::memcpy(final_obs(env), obs(env), sizeof(float) * static_cast<size_t>(obs_dim));
  std::memset(cost_row(buffers.cost, env), 0, row);
  std::memset(cost_row(buffers.cost_raw, env), 0, row);
  std::memset(cost_row(buffers.episode_cost, env), 0, row);
  buffers.reward[env] = buffers.episode_return[env] = 0;
  buffers.episode_step[env] = 0;
  buffers.status[env] = 0;
  buffers.episode_status[env] = slots[env].status;
  buffers.terminated[env] = buffers.truncated[env] = buffers.success[env] = 0;
}

template <class F>
void Pool::Impl::control_step(int32_t begin, int32_t end, Block& block, F&& wanted) {
  block.waiting = 0;
  for (int32_t env = begin; env < end; ++env) {
    if (!wanted(env)) continue;
    block.attempt(env, [&] { start_step(env, block); });
    if (block.waiting == group_size) step_group(block);
  }
  step_group(block);
}

void Pool::Impl::start_step(int32_t env, Block& block) {
  Slot& s = slots[env];
  s.goes_on = false;
  if (s.episode.phase == Phase::kEnded) {  // next-step mode, or a reset that failed: this step only resets
    restart(env);
  } else if (clip_action(action(env), action_dim, block.action)) {
    if (disturbance.delays_actions())
      s.disturbance.delay_action(disturbance, s.episode.step, action_dim, block.action);
    const auto drive = [&] { task->control(*s.world, s.task_state, block.action); };
    if (attempt_task(env, drive) != Code::kOk) return lose_step(env, kStatusTask);
    block.group[block.waiting] = s.world;
    block.member[block.waiting++] = env;
  } else {
    lose_step(env, kStatusBadAction);
  }
}

void Pool::Impl::step_group(Block& block) {
  World::step_together(block.group, block.waiting);
  for (int32_t i = 0; i < block.waiting; ++i)
    block.attempt(block.member[i], [&] { finish_step(block.member[i]); });
  block.waiting = 0;
}

void Pool::Impl::finish_step(int32_t env) {
  if (engine_failed(env)) return;
  const Slot& s = slots[env];
  Verdict verdict;
  bool finite = false;
  const Code code = attempt_task(env, [&] {
    verdict = task->judge(*s.world, s.task_state, s.episode.step + 1);
    finite = observe(env, s.episode.step + 1, final_obs(env));
  });
  if (code != Code::kOk) return lose_step(env, s.world->status() | kStatusTask);
  judged(env, &verdict, finite);
}

bool Pool::Impl::engine_failed(int32_t env) {
  const World& world = *slots[env].world;
  const int32_t contacts = world.num_contacts();
  Counters& c = slots[env].counters;
  c.contacts_max = contacts > c.contacts_max ? contacts : c.contacts_max;
  c.contacts_sum += contacts;
  ++c.steps;
  if (!(world.status() & kStatusDiverged)) return false;
  lose_step(env, world.status());
  return true;
}

void Pool::Impl::judged(int32_t env, Verdict* verdict, bool finite) {
  const uint32_t status = slots[env].world->status();
  if (!finite || !sound(*verdict, cost_dim)) return lose_step(env, status | kStatusDiverged);
  if (disturbance.end_on_cost && costs_count(*verdict)) verdict->terminated = true;
  std::memcpy(obs(env), final_obs(env), sizeof(float) * static_cast<size_t>(obs_dim));
  close_step(env, *verdict, status, false);
}

bool Pool::Impl::costs_count(const Verdict& verdict) const {
  for (int32_t k = 0; k < cost_dim; ++k)
    if (verdict.cost[k] != 0 && (k == 0 || info->costs[k].limit >= 0)) return true;
  return false;
}

void Pool::Impl::lose_step(int32_t env, uint32_t status) {
  // the last finite one
  std::memcpy(final_obs(env), obs(env), sizeof(float) * static_cast<size_t>(obs_dim));
  close_step(env, Verdict{}, status, true);
}

void Pool::Impl::close_step(int32_t env, const Verdict& verdict, uint32_t status, bool lost) {
  Episode& e = slots[env].episode;
  ++e.step;
  ++slots[env].taken;
  count(env, status);
  e.terminated = verdict.terminated;
  e.truncated = lost || (!verdict.terminated && e.step >= task->max_steps());
  write_verdict(env, verdict, status);
  slots[env].goes_on = !e.terminated && !e.truncated;
  if (slots[env].goes_on) return;
  e.phase = Phase::kEnded;
  if (config.autoreset != Autoreset::kSameStep) return;
  if (work.ended) {  // they begin together
    work.ended[env] = 1;
    return;
  }
  begin_episode(env);
  buffers.status[env] |= slots[env].status;  // what went wrong in the reset
}

// Where the task fails in it the world goes on showing the end that it had, and the
// next step is another attempt.
void Pool::Impl::restart(int32_t env) {
  show_reset(env, begin_episode(env));
}

void Pool::Impl::show_reset(int32_t env, Code code) {
  clear_rows(env);
  buffers.status[env] = slots[env].status;
  if (code == Code::kOk) return;
  const Episode& e = slots[env].episode;
  buffers.terminated[env] = e.terminated;
  buffers.truncated[env] = e.truncated;
}

// Into the episode's status and the counters.
void Pool::Impl::count(int32_t env, uint32_t status) {
  Slot& s = slots[env];
  s.status |= status;
  Counters& c = s.counters;
  c.overflowed += (status & kStatusContactOverflow) != 0;
  c.diverged += (status & kStatusDiverged) != 0;
  c.bad_actions += (status & kStatusBadAction) != 0;
  c.task_failed += (status & kStatusTask) != 0;
  c.unconverged += (status & kStatusUnconverged) != 0;
  c.slowed += (status & kStatusSlowed) != 0;
}

void Pool::Impl::write_verdict(int32_t env, const Verdict& verdict, uint32_t status) {
  Episode& e = slots[env].episode;
  slots[env].counters.violations += costs_count(verdict);
  const bool first = slots[env].taken == 1;  // of the control steps of this step
  const auto add = [&](float& sum, double value) {
    sum = first ? static_cast<float>(value) : sum + static_cast<float>(value);
  };
  e.sum_reward += verdict.reward;
  add(buffers.reward[env], verdict.reward);
  buffers.episode_return[env] = static_cast<float>(e.sum_reward);
  for (int32_t k = 0; k < cost_dim; ++k) {
    e.sum_cost[k] += verdict.cost[k];
    add(cost_row(buffers.cost, env)[k], verdict.cost[k]);
    cost_row(buffers.cost_raw, env)[k] = static_cast<float>(verdict.cost_raw[k]);
    cost_row(buffers.episode_cost, env)[k] = static_cast<float>(e.sum_cost[k]);
    if (repeat == 1) continue;  // the row of cost_raw is all that there is
    double& magnitude = slots[env].magnitude[k];
    magnitude = (first ? 0 : magnitude) + std::max(verdict.cost_raw[k], 0.0);
  }
  buffers.episode_step[env] = e.step;
  buffers.status[env] = first ? status : buffers.status[env] | status;
  buffers.episode_status[env] = slots[env].status;
  buffers.success[env] = verdict.success || (!first && buffers.success[env]);
  buffers.terminated[env] = e.terminated;
  buffers.truncated[env] = e.truncated;
}

}  // namespace rdm

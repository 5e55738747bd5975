// Episodes: reset, control steps, their ends, and the baseline actions.
#include <bit>
#include <cmath>
#include <cstring>

#include "env/pool_impl.hpp"

namespace rdm {
namespace {

bool all_finite(const float* row, int32_t count) {
  // on the bits, so that the loop has no branch and no order: an exponent of ones is infinite or not a number
  constexpr uint32_t kExponent = 0x7F800000u;
  uint32_t bad = 0;
  for (int32_t i = 0; i < count; ++i)
    bad |= static_cast<uint32_t>((std::bit_cast<uint32_t>(row[i]) & kExponent) == kExponent);
  return bad == 0;
}

bool all_finite(const Verdict& v, int32_t costs) {
  bool good = std::isfinite(v.reward);
  for (int32_t k = 0; k < costs; ++k) good = good && std::isfinite(v.cost[k]) && std::isfinite(v.cost_raw[k]);
  return good;
}

}  // namespace

void Pool::reset(const uint64_t* seeds, const uint8_t* mask) {
  const FpMode mode;
  Impl& m = *impl_;
  m.each_world(mask, [&](int32_t env, Block&) {
    if (seeds) m.name_streams(env, seeds[env]);
    m.begin_episode(env);
    m.clear_rows(env);
  });
}

void Pool::step(const uint8_t* mask) {
  const FpMode mode;
  Impl& m = *impl_;
  m.check_ready(mask);
  m.each_world(mask, [&](int32_t env, Block& block) { m.step_world(env, block); });
}

void Pool::baseline(Baseline kind) {
  const FpMode mode;
  Impl& m = *impl_;
  m.each_world(nullptr, [&](int32_t env, Block&) {
    float* row = m.action(env);
    if (kind == Baseline::kHold) m.task->hold_action(row);
    for (int32_t i = 0; i < m.action_dim; ++i) {
      if (kind == Baseline::kZero) row[i] = 0;
      if (kind == Baseline::kRandom) row[i] = static_cast<float>(m.slots[env].episode.policy.signed_unit());
    }
  });
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

void Pool::Impl::begin_episode(int32_t env) {
  Slot& s = slots[env];
  // from the state that a new world has: nothing of the last episode is left in the engine
  Reader in(pristine, pristine_size, "pristine world");
  s.world->load(in);
  std::memset(s.task_state, 0, task->state_bytes());
  Episode& e = s.episode;
  e.phase = Phase::kRunning;
  e.step = 0;
  e.terminated = e.truncated = 0;
  e.sum_reward = 0;
  for (double& sum : e.sum_cost) sum = 0;
  task->reset(*s.world, s.task_state, e.reset);
  task->observe(*s.world, s.task_state, obs(env));
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
  buffers.terminated[env] = buffers.truncated[env] = buffers.success[env] = 0;
}

void Pool::Impl::take_step(int32_t env, const float* action_row, Verdict* verdict, uint32_t* status) {
  Slot& s = slots[env];
  task->control(*s.world, s.task_state, action_row);
  s.world->step();
  *status |= s.world->status();
  Counters& c = s.counters;
  const int32_t contacts = s.world->num_contacts();
  c.contacts_max = contacts > c.contacts_max ? contacts : c.contacts_max;
  c.contacts_sum += contacts;
  ++c.steps;
  c.overflowed += (*status & kStatusContactOverflow) != 0;
  if (*status & kStatusDiverged) return;
  *verdict = task->judge(*s.world, s.task_state, s.episode.step + 1);
  task->observe(*s.world, s.task_state, final_obs(env));
  if (!all_finite(final_obs(env), obs_dim) || !all_finite(*verdict, cost_dim)) *status |= kStatusDiverged;
}

void Pool::Impl::step_world(int32_t env, Block& block) {
  Episode& e = slots[env].episode;
  if (e.phase == Phase::kEnded) {  // next-step mode: this step only resets
    begin_episode(env);
    clear_rows(env);
    return;
  }
  uint32_t status = 0;
  Verdict verdict;
  const float* given = action(env);
  if (all_finite(given, action_dim)) {
    for (int32_t i = 0; i < action_dim; ++i)
      block.action[i] = given[i] < -1 ? -1.0f : given[i] > 1 ? 1.0f : given[i];
    take_step(env, block.action, &verdict, &status);
  } else {
    status = kStatusBadAction;
  }
  const bool lost = (status & (kStatusDiverged | kStatusBadAction)) != 0;
  const size_t row = sizeof(float) * static_cast<size_t>(obs_dim);
  if (lost) {
    slots[env].counters.diverged += (status & kStatusDiverged) != 0;
    verdict = Verdict{};
    std::memcpy(final_obs(env), obs(env), row);  // the last finite one
  } else {
    std::memcpy(obs(env), final_obs(env), row);
  }
  ++e.step;
  e.terminated = verdict.terminated;
  e.truncated = lost || (!verdict.terminated && e.step >= task->max_steps());
  write_verdict(env, verdict, status);
  if (!e.terminated && !e.truncated) return;
  e.phase = Phase::kEnded;
  if (config.autoreset == Autoreset::kSameStep) begin_episode(env);
}

void Pool::Impl::write_verdict(int32_t env, const Verdict& verdict, uint32_t status) {
  Episode& e = slots[env].episode;
  e.sum_reward += verdict.reward;
  buffers.reward[env] = static_cast<float>(verdict.reward);
  buffers.episode_return[env] = static_cast<float>(e.sum_reward);
  for (int32_t k = 0; k < cost_dim; ++k) {
    e.sum_cost[k] += verdict.cost[k];
    cost_row(buffers.cost, env)[k] = static_cast<float>(verdict.cost[k]);
    cost_row(buffers.cost_raw, env)[k] = static_cast<float>(verdict.cost_raw[k]);
    cost_row(buffers.episode_cost, env)[k] = static_cast<float>(e.sum_cost[k]);
  }
  buffers.episode_step[env] = e.step;
  buffers.status[env] = status;
  buffers.success[env] = verdict.success;
  buffers.terminated[env] = e.terminated;
  buffers.truncated[env] = e.truncated;
}

}  // namespace rdm

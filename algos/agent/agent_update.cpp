// An update, whole or in slices: what begin, slices and cancels promise, and the order of everything in between.
//
//   begin     values of the last observations; the actor is kept
//   estimate  advantages and targets, a column at a time; the list of rows
//   judge     episodes' costs against their limits, the algorithm's begin_epoch
//   step      the algorithm's own step of the policy, where it has one (a trust region)
//   passes    shuffled minibatches: what the algorithm measures, the gradient, Adam's step; the KL that may end
//             them; then an algorithm's second passes, of the policy alone. Of a student (option latent_from=history)
//             these are the passes of its encoder, and nothing else is learned
//   end       schedules, the Epoch, an empty rollout
//
// Between two jobs, and between two units of a job, it can be left: what it needs to go on stands in members.
// Nothing here looks at a clock, so any cut into slices gives the same bytes.
#include <cstring>

#include "algos/agent/agent.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/rollout/sequences.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "base/hash.hpp"
#include "base/shuffle.hpp"

namespace rdm {
namespace {

constexpr double kEntropyOfUnit = 1.4189385332046727;  // of a normal with deviation 1

}  // namespace

void Agent::need_no_update(const char* call) const {
  if (updating())
    fail(Code::kState,
         "%s: an update is under way; finish it with rdm_agent_update_slice, or drop it with "
         "rdm_agent_discard",
         call);
}

void Agent::update(const float* last_obs, Epoch* out) {
  begin_update(last_obs);
  update_on(kWhole, out);
}

void Agent::begin_update(const float* last_obs) {
  const FpMode mode;
  need_no_update("update");
  hear_cancel();
  if (missing() > 0) fail(Code::kState, "update: this horizon lacks %d decisions", missing());
  if (!last_obs) fail(Code::kArgument, "last_obs is NULL");
  check_rows("last_obs", last_obs, nullptr, resolved_.config.num_envs, resolved_.obs_dim());
  try {
    collector_.settle();
    collector_.begin_estimate(last_obs);
    take_horizon(last_obs);
  } catch (...) {
    drop_horizon();
    throw;
  }
  keep_actor(nets_);
  nets_.updating = true;
  phase_ = Phase::kEstimate;
}

bool Agent::update_on(int32_t units, Epoch* out) {
  const FpMode mode;
  if (!updating()) fail(Code::kState, "update_slice: there is no update under way");
  const bool whole = units == kWhole;
  try {
    for (; updating() && (whole || units > 0); units -= !whole) unit(whole);
  } catch (...) {
    drop_horizon();
    throw;
  }
  if (updating()) return false;
  if (out) *out = run_.epoch;
  return true;
}

// Short work until there is a job, of which it does one unit. What takes its time otherwise is one too.
void Agent::unit(bool whole) {
  check_cancel();
  const bool adapts = resolved_.adapts();  // nothing of the algorithm's own
  const PolicyLoss* policy = adapts ? &still_ : run_.warm ? nullptr : policy_loss();
  while (!job_) switch (phase_) {
      case Phase::kEstimate:
        if (collector_.estimate_on()) phase_ = Phase::kJudge;
        return;
      case Phase::kJudge:
        return judge_epoch();
      case Phase::kStep:
        job_ = step_on();
        if (!job_) phase_ = Phase::kPass;
        break;
      case Phase::kPass:
        if (run_.second ? run_.turn_passes < second_passes()
                        : run_.turn >= 0 && run_.turn_passes < resolved_.shared.passes)
          return begin_pass();
        run_.turn_passes = 0;
        if (!run_.second && ++run_.turn < (run_.warm ? 1 : turns())) {
          if (!run_.warm && !adapts) job_ = begin_turn(run_.turn);
        } else if (policy && !adapts && !run_.second && second_passes() > 0) {
          run_.second = true;
          job_ = begin_second();
        } else {
          nets_.focus = -1;
          phase_ = Phase::kSpread;
        }
        break;
      case Phase::kMinibatch:
        if (!next_minibatch()) {
          end_pass(policy);
        } else {
          if (policy && !adapts) job_ = measure_minibatch(run_.batch);
          phase_ = Phase::kGradient;
        }
        break;
      case Phase::kGradient:
        if (policy && !adapts) {
          begin_minibatch(learner_.measured());
          imitation_.draw(run_.batch.rows);
        }
        job_ = learner_.begin_gradient(policy, run_.turn == 0 && !run_.second && !adapts, run_.batch);
        phase_ = Phase::kAdam;
        break;
      case Phase::kAdam:
        run_.last += learner_.sums();
        learner_.step(schedule_.rate(epoch_), schedule_.change(epoch_));
        phase_ = Phase::kMinibatch;
        return;
      case Phase::kStop: {
        const bool far = learner_.measured().kl > resolved_.shared.early_stop_kl;
        if (far) run_.turn_passes = std::max(resolved_.shared.passes, second_passes());
        phase_ = Phase::kPass;
        break;
      }
      case Phase::kSpread:
        if (!spread_on()) return;
        phase_ = Phase::kEnd;
        break;
      case Phase::kEnd:
        return end_update();
      case Phase::kIdle:
        return;
    }
  if (job_.advance(whole)) job_ = Job();
}

void Agent::judge_epoch() {
  run_ = Run();
  run_.stats = collector_.episodes().stats();
  run_.totals = collector_.totals();
  run_.warm = epoch_ < resolved_.shared.warm_epochs && !resolved_.adapts();
  run_.skipped = this->skipped();
  learned_ = Learned();
  imitation_.begin_epoch(std::max(0, epoch_ - resolved_.shared.warm_epochs));
  warn_of_limits(run_.stats);
  phase_ = valid_rows() > 0 ? Phase::kPass : Phase::kSpread;
  if (run_.warm || resolved_.adapts()) return;
  begin_epoch(judge(resolved_, run_.stats, run_.totals), epoch_ + 1);
  imitation_.draw(valid_rows());
  if (valid_rows() == 0) return;
  job_ = imitation_.remember();
  begin_step();
  phase_ = Phase::kStep;
}

void Agent::begin_pass() {
  const Batch& whole = whole_batch();
  const int32_t envs = workers_.ranks().block_envs();
  for (int32_t b = 0; b < whole.blocks; ++b) {
    const Segment rows = whole.segment(b);
    if (rollout().path)
      list_sequences(rollout(), b * envs, envs, rows.first, &shuffle_[b]);
    else
      shuffle(shuffle_[b], rollout().order + rows.first, rows.rows);
  }
  run_.minibatch = 0;
  run_.last = BatchSums();
  phase_ = Phase::kMinibatch;
}

// The next one of the pass that has rows.
bool Agent::next_minibatch() {
  const int32_t parts = std::min(resolved_.shared.minibatches, valid_rows());
  while (run_.minibatch < parts) {
    run_.batch = collector_.minibatch(run_.minibatch++, parts);
    if (run_.batch.rows > 0) return true;
  }
  return false;
}

void Agent::end_pass(const PolicyLoss* policy) {
  ++run_.turn_passes;
  phase_ = Phase::kPass;
  if (run_.second) return;
  run_.all += run_.last;
  run_.clips = policy && policy->clips();
  ++learned_.passes;
  if (!policy || resolved_.shared.early_stop_kl <= 0) return;
  job_ = learner_.begin_measure(whole_batch());
  phase_ = Phase::kStop;
}

void Agent::end_update() {
  const bool warm = run_.warm;
  if (learned_.passes > 0) {
    const double count = valid_rows();
    learned_.last_kl = run_.last.kl / count;
    learned_.mean = run_.all.scaled(1 / (count * learned_.passes));
    const double rounds = warm ? 1 : turns();
    learned_.mean.reward_loss *= rounds, learned_.mean.cost_loss *= rounds;
    // what this update did not learn has no loss
    if (!run_.clips) learned_.mean.clipped = kNothing;
    if (warm) learned_.mean.loss = kNothing;
    if (resolved_.adapts()) learned_.mean.reward_loss = learned_.mean.cost_loss = kNothing;
  }
  const bool own = !warm && !resolved_.adapts();  // the algorithm's step
  if (own && valid_rows() > 0) report(learned_);
  const int64_t skipped = this->skipped() - run_.skipped;
  if (skipped > 0)
    log(resolved_.config.hooks, LogLevel::kWarning, "update: %lld gradients were not finite and left out",
        static_cast<long long>(skipped));
  const double rate = warm ? 0 : schedule_.rate(epoch_);
  if (learned_.passes > 0 && !warm) schedule_.adapt(learned_.mean.kl, epoch_);
  collector_.episodes().mark();
  collector_.close_usual();
  ++epoch_;
  if (own) schedule_std(nets_, resolved_.shared, epoch_);
  if (!warm) average_actor(nets_);
  end_run();  // whatever fails from here on, it is the next policy
  Epoch& e = run_.epoch;
  fill_episodes(run_.stats, run_.totals, e);
  fill_counts(run_.totals, skipped, e);
  fill_learned(rate, e);
  workers_.ranks().agree(learned_hash());
  collector_.drop();
}

void Agent::end_run() {
  phase_ = Phase::kIdle;
  job_ = Job();
  nets_.updating = false;
  nets_.focus = -1;
}

// Of an update that has begun: the actor is what it was, so a policy file of this generation is this one's.
void Agent::drop_horizon() {
  if (updating()) restore_actor(nets_);
  end_run();
  collector_.drop();
}

// A cancel drops what was collected, full or not.
void Agent::hear_cancel() {
  try {
    check_cancel();
  } catch (...) {
    drop_horizon();
    throw;
  }
}

void Agent::warn_of_limits(const EpisodeStats& stats) {
  if (warned_ || !lacks_length(resolved_, stats)) return;
  warned_ = true;
  log(resolved_.config.hooks, LogLevel::kWarning,
      "update: no episode has ended and none has a length, so limits on an episode's cost cannot be judged, "
      "only broken by those that run; give max_steps, or option episode_steps or cost_limit_per_step");
}

void Agent::begin_epoch(const JudgedCosts&, int32_t) {
  follow_reward();
}

void Agent::follow_reward() {
  const Rollout& r = rollout();
  const size_t n = r.valued_rows();
  std::memcpy(r.gain, r.advantage, n * sizeof(float));
  std::memset(r.linear, 0, n * sizeof(float));
}

double Agent::violation(const JudgedCosts& costs, int32_t i) const {
  const double gap = costs.known[i] ? costs.excess(i) : 0;
  switch (kViolationRows.read(resolved_.options).scale) {
    case ViolationScale::kStep:
      return gap / std::max(1.0, costs.steps[i] / action_repeat());
    case ViolationScale::kDiscount:
      return gap * (1 - elementary::pow(discount(), action_repeat()));
    case ViolationScale::kRaw:
      break;
  }
  return gap;
}

// Of the deviations that acted, some rows at a time; true when all are in.
bool Agent::spread_on() {
  const Batch& whole = whole_batch();
  if (!nets_.state_std() || run_.block == whole.blocks) return true;
  const Segment s = whole.segment(run_.block);
  const int32_t end = std::min(run_.row + resolved_.chunk_rows, s.rows);
  double* const out = spread_ + 2 * static_cast<size_t>(run_.block);
  if (run_.row == 0) out[0] = out[1] = 0;
  for (int32_t i = run_.row; i < end; ++i)
    add_spread(rollout().log_std_of(static_cast<size_t>(rollout().order[s.first + i])), 0, valid_rows(), out);
  run_.row = end < s.rows ? end : 0;
  run_.block += end == s.rows;
  return false;
}

void Agent::add_spread(const float* log_std, double share, double count, double* out) const {
  const int32_t dim = resolved_.config.action_dim;
  for (int32_t j = 0; j < dim; ++j) {
    const auto l = static_cast<double>(log_std[j]);
    out[0] += elementary::exp(l) / (count * dim);
    out[1] += (l + share + kEntropyOfUnit) / count;
  }
}

void Agent::fill_spread(Epoch& e) {
  const auto share = static_cast<double>(resolved_.log_share);
  double now[2] = {};
  if (!nets_.state_std()) {
    add_spread(nets_.log_std(), share, 1, now);
  } else {
    const auto sums = workers_.ranks().sum<2>(
        [&](int32_t b, double* out) { std::copy_n(spread_ + 2 * static_cast<size_t>(b), 2, out); });
    now[0] = sums[0] * elementary::exp(-share), now[1] = sums[1];
  }
  e.action_std = now[0];
  e.entropy = now[1];
}

// Of what all ranks must have alike.
uint64_t Agent::learned_hash() const {
  if (workers_.ranks().alone()) return 0;
  uint64_t hash = hash_bytes(nets_.params, nets_.size * sizeof(float));
  const Normalizer& n = collector_.normalizer();
  for (const double* x : {n.mean, n.m2}) hash = hash_bytes(x, static_cast<size_t>(n.dim) * sizeof *x, hash);
  return hash;
}

void Agent::fill_episodes(const EpisodeStats& stats, const EpochTotals& totals, Epoch& e) const {
  e.episodes = stats.finished;
  e.ret = stats.ret;
  std::fill(std::begin(e.cost), std::end(e.cost), kNothing);
  std::copy_n(stats.cost, resolved_.config.cost_dim, e.cost);
  const bool by_rate = resolved_.rate_steps > 0 || stats.finished == 0;
  e.cost_per_step = by_rate ? totals.rate(0) : stats.cost_per_step;
  e.length = stats.length;
  e.fall_rate = stats.fall_rate;
  e.success_rate = stats.success_rate;
  if (stats.finished == 0) e.flags |= kEpochNoEpisode;
}

void Agent::fill_counts(const EpochTotals& totals, int64_t skipped, Epoch& e) const {
  const auto count = [&](int64_t& to, int64_t n, EpochFlag flag) {
    to = n;
    if (n > 0) e.flags |= flag;
  };
  e.violations = e.refused = e.unproven = e.copied = e.inevitable = -1;  // who rolls out knows
  count(e.skipped_gradients, skipped, kEpochSkippedGradients);
  count(e.invalid_rows, totals.invalid, kEpochInvalidRows);
  if (totals.cut > 0) e.flags |= kEpochCut;
  count(e.contacts_left_out, totals.status[0], kEpochContacts);
  count(e.diverged, totals.status[1], kEpochDiverged);
  count(e.bad_actions, totals.status[2], kEpochBadAction);
  count(e.task_failed, totals.status[3], kEpochTask);
  count(e.unconverged, totals.status[4], kEpochSolver);
  count(e.slowed, totals.status[5], kEpochSlowed);
}

void Agent::fill_learned(double rate, Epoch& e) {
  e.epoch = epoch_;
  e.env_steps = collector_.env_steps();
  for (int32_t i = 0; i < resolved_.num_limited; ++i) e.multiplier[resolved_.column[i]] = cost_weight(i);
  fill_spread(e);
  e.learning_rate = rate;
  e.passes = learned_.passes;
  e.cost_signal = raw_costs();
  for (double* x : {&e.kl, &e.loss_policy, &e.loss_reward_value, &e.loss_cost_value, &e.clip_fraction,
                    &e.value_reward, &e.value_cost})
    *x = kNothing;
  if (valid_rows() == 0) return;
  e.kl = learned_.last_kl;
  e.loss_policy = learned_.mean.loss;
  e.loss_reward_value = learned_.mean.reward_loss;
  e.value_reward = mean_value(false);
  e.clip_fraction = learned_.mean.clipped;
  if (!resolved_.values_costs && (!resolved_.off_policy() || num_limited() == 0)) return;
  e.loss_cost_value = learned_.mean.cost_loss;
  e.value_cost = mean_value(true);
}

}  // namespace rdm

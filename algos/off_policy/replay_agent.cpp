#include "algos/off_policy/replay_agent.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace rdm {
namespace {

constexpr int64_t kMostDecisions = int64_t{1}
                                   << 50;  // of a state that loads: times updates_per_step it is a number
constexpr double kMostNorm = 1e9;  // of a gradient where none is set: squares of its entries are floats still
constexpr uint32_t kDrawStream = 1 << 20;  // of minibatches, behind those of blocks

}  // namespace

ReplayAgent::ReplayAgent(ResolvedAgentConfig&& resolved)
    : Agent(std::move(resolved)), options_(kReplayRows.read(this->resolved().options)) {
  const ResolvedAgentConfig& r = this->resolved();
  if (options_.replay_rows < r.config.num_envs)
    fail(Code::kRange, "replay_rows: %d is less than a row for each of %d environments", options_.replay_rows,
         r.config.num_envs);
  const int64_t places =
      int64_t{Replay::rows_of_world(options_.replay_rows, r.config.num_envs)} * r.config.num_envs;
  if (places > (1 << 30)) fail(Code::kRange, "replay_rows: %d is too many", options_.replay_rows);
}

void ReplayAgent::carve(Arena& arena) {
  Agent::carve(arena);
  const ResolvedAgentConfig& r = resolved();
  replay_.carve(arena, r, options_.replay_rows);
  scratch_ = carve_mlp_scratch(arena, r.actor, kPartRows);
  draws_ = arena.make<Stream>(1);
  noise_ = arena.make<Stream>(1);
  drawn_ = arena.make<int32_t>(count_of(options_.batch_rows));
  obs_ = arena.make<float>(kRows * r.obs_dim());
  seen_ = arena.make<float>(kRows * count_of(r.actor.in));
  action_ = arena.make<float>(kRows * r.action_dim());
  head_ = arena.make<float>(kRows * count_of(r.actor.out));
  dhead_ = arena.make<float>(kRows * count_of(r.actor.out));
  grad_ = arena.make<float>(nets().block[Networks::kActor].size);
  part_ = arena.make<float>(nets().block[Networks::kActor].size);
}

void ReplayAgent::opened() {
  const uint64_t seed = config().seed;
  replay_.open(resolved());
  *draws_ = Stream(seed, kDrawStream, Purpose::kMinibatch);
  *noise_ = Stream(seed, kDrawStream + 1, Purpose::kMinibatch);
}

void ReplayAgent::read_live() {
  Agent::read_live();
  options_ = kReplayRows.read(options());
}

// World after world, so that what stands behind a row is what it led to.
void ReplayAgent::take_horizon(const float* last_obs) {
  feed_.forget_lengths();
  const Rollout& r = rollout();
  const size_t costs = count_of(r.num_costs);
  before_ = decisions_;
  for (int32_t env = 0; env < r.num_envs; ++env) {
    for (int32_t t = 0; t < r.horizon; ++t) {
      const size_t at = r.row(t) + count_of(env);
      const float* const obs = r.obs + at * r.obs_dim;
      if (!r.valid[at]) {
        replay_.end(env, obs);
        continue;
      }
      replay_.push(env,
                   {obs, r.action + at * r.action_dim, r.reward[at], r.cost + at * costs, r.discount[at]});
      ++decisions_;
      if (r.over[at] && r.discount[at] > 0) replay_.end(env, r.final_obs + at * r.obs_dim);
    }
    replay_.follow(env, last_obs + count_of(env) * r.obs_dim);
  }
  rows_changed();
}

void ReplayAgent::begin_step() {
  sums_ = Sums();
  row_at_ = 0;
  stage_ = Stage::kDraw;
  const auto steps_for = [&](int64_t decisions) {
    return static_cast<int64_t>(options_.updates_per_step * static_cast<double>(decisions));
  };
  const bool ready = !explores_blindly() && replay_.rows() > 0;
  left_ = ready ? steps_for(decisions_) - steps_for(before_) : 0;
}

Job ReplayAgent::step_on() {
  return stage_ == Stage::kOver ? Job() : Job::of<&ReplayAgent::advance>(this);
}

// One unit: the draw of a batch, one of the algorithm's, or a part of what is measured at the end.
bool ReplayAgent::advance(bool whole) {
  switch (stage_) {
    case Stage::kDraw:
      if (left_ <= 0) {
        stage_ = Stage::kMeasure;
        break;
      }
      replay_.draw(*draws_, options_.batch_rows, drawn_);
      begin_rows();
      stage_ = Stage::kStep;
      break;
    case Stage::kStep:
      if (!step_on_rows(whole)) break;
      ++sums_.steps;
      --left_;
      stage_ = Stage::kDraw;
      break;
    case Stage::kMeasure:
      measure_part();
      break;
    case Stage::kOver:
      break;
  }
  return stage_ == Stage::kOver;
}

double ReplayAgent::critics_rate() const {
  const SharedOptions& o = resolved().shared;
  return o.critic_learning_rate == 0 ? o.learning_rate : o.critic_learning_rate;
}

double ReplayAgent::most_norm() const {
  const double norm = resolved().shared.max_grad_norm;
  return norm > 0 ? norm : kMostNorm;
}

void ReplayAgent::load(const int32_t* list, bool next, int32_t rows, float* out) const {
  const size_t dim = resolved().obs_dim();
  for (int32_t i = 0; i < rows; ++i)
    std::copy_n(next ? replay_.next_obs(list[i]) : replay_.obs(list[i]), dim, out + count_of(i) * dim);
  if (normalizes()) normalizer_apply(normalizer(), out, rows, out);
}

void ReplayAgent::see(const float* obs, int32_t rows, float* seen) const {
  const Vector<int32_t>& columns = resolved().actor_columns;
  const auto dim = static_cast<int32_t>(resolved().obs_dim());
  if (!columns.empty())
    pick_columns(obs, rows, dim, columns.data(), actor_shape().in, seen);
  else
    std::copy_n(obs, count_of(rows) * count_of(dim), seen);
}

float* ReplayAgent::actor_gradient(bool begins) {
  float* const grad = begins ? grad_ : part_;
  std::fill_n(grad, nets().std_size, 0.0f);
  return grad + nets().std_size;
}

void ReplayAgent::add_actor_gradient(bool begins) {
  const size_t size = begins ? 0 : nets().block[Networks::kActor].size;
  for (size_t j = 0; j < size; ++j) grad_[j] += part_[j];
}

void ReplayAgent::step_actor() {
  Block& b = nets().block[Networks::kActor];
  const double norm =
      adam_step(b.adam, nets().params + b.offset, grad_, resolved().shared.learning_rate, most_norm());
  skipped_ += !std::isfinite(norm);
  ++sums_.actor_steps;
}

// KL(old || new) of this horizon's decisions, before the squash; some rows at a time.
void ReplayAgent::measure_part() {
  const Batch& whole = whole_batch();
  const int32_t rows = std::min(kPartRows, whole.rows - row_at_);
  const size_t width = resolved().obs_dim(), dim = resolved().action_dim(), out = count_of(actor_shape().out);
  if (sums_.steps == 0 || rows <= 0) {
    stage_ = Stage::kOver;
    return;
  }
  const int32_t* const order = whole.order + row_at_;
  for (int32_t i = 0; i < rows; ++i)
    std::copy_n(rollout().obs + count_of(order[i]) * width, width, obs_ + count_of(i) * width);
  if (normalizes()) normalizer_apply(normalizer(), obs_, rows, obs_);
  see(obs_, rows, seen_);
  mlp_forward(actor_shape(), nets().net(Networks::kActor), seen_, rows, scratch_, head_);
  for (int32_t i = 0; i < rows; ++i) {
    const auto at = count_of(order[i]);
    const float* const now = head_ + count_of(i) * out;
    float log_std[kMaxActions];
    for (size_t j = 0; j < dim; ++j)
      log_std[j] = nets().state_std()
                       ? std::clamp(now[dim + j], nets().std_low, nets().std_high) + nets().log_share
                       : rollout().log_std[j];
    sums_.kl += static_cast<double>(kernels().kl(rollout().mean + at * dim, rollout().log_std_of(at), now,
                                                 log_std, static_cast<int32_t>(dim)));
  }
  row_at_ += rows;
}

void ReplayAgent::report(Learned& learned) const {
  const auto steps = static_cast<double>(sums_.steps);
  learned.passes = static_cast<int32_t>(std::min<int64_t>(sums_.steps, INT32_MAX));
  learned.last_kl = sums_.steps ? sums_.kl / valid_rows() : kNothing;
  learned.mean.kl = learned.last_kl;
  learned.mean.clipped = kNothing;
  learned.mean.loss =
      sums_.actor_steps ? sums_.policy_loss / static_cast<double>(sums_.actor_steps) : kNothing;
  learned.mean.reward_loss = sums_.steps ? sums_.reward_loss / steps : kNothing;
  learned.mean.cost_loss = sums_.steps ? sums_.cost_loss / steps : kNothing;
}

double ReplayAgent::mean_value(bool of_cost) const {
  if (sums_.steps == 0) return kNothing;
  return (of_cost ? sums_.cost_value : sums_.value) / static_cast<double>(sums_.steps);
}

void ReplayAgent::visit_state(StateIo& io) {
  Agent::visit_state(io);
  io.section("OFFP");
  io.integer(decisions_, 0, kMostDecisions);
  io.integer(fed_, 0, kMostDecisions);
  io.counter(steps_);
  io.counter(skipped_);
  io.stream(*draws_);
  io.stream(*noise_);
  visit_networks(io);
  replay_.visit(io);
}

void ReplayAgent::after_load() {
  replay_.after_load();
  stage_ = Stage::kOver;
  rows_changed();
}

}  // namespace rdm

#include "algos/off_policy/off_policy.hpp"

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

OffPolicy::OffPolicy(ResolvedAgentConfig&& resolved)
    : Agent(std::move(resolved)), options_(kOffPolicyRows.read(this->resolved().options)) {
  const ResolvedAgentConfig& r = this->resolved();
  if (options_.replay_rows < r.config.num_envs)
    fail(Code::kRange, "replay_rows: %d is less than a row for each of %d environments", options_.replay_rows,
         r.config.num_envs);
  const int64_t places =
      int64_t{Replay::rows_of_world(options_.replay_rows, r.config.num_envs)} * r.config.num_envs;
  if (places > (1 << 30)) fail(Code::kRange, "replay_rows: %d is too many", options_.replay_rows);
}

void OffPolicy::carve(Arena& arena) {
  Agent::carve(arena);
  const ResolvedAgentConfig& r = resolved();
  replay_.carve(arena, r, options_.replay_rows);
  critics_.carve(arena, r, options_.layer_norm);
  scratch_ = carve_mlp_scratch(arena, r.actor, kPartRows);
  draws_ = arena.make<Stream>(1);
  noise_ = arena.make<Stream>(1);
  drawn_ = arena.make<int32_t>(count_of(options_.batch_rows));
  const size_t inputs = count_of(r.reward_critic.in) + r.action_dim();
  obs_ = arena.make<float>(kRows * r.obs_dim());
  seen_ = arena.make<float>(kRows * count_of(r.actor.in));
  row_ = arena.make<float>(kRows * inputs);
  next_ = arena.make<float>(kRows * inputs);
  action_ = arena.make<float>(kRows * r.action_dim());
  slope_ = arena.make<float>(kRows * r.action_dim());
  bonus_ = arena.make<float>(kRows);
  head_ = arena.make<float>(kRows * count_of(r.actor.out));
  dhead_ = arena.make<float>(kRows * count_of(r.actor.out));
  grad_ = arena.make<float>(nets().block[Networks::kActor].size);
  part_ = arena.make<float>(nets().block[Networks::kActor].size);
}

void OffPolicy::opened() {
  const uint64_t seed = config().seed;
  replay_.open(resolved());
  critics_.open(resolved(), workers());
  *draws_ = Stream(seed, kDrawStream, Purpose::kMinibatch);
  *noise_ = Stream(seed, kDrawStream + 1, Purpose::kMinibatch);
}

void OffPolicy::read_live() {
  Agent::read_live();
  options_ = kOffPolicyRows.read(options());
}

// World after world, so that what stands behind a row is what it led to.
void OffPolicy::take_horizon(const float* last_obs) {
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
}

void OffPolicy::begin_step() {
  sums_ = Sums();
  row_at_ = 0;
  stage_ = Stage::kDraw;
  const auto steps_for = [&](int64_t decisions) {
    return static_cast<int64_t>(options_.updates_per_step * static_cast<double>(decisions));
  };
  const bool ready = !explores_blindly() && replay_.rows() > 0;
  left_ = ready ? steps_for(decisions_) - steps_for(before_) : 0;
}

Job OffPolicy::step_on() {
  return stage_ == Stage::kOver ? Job() : Job::of<&OffPolicy::advance>(this);
}

int32_t OffPolicy::group_end(bool whole) {
  return whole ? critics_.count() : std::min(net_ + workers().count(), critics_.count());
}

// One unit: a part of a batch through the actor or through some critics, or a step of these.
bool OffPolicy::advance(bool whole) {
  const int32_t rows = part_rows(), to = group_end(whole);
  const float share = 1 / static_cast<float>(options_.batch_rows);
  const auto last_group = [&] {
    const bool last = to == critics_.count();
    net_ = last ? 0 : to;
    return last;
  };
  switch (stage_) {
    case Stage::kDraw:
      if (left_ <= 0) {
        stage_ = Stage::kMeasure;
        break;
      }
      draw();
      break;
    case Stage::kNext:
      gather_next(rows);
      stage_ = Stage::kTargets;
      break;
    case Stage::kTargets:
      critics_.values(net_, to, true, next_, rows);
      if (!last_group()) break;
      make_targets(rows);
      stage_ = Stage::kGradients;
      break;
    case Stage::kGradients:
      critics_.gradients(net_, to, row_, rows, share, first_ == 0);
      if (!last_group()) break;
      see(rows, seen_);
      add_to_critics(seen_, row_, rows);
      first_ += rows;
      stage_ = first_ < options_.batch_rows ? Stage::kNext : Stage::kCritics;
      break;
    case Stage::kCritics: {
      const SharedOptions& o = resolved().shared;
      const double rate = o.critic_learning_rate == 0 ? o.learning_rate : o.critic_learning_rate;
      const double norm = o.max_grad_norm > 0 ? o.max_grad_norm : kMostNorm;
      critics_.step(net_, to, rate, norm, options_.tau);
      if (!last_group()) break;
      end_critics_step(rate, norm);
      ++steps_;
      first_ = 0;
      stage_ = Stage::kOwn;
      if (steps_ % options_.policy_delay) end_gradient_step();
      break;
    }
    case Stage::kOwn:
      gather_own(rows);
      stage_ = Stage::kValues;
      break;
    case Stage::kValues:
      critics_.values(net_, to, false, row_, rows);
      if (!last_group()) break;
      weigh(rows);
      stage_ = Stage::kSlopes;
      break;
    case Stage::kSlopes:
      critics_.slopes(net_, to, row_, rows);
      if (!last_group()) break;
      learn_part(rows);
      first_ += rows;
      stage_ = first_ < options_.batch_rows ? Stage::kOwn : Stage::kActor;
      break;
    case Stage::kActor:
      step_actor();
      end_gradient_step();
      break;
    case Stage::kMeasure:
      measure_part();
      break;
    case Stage::kOver:
      break;
  }
  return stage_ == Stage::kOver;
}

void OffPolicy::draw() {
  replay_.draw(*draws_, options_.batch_rows, drawn_);
  first_ = 0, net_ = 0;
  stage_ = Stage::kNext;
}

void OffPolicy::load(bool next, int32_t rows) {
  const size_t dim = resolved().obs_dim();
  for (int32_t i = 0; i < rows; ++i) {
    const int32_t at = drawn_[first_ + i];
    std::copy_n(next ? replay_.next_obs(at) : replay_.obs(at), dim, obs_ + count_of(i) * dim);
  }
  if (normalizes()) normalizer_apply(normalizer(), obs_, rows, obs_);
}

void OffPolicy::see(int32_t rows, float* seen) const {
  const Vector<int32_t>& columns = resolved().actor_columns;
  const auto dim = static_cast<int32_t>(resolved().obs_dim());
  if (!columns.empty())
    pick_columns(obs_, rows, dim, columns.data(), actor_shape().in, seen);
  else
    std::copy_n(obs_, count_of(rows) * count_of(dim), seen);
}

void OffPolicy::gather_next(int32_t rows) {
  const size_t dim = resolved().action_dim();
  load(true, rows);
  see(rows, seen_);
  next_actions(seen_, rows, action_, bonus_);
  critics_.gather(obs_, action_, rows, next_);
  load(false, rows);
  for (int32_t i = 0; i < rows; ++i)
    std::copy_n(replay_.action(drawn_[first_ + i]), dim, action_ + count_of(i) * dim);
  critics_.gather(obs_, action_, rows, row_);
}

void OffPolicy::make_targets(int32_t rows) {
  for (int32_t i = 0; i < rows; ++i) {
    const int32_t at = drawn_[first_ + i];
    const float d = replay_.discount(at);
    const float value = std::min(critics_.out(0)[i], critics_.out(1)[i]) + bonus_[i];
    critics_.y(0)[i] = replay_.reward(at) + d * (counts(i) ? value : std::min(value, 0.0f));
    for (int32_t pair = 1; pair < critics_.pairs(); ++pair) {
      const float next = std::max({critics_.out(2 * pair)[i], critics_.out(2 * pair + 1)[i], 0.0f});
      critics_.y(pair)[i] = replay_.cost(at)[pair - 1] + d * next;
    }
  }
}

void OffPolicy::gather_own(int32_t rows) {
  load(false, rows);
  see(rows, seen_);
  own_actions(seen_, rows, action_);
  critics_.gather(obs_, action_, rows, row_);
}

// What a change of each critic's value is worth in the actor's loss.
void OffPolicy::weigh(int32_t rows) {
  double sum = 0;
  for (int32_t k = 1; k < critics_.pairs(); ++k) sum += cost_weight(k - 1);
  const double whole = mix() == Mix::kSum ? 1 + sum : 1, reward = mix() == Mix::kDifference ? 1 - sum : 1;
  const double share = critics_share(rows) / (whole * options_.batch_rows);
  for (int32_t pair = 0; pair < critics_.pairs(); ++pair) {
    const auto value = static_cast<float>(pair == 0 ? -reward * share : cost_weight(pair - 1) * share);
    const float *one = critics_.out(2 * pair), *other = critics_.out(2 * pair + 1);
    for (int32_t i = 0; i < rows; ++i) {
      const bool first = pair > 0 ? one[i] >= other[i] : !climbs_smaller() || one[i] <= other[i];
      const auto weight = static_cast<float>(weight_at(pair, i, value));
      critics_.weight(2 * pair)[i] = first ? weight : 0;
      critics_.weight(2 * pair + 1)[i] = first ? 0 : weight;
      sums_.policy_loss += static_cast<double>(weight) * static_cast<double>(first ? one[i] : other[i]);
    }
  }
}

void OffPolicy::learn_part(int32_t rows) {
  const size_t count = count_of(rows) * resolved().action_dim();
  std::copy_n(critics_.slopes(0), count, slope_);
  for (int32_t net = 1; net < critics_.count(); ++net)
    for (size_t j = 0; j < count; ++j) slope_[j] += critics_.slopes(net)[j];
  double sum = 0;
  for (int32_t k = 1; k < critics_.pairs(); ++k) sum += cost_weight(k - 1);
  const double whole = mix() == Mix::kSum ? 1 + sum : 1;
  const auto share = static_cast<float>(1 / (whole * options_.batch_rows));
  const size_t size = nets().block[Networks::kActor].size;
  float* const grad = first_ == 0 ? grad_ : part_;
  std::fill_n(grad, nets().std_size, 0.0f);
  sums_.policy_loss += learn_actions(seen_, rows, slope_, share, grad + nets().std_size);
  for (size_t j = 0; first_ > 0 && j < size; ++j) grad_[j] += part_[j];
}

void OffPolicy::step_actor() {
  Block& b = nets().block[Networks::kActor];
  const SharedOptions& o = resolved().shared;
  const double most = o.max_grad_norm > 0 ? o.max_grad_norm : kMostNorm;
  const double norm = adam_step(b.adam, nets().params + b.offset, grad_, o.learning_rate, most);
  skipped_ += !std::isfinite(norm);
  ++sums_.actor_steps;
  end_actor_step();
}

void OffPolicy::end_gradient_step() {
  ++sums_.steps;
  const double rows = options_.batch_rows;
  for (int32_t net = 0; net < critics_.count(); ++net) {
    const bool reward = net < 2;
    const double networks = reward ? 2 : critics_.count() - 2;
    (reward ? sums_.reward_loss : sums_.cost_loss) += critics_.loss(net) / (rows * networks);
    if (net < 4) (reward ? sums_.value : sums_.cost_value) += critics_.sum(net) / (2 * rows);
  }
  --left_;
  stage_ = Stage::kDraw;
}

// KL(old || new) of this horizon's decisions, before the squash; some rows at a time.
void OffPolicy::measure_part() {
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
  see(rows, seen_);
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

void OffPolicy::report(Learned& learned) const {
  const auto steps = static_cast<double>(sums_.steps);
  learned.passes = static_cast<int32_t>(std::min<int64_t>(sums_.steps, INT32_MAX));
  learned.last_kl = sums_.steps ? sums_.kl / valid_rows() : 0;
  learned.mean.kl = learned.last_kl;
  learned.mean.loss =
      sums_.actor_steps ? sums_.policy_loss / static_cast<double>(sums_.actor_steps) : kNothing;
  learned.mean.reward_loss = sums_.steps ? sums_.reward_loss / steps : kNothing;
  learned.mean.cost_loss = critics_.pairs() == 1 ? 0 : sums_.steps ? sums_.cost_loss / steps : kNothing;
}

double OffPolicy::mean_value(bool of_cost) const {
  if (sums_.steps == 0) return kNothing;
  return (of_cost ? sums_.cost_value : sums_.value) / static_cast<double>(sums_.steps);
}

void OffPolicy::visit_state(StateIo& io) {
  Agent::visit_state(io);
  io.section("OFFP");
  io.integer(decisions_, 0, kMostDecisions);
  io.integer(fed_, 0, kMostDecisions);
  io.counter(steps_);
  io.counter(skipped_);
  io.stream(*draws_);
  io.stream(*noise_);
  critics_.visit(io);
  replay_.visit(io);
}

void OffPolicy::after_load() {
  replay_.after_load();
  stage_ = Stage::kOver;
}

}  // namespace rdm

#include "algos/agent/learner.hpp"

#include <cmath>
#include <cstring>

#include "algos/imitation/imitation.hpp"
#include "algos/rollout/sequences.hpp"
#include "base/elementary.hpp"
#include "nn/dot.hpp"

namespace rdm {

void Learner::carve(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params) {
  grad_ = arena.make<float>(num_params);
  log_std_ = arena.make<float>(resolved.state_std() ? 0 : resolved.action_dim());
  block_sums_ = arena.make<BatchSums>(static_cast<size_t>(resolved.blocks));
  block_surrogate_ = arena.make<Surrogate>(static_cast<size_t>(resolved.blocks));
}

void Learner::open(const ResolvedAgentConfig& resolved, const Rollout& rollout, Networks& nets,
                   BatchWorkers& workers) {
  resolved_ = &resolved;
  rollout_ = &rollout;
  nets_ = &nets;
  workers_ = &workers;
}

void Learner::refresh_log_std() {
  for (size_t j = 0; !nets_->state_std() && j < resolved_->action_dim(); ++j)
    log_std_[j] = nets_->log_std()[j] + resolved_->log_share;
}

void StillLoss::add(const PolicyChunk& chunk) const {
  for (size_t i = 0; i < static_cast<size_t>(chunk.rows); ++i)
    chunk.sums->kl += sample_kl(*chunk.rollout, static_cast<size_t>(chunk.order[i]), chunk.first_part,
                                chunk.last_part, chunk.mean_of(i), chunk.log_std_of(i));
}

PolicyChunk Learner::chunk_of(Workspace& workspace, const int32_t* order, int32_t rows, float* grad) const {
  PolicyChunk p{rollout_, order,          rows, workspace.out,  log_std_,
                scale_,   workspace.dout, grad, &workspace.sums};
  p.mean_step = static_cast<size_t>(nets_->shape[Networks::kActor].out);
  p.first_part = static_cast<size_t>(nets_->first_group()),
  p.last_part = static_cast<size_t>(nets_->last_group());
  if (nets_->state_std()) {
    const size_t dim = rollout_->action_dim;
    p.log_std = workspace.out + dim, p.dlog_std = workspace.dout + dim, p.std_step = p.mean_step;
  }
  return p;
}

// Of all blocks of this rank.
BatchSums Learner::sums_of_blocks() {
  const int32_t blocks = workers_->ranks().blocks();
  Ranks::tree(blocks, [&](int32_t a, int32_t b) { block_sums_[a] += block_sums_[b]; });
  return block_sums_[0];
}

Job Learner::begin_gradient(const PolicyLoss* policy, bool critics, const Batch& batch) {
  refresh_log_std();
  policy_ = policy;
  critics_ = critics;
  first_net_ = net_ = policy ? Networks::kActor : Networks::kReward;
  last_net_ = critics ? nets_->count : int32_t{Networks::kReward};
  begin_ = nets_->block[first_net_].offset;
  end_ = critics ? nets_->size : nets_->block[Networks::kReward].offset;
  scale_ = 1 / static_cast<float>(batch.rows);
  sweep_ = Sweep(batch);
  with_term_ = policy && policy->explores();
  term_ = Job();
  return Job::of<&Learner::advance_gradient>(this);
}

bool Learner::advance_gradient(bool whole) {
  if (term_) {
    if (!term_.advance(whole)) return false;
    sums_.loss += sweep_.batch.rows * imitation_->term();
    return true;
  }
  if (net_ == first_net_) workers_->cut(sweep_, resolved_->chunk_rows);
  const int32_t first = net_;
  net_ = whole ? last_net_ : net_ + 1;
  workers_->each(sweep_, [&](Workspace& w, const Chunk& chunk) { chunk_gradient(w, chunk, first, net_); });
  if (net_ < last_net_) return false;
  net_ = first_net_;
  for (int32_t i = 0; i < sweep_.chunks; ++i) {
    const Workspace& w = (*workers_)[i];
    if (w.chunk.begins) block_sums_[w.chunk.block] = BatchSums();
    block_sums_[w.chunk.block] += w.sums;
  }
  workers_->reduce(sweep_, grad_, begin_, end_);
  if (!sweep_.over()) return false;
  end_gradient();
  if (with_term_ && imitation_ && imitation_->active()) term_ = imitation_->begin(grad_);
  return !term_;
}

// Rows are gathered for each part of a chunk: between two, what acts may have used the workspace.
void Learner::chunk_gradient(Workspace& workspace, const Chunk& chunk, int32_t first, int32_t last) const {
  float* grad = BatchWorkers::gradient_of(workspace, grad_);
  const int32_t n = chunk.rows;
  if (first == first_net_) workspace.sums = BatchSums();
  if (n == 0) return std::fill(grad + begin_, grad + end_, 0.0f);
  bool gathered = false;
  for (int32_t net = first; net < last; ++net) {
    if (net == Networks::kActor) {
      policy_gradient(workspace, *policy_, chunk.order, n, grad);
      gathered = nets_->gru.units == 0;
      continue;
    }
    if (!gathered) gather_obs(*rollout_, chunk.order, 1, n, workspace.obs);
    gathered = true;
    if (net == Networks::kReward)
      workspace.sums.reward_loss = critic_gradient(workspace, Networks::kReward, chunk.order, n, grad);
    else
      workspace.sums.cost_loss = critic_gradient(workspace, Networks::kCost, chunk.order, n, grad);
  }
}

void Learner::end_gradient() {
  sums_ = sums_of_blocks();
  double few[] = {sums_.loss, sums_.kl, sums_.clipped, sums_.reward_loss, sums_.cost_loss};
  workers_->ranks().sum(grad_ + begin_, end_ - begin_, few, std::size(few));
  sums_ = {few[0], few[1], few[2], few[3], few[4]};
  add_penalties();
}

MemorySteps Learner::forward_policy(Workspace& workspace, const int32_t* order, int32_t rows) const {
  MemorySteps memory;
  if (nets_->gru.units) {
    memory = gather_sequences(*rollout_, order, rows, workspace);
    nets_->forward_memory(workspace.obs, memory, workspace.actor, workspace.sequences.out);
    take_outputs(workspace.sequences, rows, static_cast<size_t>(nets_->shape[Networks::kActor].out),
                 workspace.out);
  } else {
    gather_obs(*rollout_, order, 1, rows, workspace.obs);
    nets_->forward_actor(workspace.obs, rollout_->clouds(order), rows, workspace.actor, workspace.out);
  }
  return memory;
}

void Learner::backward_policy(Workspace& workspace, const MemorySteps& memory, const int32_t* order,
                              int32_t rows, float* grad) const {
  if (!nets_->gru.units)
    return nets_->backward_actor(workspace.obs, rollout_->clouds(order), rows, workspace.actor,
                                 workspace.dout, grad);
  give_gradients(workspace.sequences, rows, static_cast<size_t>(nets_->shape[Networks::kActor].out),
                 workspace.dout);
  nets_->backward_memory(workspace.obs, memory, workspace.actor, workspace.sequences.dout, grad);
}

void Learner::policy_gradient(Workspace& workspace, const PolicyLoss& policy, const int32_t* order,
                              int32_t rows, float* grad) const {
  expect_actions(*rollout_, order, rows);
  const MemorySteps memory = forward_policy(workspace, order, rows);
  std::memset(grad, 0, nets_->std_size * sizeof(float));
  const PolicyChunk chunk = chunk_of(workspace, order, rows, grad);
  const size_t dim = rollout_->action_dim;
  const bool state = nets_->state_std();
  for (size_t i = 0; state && i < static_cast<size_t>(rows); ++i)
    std::fill_n(chunk.dlog_std_of(i), dim,
                policy.explores() ? -scale_ * static_cast<float>(shared().entropy) : 0.0f);
  policy.add(chunk);
  if (nets_->adapts()) {
    workspace.sums.loss += nets_->regress_latent(workspace.obs, rows, scale_, workspace.actor, grad);
    return;
  }
  if (state) nets_->gate_std(workspace.out, rows, workspace.dout);
  backward_policy(workspace, memory, order, rows, grad);
}

// Squared error against the targets, or with value_clip the larger one of it and of that of a value held near
// the one that acted; returns its sum over rows and columns.
double Learner::critic_gradient(Workspace& workspace, Networks::Index net, const int32_t* order, int32_t rows,
                                float* grad) const {
  const auto out = static_cast<size_t>(nets_->shape[net].out);
  const bool reward = net == Networks::kReward;
  const float* target = reward ? rollout_->target : rollout_->cost_target;
  const float* acted = reward ? rollout_->value : rollout_->cost_value;
  nets_->forward(net, workspace.obs, rows, workspace.critic, workspace.out);
  const auto clip = static_cast<float>(shared().value_clip);
  double loss = 0;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    for (size_t k = 0; k < out; ++k) {
      const size_t at = static_cast<size_t>(order[i]) * out + k;
      float error = workspace.out[i * out + k] - target[at], slope = 1;
      if (clip > 0) {
        const float change = workspace.out[i * out + k] - acted[at];
        const float held = acted[at] + std::clamp(change, -clip, clip) - target[at];
        if (held * held > error * error) error = held, slope = std::abs(change) <= clip ? 1.0f : 0.0f;
      }
      workspace.dout[i * out + k] = 2 * scale_ * error * slope;
      loss += static_cast<double>(error) * static_cast<double>(error);
    }
  nets_->backward(net, workspace.obs, rows, workspace.critic, workspace.dout, grad);
  return loss / nets_->num_critics;
}

void Learner::add_penalties() {
  const auto bonus = policy_ && policy_->explores() ? static_cast<float>(shared().entropy) : 0.0f;
  const auto first_action = static_cast<size_t>(nets_->first_action()),
             last_action = static_cast<size_t>(nets_->last_action());
  for (size_t j = 0; policy_ && !nets_->state_std() && j < resolved_->action_dim(); ++j)
    grad_[j] = shared().learn_std && !shared().linear_std && j >= first_action && j < last_action
                   ? grad_[j] - bonus
                   : 0;
  if (!critics_ || shared().critic_l2 == 0) return;
  const auto twice = static_cast<float>(2 * shared().critic_l2);
  const size_t first = nets_->block[Networks::kReward].offset;
  workers_->ranges(begin_, end_, [&](size_t low, size_t high) {
    for (size_t j = std::max(low, first); j < high; ++j) grad_[j] += twice * nets_->params[j];
  });
}

// The factor that bounds the norm over all networks that take part.
double Learner::joint_scale(int32_t first, int32_t last) const {
  double squares = 0;
  for (int32_t net = first; net < last; ++net)
    squares +=
        dot(grad_ + nets_->block[net].offset, grad_ + nets_->block[net].offset, nets_->block[net].size);
  const double bound = shared().max_grad_norm;
  return bound > 0 ? std::min(1.0, bound / (std::sqrt(squares) + 1e-6)) : 1;
}

void Learner::step(double actor_rate, double actor_share) {
  const int32_t first = first_net_, last = last_net_;
  const SharedOptions& o = shared();
  const double own_rate = o.critic_learning_rate == 0 ? o.learning_rate : o.critic_learning_rate;
  const double critic_rate = o.critics_follow ? own_rate * actor_share : own_rate;
  double bound = o.max_grad_norm;
  if (o.joint_grad_norm) {
    const double scale = joint_scale(first, last);
    for (size_t j = begin_; std::isfinite(scale) && scale < 1 && j < end_; ++j)
      grad_[j] = static_cast<float>(scale * static_cast<double>(grad_[j]));
    bound = 0;
  }
  const auto in_groups = [&](int32_t net) {
    return net == Networks::kActor ? nets_->num_groups > 0 : nets_->critic[net] != nullptr;
  };
  AdamStep steps[3];
  workers_->spread(last - first, [&](int32_t i) {
    const int32_t net = first + i;
    Block& b = nets_->block[net];
    if (in_groups(net)) return;
    const double rate = net == Networks::kActor ? actor_rate : critic_rate;
    steps[net] = adam_begin(b.adam, nets_->params + b.offset, grad_ + b.offset, rate, bound);
  });
  workers_->ranges(begin_, end_, [&](size_t low, size_t high) {
    for (int32_t net = first; net < last; ++net) {
      const Block& b = nets_->block[net];
      adam_range(steps[net], std::max(low, b.offset) - b.offset, std::max(high, b.offset) - b.offset);
    }
  });
  for (int32_t net = first; net < last; ++net)
    if (in_groups(net)) step_groups(net, net == Networks::kActor ? actor_rate : critic_rate, bound);
  for (int32_t net = first; net < last; ++net) skipped_ += !std::isfinite(steps[net].norm);
  if (policy_) clamp_log_std(*nets_);
}

// A step of each group that learns, its norm, its count of steps and its bound its own: of an actor the entries of the
// log deviations, then the network; of critics the network.
void Learner::step_groups(int32_t net, double rate, double bound) {
  const bool acts = net == Networks::kActor;
  const int32_t first = acts ? nets_->first_group() : 0,
                last = acts ? nets_->last_group() : nets_->num_critics;
  const ActorGroup* groups = acts ? nets_->group : nets_->critic[net];
  int64_t* taken = acts ? nets_->group_steps : nets_->critic_steps[net];
  const Block& block = nets_->block[net];
  double norms[kMaxGroups];
  workers_->spread(last - first, [&](int32_t i) {
    const int32_t number = first + i;
    const ActorGroup& g = groups[number];
    const size_t at = nets_->net_offset(net) - block.offset + g.offset, std = static_cast<size_t>(g.first);
    const size_t size = g.net().num_params(),
                 stds = !acts || nets_->state_std() ? 0 : static_cast<size_t>(g.count);
    const auto part = [&](size_t from, size_t count) {
      return Adam{count, block.adam.m + from, block.adam.v + from, taken[number]};
    };
    float *const params = nets_->params + block.offset, *const grad = grad_ + block.offset;
    Adam of_net = part(at, size), of_std = part(std, stds);
    const double norm = std::sqrt(sum_squares(grad + std, stds) + sum_squares(grad + at, size));
    norms[i] = norm;
    adam_range(adam_begin(of_net, params + at, grad + at, norm, rate, bound), 0, size);
    adam_range(adam_begin(of_std, params + std, grad + std, norm, rate, bound), 0, stds);
    taken[number] = of_net.t;
  });
  for (int32_t i = 0; first + i < last; ++i) skipped_ += !std::isfinite(norms[i]);
}

void Learner::measure_rows(Workspace& workspace, const int32_t* order, int32_t rows) const {
  const Rollout& r = *rollout_;
  const auto costs = static_cast<size_t>(r.num_costs);
  expect_actions(r, order, rows);
  forward_policy(workspace, order, rows);
  workspace.surrogate = Surrogate();
  const PolicyChunk chunk = chunk_of(workspace, order, rows, nullptr);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) {
    const auto at = static_cast<size_t>(order[i]);
    const float *mean = chunk.mean_of(i), *log_std = chunk.log_std_of(i);
    workspace.surrogate.kl += sample_kl(r, at, chunk.first_part, chunk.last_part, mean, log_std);
    for (size_t v = 0; v < r.critics; ++v) {  // of critics of groups the mean, each with its group's ratio
      const double ratio = r.critics > 1
                               ? part_ratio(r, at, v, mean, log_std)
                               : sample_ratio(r, at, chunk.first_part, chunk.last_part, mean, log_std);
      const size_t row = at * r.critics + v;
      const auto share = static_cast<double>(r.critics);
      workspace.surrogate.gain += ratio * static_cast<double>(r.gain[row] + r.linear[row]) / share;
      const double bounded =
          std::clamp(ratio, 1.0 - static_cast<double>(clip_), 1.0 + static_cast<double>(clip_));
      for (size_t k = 0; k < costs; ++k) {
        const auto cost = static_cast<double>(r.cost_advantage[row * costs + k]);
        workspace.surrogate.cost[k] +=
            (clip_ > 0 ? std::max(ratio * cost, bounded * cost) : ratio * cost) / share;
      }
    }
  }
}

Job Learner::begin_measure(const Batch& batch, float clip, bool term) {
  refresh_log_std();
  clip_ = clip;
  sweep_ = Sweep(batch);
  with_term_ = term;
  term_ = Job();
  return Job::of<&Learner::advance_measure>(this);
}

bool Learner::advance_measure(bool whole) {
  if (term_) {
    if (!term_.advance(whole)) return false;
    measured_.gain -= imitation_->term();
    return true;
  }
  workers_->cut(sweep_, resolved_->chunk_rows);
  workers_->each(sweep_, [&](Workspace& w, const Chunk& chunk) { measure_rows(w, chunk.order, chunk.rows); });
  for (int32_t i = 0; i < sweep_.chunks; ++i) {
    const Workspace& w = (*workers_)[i];
    Surrogate& sum = block_surrogate_[w.chunk.block];
    if (w.chunk.begins) sum = Surrogate();
    sum += w.surrogate;
  }
  if (!sweep_.over()) return false;
  end_measure();
  if (with_term_ && imitation_ && imitation_->active()) term_ = imitation_->begin(nullptr);
  return !term_;
}

Job Learner::begin_weigh(const Batch& batch, int32_t group, double most) {
  refresh_log_std();
  sweep_ = Sweep(batch);
  weighed_ = static_cast<size_t>(group);
  most_weight_ = most;
  return Job::of<&Learner::advance_weigh>(this);
}

bool Learner::advance_weigh(bool) {
  const Rollout& r = *rollout_;
  const auto costs = static_cast<size_t>(r.num_costs);
  workers_->cut(sweep_, resolved_->chunk_rows);
  workers_->each(sweep_, [&](Workspace& w, const Chunk& c) {
    forward_policy(w, c.order, c.rows);
    const PolicyChunk chunk = chunk_of(w, c.order, c.rows, nullptr);
    for (size_t i = 0; i < static_cast<size_t>(c.rows); ++i) {
      const auto at = static_cast<size_t>(c.order[i]);
      const auto ratio =
          static_cast<float>(std::clamp(part_ratio(r, at, weighed_, chunk.mean_of(i), chunk.log_std_of(i)),
                                        1 / most_weight_, most_weight_));
      r.gain[at] *= ratio, r.linear[at] *= ratio;
      for (size_t k = 0; k < costs; ++k) r.cost_advantage[at * costs + k] *= ratio;
    }
  });
  return sweep_.over();
}

Job Learner::begin_outputs(const Batch& batch, float* out) {
  sweep_ = Sweep(batch);
  outputs_ = out;
  return Job::of<&Learner::advance_outputs>(this);
}

bool Learner::advance_outputs(bool) {
  const auto width = static_cast<size_t>(nets_->shape[Networks::kActor].out);
  workers_->cut(sweep_, resolved_->chunk_rows);
  workers_->each(sweep_, [&](Workspace& w, const Chunk& c) {
    forward_policy(w, c.order, c.rows);
    for (size_t i = 0; i < static_cast<size_t>(c.rows); ++i)
      std::copy_n(w.out + i * width, width, outputs_ + static_cast<size_t>(c.order[i]) * width);
  });
  return sweep_.over();
}

void Learner::end_measure() {
  const int32_t rows = sweep_.batch.rows;
  const auto sums = workers_->ranks().sum<2 + kMaxCosts>([&](int32_t b, double* out) {
    const Surrogate& s = block_surrogate_[b];
    *out++ = s.gain, *out++ = s.kl;
    std::copy_n(s.cost, kMaxCosts, out);
  });
  measured_.gain = sums[0] / rows, measured_.kl = sums[1] / rows;
  for (size_t k = 0; k < kMaxCosts; ++k) measured_.cost[k] = sums[2 + k] / rows;
}

void Learner::visit(StateIo& io) {
  io.section("LEAR");
  io.counter(skipped_);
}

}  // namespace rdm

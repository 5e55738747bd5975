#include "algos/off_policy/q_critic.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace rdm {
namespace {

constexpr uint32_t kFirstStream = 16;  // of initial weights, behind those of other networks

MlpShape shape_of(const ResolvedAgentConfig& resolved, bool layer_norm) {
  MlpShape s = resolved.reward_critic;
  s.in += resolved.config.action_dim;
  s.out = 1;
  s.layer_norm = layer_norm;
  return s;
}

}  // namespace

void QCritics::carve(Arena& arena, const ResolvedAgentConfig& resolved, bool layer_norm) {
  shape_ = shape_of(resolved, layer_norm);
  pairs_ = num_pairs(resolved);
  action_dim_ = resolved.config.action_dim;
  step_ = (shape_.num_params() + 15) / 16 * 16;
  const size_t n = count_of(count()), rows = kPartRows;
  for (float** all : {&params_, &slow_, &grad_, &part_}) *all = arena.make<float>(n * step_);
  adam_ = arena.make<Adam>(n);
  for (size_t i = 0; i < n; ++i) {
    const Adam adam = carve_adam(arena, shape_.num_params());
    if (adam_) adam_[i] = adam;
  }
  out_ = arena.make<float>(n * rows);
  dout_ = arena.make<float>(n * rows);
  weight_ = arena.make<float>(n * rows);
  y_ = arena.make<float>(count_of(pairs_) * rows);
  slopes_ = arena.make<float>(n * rows * count_of(action_dim_));
  loss_ = arena.make<double>(n);
  sum_ = arena.make<double>(n);
  norm_ = arena.make<double>(n);
  scratch_ = arena.make<MlpScratch>(n);
  for (size_t i = 0; i < n; ++i) {
    const MlpScratch scratch = carve_mlp_scratch(arena, shape_, kPartRows);
    if (scratch_) scratch_[i] = scratch;
  }
}

void QCritics::open(const ResolvedAgentConfig& resolved, BatchWorkers& workers) {
  resolved_ = &resolved;
  workers_ = &workers;
  columns_ = resolved.critic_columns.empty() ? nullptr : resolved.critic_columns.data();
  for (int32_t i = 0; i < count(); ++i) {
    Stream stream(resolved.config.seed, kFirstStream + static_cast<uint32_t>(i), Purpose::kInit);
    mlp_init(shape_, stream, 1, params(i));
  }
  restart_targets();
}

void QCritics::restart_targets() {
  std::copy_n(params_, count_of(count()) * step_, slow_);
}

void QCritics::gather(const float* obs, const float* action, int32_t rows, float* x) const {
  const size_t width = resolved_->obs_dim(), own = count_of(row_inputs()), dim = count_of(action_dim_);
  for (size_t i = 0; i < count_of(rows); ++i, obs += width, action += dim) {
    if (columns_)
      pick_columns(obs, 1, static_cast<int32_t>(width), columns_, row_inputs(), x);
    else
      std::copy_n(obs, own, x);
    std::copy_n(action, dim, x + own);
    x += own + dim;
  }
}

// body(network, scratch), on any threads.
template <class Body>
void QCritics::spread(int32_t first, int32_t last, Body&& body) {
  workers_->spread(last - first, [&](int32_t i) { body(first + i, scratch_[first + i]); });
}

void QCritics::values(int32_t first, int32_t last, bool slow, const float* x, int32_t rows) {
  spread(first, last, [&](int32_t net, const MlpScratch& s) {
    mlp_forward(shape_, slow ? this->slow(net) : params(net), x, rows, s, out(net));
  });
}

// Behind mlp_forward of the same rows.
void QCritics::add_gradient(int32_t net, const MlpScratch& s, const float* x, int32_t rows, const float* dq,
                            bool begins) {
  float *const total = grad_ + count_of(net) * step_, *const part = part_ + count_of(net) * step_;
  mlp_backward(shape_, params(net), x, rows, s, dq, begins ? total : part);
  const size_t size = begins ? 0 : adam_[net].size;
  for (size_t i = 0; i < size; ++i) total[i] += part[i];
}

void QCritics::gradients(int32_t first, int32_t last, const float* x, int32_t rows, float scale,
                         bool begins) {
  spread(first, last, [&](int32_t net, const MlpScratch& s) {
    float *const q = out(net), *const dq = dout_ + count_of(net) * kPartRows;
    const float* const target = y(net / 2);
    mlp_forward(shape_, params(net), x, rows, s, q);
    double loss = 0, sum = 0;
    for (size_t i = 0; i < count_of(rows); ++i) {
      sum += static_cast<double>(q[i]);
      const float error = q[i] - target[i];
      dq[i] = 2 * scale * error;
      loss += static_cast<double>(error) * static_cast<double>(error);
    }
    loss_[net] = begins ? loss : loss_[net] + loss;
    sum_[net] = begins ? sum : sum_[net] + sum;
    add_gradient(net, s, x, rows, dq, begins);
  });
}

void QCritics::lift(int32_t first, int32_t last, const float* x, int32_t rows) {
  spread(first, last, [&](int32_t net, const MlpScratch& s) {
    mlp_forward(shape_, params(net), x, rows, s, out(net));
    add_gradient(net, s, x, rows, weight(net), false);
  });
}

void QCritics::slopes(int32_t first, int32_t last, const float* x, int32_t rows) {
  spread(first, last, [&](int32_t net, const MlpScratch& s) {
    float* const slope = slopes_ + count_of(net) * kPartRows * count_of(action_dim_);
    const float* const w = weight(net);
    if (std::all_of(w, w + rows, [](float v) { return v == 0; }))
      std::fill_n(slope, count_of(rows) * count_of(action_dim_), 0.0f);
    else
      mlp_backward(shape_, params(net), x, rows, s, w, nullptr, row_inputs(), slope);
  });
}

void QCritics::step(int32_t first, int32_t last, double rate, double max_norm, double tau) {
  const auto share = static_cast<float>(tau);
  spread(first, last, [&](int32_t net, const MlpScratch&) {
    float* const p = params(net);
    norm_[net] = adam_step(adam_[net], p, grad_ + count_of(net) * step_, rate, max_norm);
    float* const target = slow(net);
    const size_t size = adam_[net].size;
    for (size_t i = 0; i < size; ++i) target[i] += share * (p[i] - target[i]);
  });
  for (int32_t net = first; net < last; ++net) skipped_ += !std::isfinite(norm_[net]);
}

int32_t QCritics::num_tensors(const ResolvedAgentConfig& resolved) {
  return 2 * num_pairs(resolved) * 2 * resolved.reward_critic.num_layers();
}

bool QCritics::tensor(int32_t index, char* name, TensorInfo* out) const {
  if (index < 0 || index >= num_tensors()) return false;
  const int32_t of_net = 2 * shape_.num_layers(), net = index / of_net, l = index % of_net / 2;
  const bool weight = index % 2 == 0;
  char pair[24] = "reward";
  if (net > 1) std::snprintf(pair, sizeof pair, "cost%d", resolved_->column[net / 2 - 1]);
  std::snprintf(name, kTensorNameSize, "%s_q%d.%d.%s", pair, net % 2 + 1, l, weight ? "weight" : "bias");
  *out = {name, shape_.layer_out(l), weight ? shape_.layer_in(l) : 1,
          params(net) + (weight ? shape_.weight_offset(l) : shape_.bias_offset(l))};
  return true;
}

void QCritics::visit(StateIo& io) {
  io.section("QNET");
  io.counter(skipped_);
  const double bound = std::max(1.0, resolved_->shared.normalize_obs ? resolved_->shared.obs_clip : 1e3);
  const size_t size = shape_.num_params();
  for (int32_t net = 0; net < count(); ++net) {
    for (float* x : {params(net), slow(net)}) {
      const StateView<float> p = io.numbers(x, size, -kMaxQOutput, kMaxQOutput);
      if (p)
        io.require(mlp_bound(shape_, StateNumbers{p}, bound) <= kMaxQOutput,
                   "a critic whose outputs may be too large");
    }
    Adam& a = adam_[net];
    io.counter(a.t);
    const StateView<float> m = io.numbers(a.m, size, -1e20, 1e20), v = io.numbers(a.v, size, 0, 1e38);
    if (m) io.require(moments_agree(m, v, size), "moments that no gradients can give");
  }
}

}  // namespace rdm

#include "algos/trust_region/trust_region.hpp"

#include <algorithm>
#include <cstring>

#include "algos/first_order/ratio_loss.hpp"

namespace rdm {

void TrustRegion::carve(Arena& arena, const ResolvedAgentConfig& resolved, const Networks& nets,
                        bool with_cost) {
  size_ = nets.block[Networks::kActor].size;
  fisher_.carve(arena, resolved);
  cg_ = carve_cg_work(arena, size_);
  for (float** v : {&g_, &x_, &step_, &before_}) *v = arena.make<float>(size_);
  if (!with_cost) return;
  for (float** v : {&b_, &p_}) *v = arena.make<float>(size_);
}

void TrustRegion::open(CancelFlag& cancel, const ResolvedAgentConfig& resolved, const Rollout& rollout,
                       Networks& nets, BatchWorkers& workers, Learner& learner) {
  cancel_ = &cancel;
  resolved_ = &resolved;
  nets_ = &nets;
  learner_ = &learner;
  fisher_.open(resolved, rollout, nets, workers);
  dims_ = resolved.options.flag("kl_mean_over_dims") ? resolved.config.action_dim : 1;
}

void TrustRegion::read_live(const Options& o) {
  fisher_.read_live(o);
  cg_options_ = {o.integer("cg_iterations"), o.number("cg_tolerance")};
  limit_ = o.number("trust_kl");
  tries_ = o.integer("line_search_steps");
  decay_ = o.number("line_search_decay");
}

void TrustRegion::gradient_of(const PolicyLoss& loss, float sign, float* out) {
  cancel_->check();
  learner_->gradient(&loss, false, batch_);
  for (size_t i = 0; i < size_; ++i) out[i] = sign * learner_->gradient()[i];
}

void TrustRegion::solve(const float* b, float* x) {
  conjugate_gradient(
      [&](const float* v, float* out) {
        cancel_->check();
        fisher_.multiply(v, out);
      },
      b, cg_, cg_options_, x);
}

void TrustRegion::linearize(const Batch& batch, int32_t cost, double share) {
  delta_ = limit_ * share * share;
  batch_ = batch;
  fisher_.set_rows(batch);
  gradient_of(GainLoss(), -1, g_);
  solve(g_, x_);
  // By x'F x rather than G'x: right also where conjugate gradients stopped early.
  fisher_.multiply(x_, cg_.product);
  q_ = dot(x_, cg_.product, size_);
  r_ = s_ = bb_ = 0;
  if (cost < 0) {
    if (p_) std::fill_n(b_, size_, 0.0f), std::fill_n(p_, size_, 0.0f);
    return;
  }
  gradient_of(CostLoss(cost), 1, b_);
  solve(b_, p_);
  r_ = dot(b_, x_, size_);
  s_ = dot(b_, p_, size_);
  bb_ = dot(b_, b_, size_);
}

void TrustRegion::set_step(double along_x, double along_p, double along_b) {
  for (size_t i = 0; i < size_; ++i) {
    double v = along_x * static_cast<double>(x_[i]);
    if (p_) v += along_p * static_cast<double>(p_[i]) + along_b * static_cast<double>(b_[i]);
    step_[i] = static_cast<float>(v);
  }
}

// The gain is less the imitation term, as its gradient is.
Surrogate TrustRegion::measure() {
  Surrogate s = learner_->measure(batch_);
  s.gain -= learner_->imitation();
  return s;
}

void TrustRegion::save() {
  std::memcpy(before_, nets_->params, size_ * sizeof(float));
}

void TrustRegion::restore() {
  std::memcpy(nets_->params, before_, size_ * sizeof(float));
}

void TrustRegion::move(double f) {
  for (size_t i = 0; i < size_; ++i)
    nets_->params[i] =
        static_cast<float>(static_cast<double>(before_[i]) + f * static_cast<double>(step_[i]));
  clamp_log_std(*nets_);
}

}  // namespace rdm

#include "algos/trust_region/trust_region.hpp"

#include <algorithm>

namespace rdm {

void TrustRegion::carve(Arena& arena, const ResolvedAgentConfig& resolved, const Networks& nets,
                        bool with_cost) {
  size_ = nets.block[Networks::kActor].size;
  fisher_.carve(arena, resolved);
  cg_work_ = carve_cg_work(arena, size_);
  for (float** v : {&g_, &x_, &step_}) *v = arena.make<float>(size_);
  if (nets.num_groups) base_ = arena.make<float>(size_);
  if (!with_cost) return;
  for (float** v : {&b_, &p_}) *v = arena.make<float>(size_);
}

void TrustRegion::open(const ResolvedAgentConfig& resolved, const Rollout& rollout, Networks& nets,
                       BatchWorkers& workers, Learner& learner) {
  nets_ = &nets;
  learner_ = &learner;
  fisher_.open(resolved, rollout, nets, workers);
}

void TrustRegion::read_live(const Options& o) {
  options_ = kTrustRows.read(o);
  fisher_.read_live(options_);
}

Job TrustRegion::begin_gradient(const PolicyLoss& loss) {
  return learner_->begin_gradient(&loss, false, batch_);
}

void TrustRegion::begin_solve(float sign, float* out, float* x) {
  for (size_t i = 0; i < size_; ++i) out[i] = sign * learner_->gradient()[i];
  cg_.begin(out, cg_work_, options_, x);
}

Job TrustRegion::solve_on() {
  return cg_.next() ? fisher_.begin_product(cg_.direction(), cg_.product()) : Job();
}

void TrustRegion::begin_linearize(const Batch& batch, int32_t cost, double share) {
  delta_ = options_.trust_kl * share * share;
  batch_ = batch;
  cost_ = cost;
  cost_loss_ = CostLoss(cost);
  r_ = s_ = bb_ = 0;
  if (p_) std::fill_n(b_, size_, 0.0f), std::fill_n(p_, size_, 0.0f);
  stage_ = Stage::kRows;
}

Job TrustRegion::linearize_on() {
  for (;;) switch (stage_) {
      case Stage::kRows:
        stage_ = Stage::kGain;
        if (Job job = fisher_.begin_rows(batch_)) return job;
        break;
      case Stage::kGain:
        stage_ = Stage::kGainThere;
        return begin_gradient(gain_);
      case Stage::kGainThere:
        stage_ = Stage::kSolveGain;
        begin_solve(-1, g_, x_);
        break;
      case Stage::kSolveGain:
        if (Job job = solve_on()) return job;
        stage_ = Stage::kProductThere;
        return fisher_.begin_product(x_, cg_.product());
      case Stage::kProductThere:
        // By x'F x rather than G'x: right also where conjugate gradients stopped early.
        q_ = dot(x_, cg_.product(), size_);
        stage_ = cost_ < 0 ? Stage::kDone : Stage::kCostThere;
        if (cost_ >= 0) return begin_gradient(cost_loss_);
        break;
      case Stage::kCostThere:
        stage_ = Stage::kSolveCost;
        begin_solve(1, b_, p_);
        break;
      case Stage::kSolveCost:
        if (Job job = solve_on()) return job;
        r_ = dot(b_, x_, size_);
        s_ = dot(b_, p_, size_);
        bb_ = dot(b_, b_, size_);
        stage_ = Stage::kDone;
        break;
      case Stage::kDone:
        return {};
    }
}

void TrustRegion::set_step(double along_x, double along_p, double along_b) {
  for (size_t i = 0; i < size_; ++i) {
    double v = along_x * static_cast<double>(x_[i]);
    if (p_) v += along_p * static_cast<double>(p_[i]) + along_b * static_cast<double>(b_[i]);
    step_[i] = static_cast<float>(v);
  }
}

Job TrustRegion::begin_search() {
  keep_base();
  fraction_ = 1;
  tried_ = 0;
  return learner_->begin_measure(batch_, 0, true);
}

// Where the search begins: the policy of before the update, but for a group of a team whose others have stepped.
void TrustRegion::keep_base() {
  if (base_)
    std::copy_n(nets_->params, size_, base_);
  else
    keep_actor(*nets_);
}

const float* TrustRegion::base() const {
  return base_ ? base_ : nets_->before;
}

bool TrustRegion::in_region() const {
  const Surrogate& s = learner_->measured();
  return s.finite() && s.kl / fisher_.dims() <= delta_;
}

Job TrustRegion::next_try() {
  if (tried_ == options_.line_search_steps) {
    std::copy_n(base(), size_, nets_->params);
    return end_search(0, before_);
  }
  if (tried_++ > 0) fraction_ *= options_.line_search_decay;
  move(fraction_);
  return learner_->begin_measure(batch_, 0, true);
}

Job TrustRegion::end_search(double taken, const Surrogate& reached) {
  taken_ = taken;
  reached_ = reached;
  return {};
}

void TrustRegion::move(double f) {
  for (size_t i = 0; i < size_; ++i)
    nets_->params[i] = static_cast<float>(static_cast<double>(base()[i]) + f * static_cast<double>(step_[i]));
  clamp_log_std(*nets_);
}

}  // namespace rdm

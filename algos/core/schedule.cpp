#include "algos/core/schedule.hpp"

#include <algorithm>

#include "algos/core/option_tables.hpp"

namespace rdm {

void RateSchedule::open(const SharedOptions& o) {
  o_ = &o;
  base_ = -1;
  read_live();
}

void RateSchedule::read_live() {
  if (o_->learning_rate != base_) base_ = adapted_ = o_->learning_rate;
}

double RateSchedule::share(int32_t done) const {
  return o_->rate_kind == RateKind::kLinear ? std::max(0.0, 1 - static_cast<double>(done) / o_->total_epochs)
                                            : 1;
}

double RateSchedule::rate(int32_t done) const {
  return o_->rate_kind == RateKind::kKl ? adapted_ : base_ * share(done);
}

void RateSchedule::adapt(double kl, int32_t done) {
  if (o_->rate_kind != RateKind::kKl) return;
  const double passed = std::min(1.0, static_cast<double>(done) / o_->total_epochs);
  const double end = o_->kl_target_end > 0 ? o_->kl_target_end : o_->kl_target;
  const double target = o_->kl_target + passed * (end - o_->kl_target);
  if (kl > 2 * target)
    adapted_ = std::max(o_->lr_min, adapted_ / o_->kl_factor);
  else if (kl < target / 2)
    adapted_ = std::min(o_->lr_max, adapted_ * o_->kl_factor);
}

void RateSchedule::visit(StateIo& io) {
  io.section("RATE");
  io.number(adapted_, 0, kMaxLearningRate);
}

}  // namespace rdm

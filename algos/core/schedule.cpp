#include "algos/core/schedule.hpp"

#include <algorithm>
#include <cstring>

#include "algos/core/option_tables.hpp"

namespace rdm {

void RateSchedule::reset(const Options& o) {
  const char* kind = o.text("lr_schedule");
  kind_ = std::strcmp(kind, "linear") == 0 ? Kind::kLinear
          : std::strcmp(kind, "kl") == 0   ? Kind::kKl
                                           : Kind::kConstant;
  base_ = -1;
  read_live(o);
}

void RateSchedule::read_live(const Options& o) {
  if (const double rate = o.number("learning_rate"); rate != base_) base_ = adapted_ = rate;
  total_ = o.integer("total_epochs");
  target_ = o.number("kl_target");
  target_end_ = o.number("kl_target_end");
  if (target_end_ == 0) target_end_ = target_;
  factor_ = o.number("kl_factor");
  low_ = o.number("lr_min");
  high_ = o.number("lr_max");
}

double RateSchedule::share(int32_t done) const {
  return kind_ == Kind::kLinear ? std::max(0.0, 1 - static_cast<double>(done) / total_) : 1;
}

double RateSchedule::rate(int32_t done) const {
  if (kind_ == Kind::kLinear) return base_ * share(done);
  return kind_ == Kind::kKl ? adapted_ : base_;
}

void RateSchedule::adapt(double kl, int32_t done) {
  if (kind_ != Kind::kKl) return;
  const double passed = std::min(1.0, static_cast<double>(done) / total_);
  const double target = target_ + passed * (target_end_ - target_);
  if (kl > 2 * target)
    adapted_ = std::max(low_, adapted_ / factor_);
  else if (kl < target / 2)
    adapted_ = std::min(high_, adapted_ * factor_);
}

void RateSchedule::visit(StateIo& io) {
  io.section("RATE");
  io.number(adapted_, 0, kMaxLearningRate);
}

}  // namespace rdm

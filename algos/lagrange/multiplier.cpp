#include "algos/lagrange/multiplier.hpp"

#include <algorithm>
#include <cmath>

#include "algos/core/option_tables.hpp"
#include "base/elementary.hpp"

namespace rdm {
namespace {

// In limits. Near a limit of 0 any cost would be an excess without bound, and the multiplier would jump to a
// height that it never comes back from. At 0 itself each epoch with a cost counts as this much.
constexpr double kMostExcess = 3;

double softplus(double w) {
  return w > 30 ? w : elementary::log1p(elementary::exp(w));
}
double softplus_inverse(double l) {
  return l > 30 ? l : elementary::log(elementary::expm1(std::max(l, 1e-12)));
}

}  // namespace

void Multiplier::reset(const MultiplierOptions& options) {
  *this = Multiplier();
  value_ = std::min(options.init, options.max);
  raw_ = options.optimizer == MultiplierOptimizer::kSoftplus ? softplus_inverse(value_) : value_;
}

void Multiplier::step(const MultiplierOptions& options, double cost, double limit, double warmth) {
  double e = cost - limit;
  if (options.normalized) e = std::min(e / std::max(limit, 1e-8), kMostExcess);
  const double rate = options.rate * warmth;
  if (options.optimizer == MultiplierOptimizer::kSgd) {
    raw_ += rate * e;
  } else {
    ++t_;
    m_ = 0.9 * m_ - 0.1 * e;
    v_ = 0.999 * v_ + 0.001 * e * e;
    const double m = m_ / (1 - elementary::pow(0.9, t_));
    const double v = v_ / (1 - elementary::pow(0.999, t_));
    raw_ -= rate * m / (std::sqrt(v) + 1e-8);
  }
  if (options.optimizer == MultiplierOptimizer::kSoftplus)
    raw_ = std::min(raw_, softplus_inverse(options.max));
  else
    raw_ = std::clamp(raw_, 0.0, options.max);
  const double learnt = options.optimizer == MultiplierOptimizer::kSoftplus ? softplus(raw_) : raw_;
  value_ = options.gain > 0 ? std::clamp(learnt + options.gain * warmth * e, 0.0, options.max) : learnt;
}

void Multiplier::visit(StateIo& io) {
  io.number(value_, 0, 2 * kMaxMultiplier);
  io.number(raw_, -1e20, 1e20);
  const StateView<double> m = io.number(m_, -1e100, 1e100), v = io.number(v_, 0, 1e200);
  // As of any moments of Adam: |m| <= 7.27 sqrt(v) (networks.cpp).
  if (m) io.require(std::abs(m[0]) <= 8 * std::sqrt(v[0]) + 1e-100, "moments that no costs can give");
  io.counter(t_);
}

}  // namespace rdm

// The Lagrange multiplier of one cost limit, moved once per epoch by the episode cost J_c: dual ascent on
//   min over l >= 0 of  max over theta of  J_r(theta) - l (J_c(theta) - limit)
// whose derivative by l is the violation (Ray et al. 2019; Altman 1999 for the duality of constrained
// decision processes). Nothing moves it in an epoch in which no episode ended.
#pragma once
#include <cstdint>

#include "algos/core/state_io.hpp"

namespace rdm {

enum class MultiplierOptimizer : int32_t { kSgd, kAdam, kSoftplus };

struct MultiplierOptions {
  MultiplierOptimizer optimizer = MultiplierOptimizer::kAdam;
  double init = 0.001, rate = 0.035, max = 1e6;
  bool normalized = false;  // the violation is divided by the limit, at most 3
  double gain = 0;          // of the augmented Lagrangian's term
};

// With e = J_c - limit:
//   sgd       l <- clip(l + rate e, 0, max)
//   adam      Adam on the loss -l e, then the same clip: about +-rate per epoch whatever the violation
//   softplus  l = ln(1 + e^w), Adam on the loss -w e (Ray et al. 2019)
// The value is clip(l + gain e, 0, max): with gain > 0 the slope of the augmented Lagrangian
// l e + gain e^2 / 2 (Hestenes 1969). Where the Lagrangian is flat along the policy, dual ascent alone
// circles about the optimum.
class Multiplier {
 public:
  void reset(const MultiplierOptions& options);
  // warmth in [0, 1] scales rate and gain of this step.
  void step(const MultiplierOptions& options, double cost, double limit, double warmth);
  double value() const { return value_; }
  void visit(StateIo& io);

 private:
  double value_ = 0, raw_ = 0;  // raw: l, or w of the softplus form
  double m_ = 0, v_ = 0;        // Adam's moments
  int64_t t_ = 0;
};

}  // namespace rdm

// Motion under a constant acceleration a and linear damping c over a time h, exact: v' = a - c v gives
//   v(h) = keep v0 + gain h a              keep = e^-hc,  gain = (1 - keep) / hc
//   x(h) = x0 + h (gain v0 + fall h a)     fall = (1 - gain) / hc
// At c = 0 these are 1, 1 and 1/2: the parabola. A force F on a mass m is a = F / m: against everything that
// acts during h, a damped thing has the mass m / gain.
#pragma once
#include "base/elementary.hpp"

namespace rdm {

struct Flow {
  double keep = 1, gain = 1, fall = 0.5;
};

// h in s, c in 1/s, not negative.
inline Flow damped_flow(double h, double c) {
  const double x = h * c;
  // gain and fall are differences of near numbers for small x: their series there, exact to rounding
  if (x < 1e-4) return {1 - x + x * x / 2, 1 - x / 2 + x * x / 6, 0.5 - x / 6 + x * x / 24};
  const double gain = -elementary::expm1(-x) / x;
  return {elementary::exp(-x), gain, (1 - gain) / x};
}

}  // namespace rdm

#include "nn/adam.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "nn/kernels.hpp"

namespace rdm {

Adam carve_adam(Arena& arena, size_t size) {
  Adam a;
  a.size = size;
  a.m = arena.make<float>(size);
  a.v = arena.make<float>(size);
  return a;
}

double sum_squares(const float* x, size_t count) {
  return kernels().sum_squares(x, count);
}

AdamStep adam_begin(Adam& adam, float* params, const float* grad, double rate, double max_norm) {
  return adam_begin(adam, params, grad, std::sqrt(sum_squares(grad, adam.size)), rate, max_norm);
}

AdamStep adam_begin(Adam& adam, float* params, const float* grad, double norm, double rate, double max_norm) {
  AdamStep step;
  step.norm = norm;
  if (!std::isfinite(step.norm)) return step;  // args.size stays 0: adam_range does nothing
  // As PyTorch's clip_grad_norm_: the 1e-6 keeps 0 / 0 away.
  const double clip = max_norm > 0 ? std::min(1.0, max_norm / (step.norm + 1e-6)) : 1.0;
  ++adam.t;
  // The means begin at 0: divided by 1 - beta^t they are unbiased. Both become constants of the step.
  const double bias1 = 1 - elementary::pow(0.9, adam.t);
  const double bias2 = 1 - elementary::pow(0.999, adam.t);
  step.args = {adam.size,
               params,
               adam.m,
               adam.v,
               grad,
               static_cast<float>(clip),
               static_cast<float>(rate / bias1),
               static_cast<float>(1 / std::sqrt(bias2))};
  return step;
}

void adam_range(const AdamStep& step, size_t low, size_t high) {
  AdamArgs part = step.args;
  high = std::min(high, part.size);  // the last thread's share may be short
  if (low >= high) return;
  part.size = high - low;
  part.params += low, part.m += low, part.v += low, part.grad += low;
  kernels().adam(part);
}

double adam_step(Adam& adam, float* params, const float* grad, double rate, double max_norm) {
  const AdamStep step = adam_begin(adam, params, grad, rate, max_norm);
  adam_range(step, 0, adam.size);
  return step.norm;
}

}  // namespace rdm

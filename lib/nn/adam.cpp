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

double adam_step(Adam& adam, float* params, const float* grad, double rate, double max_norm) {
  const Kernels& kernel = kernels();
  const double norm = std::sqrt(kernel.sum_squares(grad, adam.size));
  if (!std::isfinite(norm)) return norm;
  const double clip = max_norm > 0 ? std::min(1.0, max_norm / (norm + 1e-6)) : 1.0;
  ++adam.t;
  const double bias1 = 1 - elementary::pow(0.9, adam.t);
  const double bias2 = 1 - elementary::pow(0.999, adam.t);
  kernel.adam({adam.size, params, adam.m, adam.v, grad, static_cast<float>(clip),
               static_cast<float>(rate / bias1), static_cast<float>(1 / std::sqrt(bias2))});
  return norm;
}

}  // namespace rdm

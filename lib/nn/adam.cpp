#include "nn/adam.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {

Adam carve_adam(Arena& arena, size_t size) {
  Adam a;
  a.size = size;
  a.m = arena.make<float>(size);
  a.v = arena.make<float>(size);
  return a;
}

double adam_step(Adam& adam, float* params, const float* grad, double rate, double max_norm) {
  double sum = 0;
  for (size_t i = 0; i < adam.size; ++i) sum += static_cast<double>(grad[i]) * static_cast<double>(grad[i]);
  const double norm = std::sqrt(sum);
  if (!std::isfinite(norm)) return norm;
  const double clip = max_norm > 0 ? std::min(1.0, max_norm / (norm + 1e-6)) : 1.0;
  ++adam.t;
  const double bias1 = 1 - std::pow(0.9, static_cast<double>(adam.t));
  const double bias2 = 1 - std::pow(0.999, static_cast<double>(adam.t));
  const auto step = static_cast<float>(rate / bias1), root = static_cast<float>(1 / std::sqrt(bias2));
  const auto scale = static_cast<float>(clip);
  for (size_t i = 0; i < adam.size; ++i) {
    const float g = grad[i] * scale;
    adam.m[i] += 0.1f * (g - adam.m[i]);
    adam.v[i] += 0.001f * (g * g - adam.v[i]);
    params[i] -= step * adam.m[i] / (std::sqrt(adam.v[i]) * root + 1e-8f);
  }
  return norm;
}

}  // namespace rdm

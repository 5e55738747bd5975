#include "algos/rollout/gae.hpp"

#include <cmath>
#include <cstddef>

namespace rdm {

void gae(const GaeColumn& c, const float* discount, const uint8_t* valid, int32_t horizon, int32_t num_envs,
         double lambda) {
  const auto n = static_cast<size_t>(num_envs), stride = static_cast<size_t>(c.stride);
  for (size_t env = 0; env < n; ++env) {
    double advantage = 0, next = static_cast<double>(c.last_value[env * stride]);
    for (size_t t = static_cast<size_t>(horizon); t-- > 0;) {
      const size_t row = t * n + env, at = row * stride;
      const auto value = static_cast<double>(c.value[at]), d = static_cast<double>(discount[row]);
      // A plain 0 for d keeps a value that is not a number from leaking over the end of a path.
      const double ahead = d == 0 ? 0 : d * (next + lambda * advantage);
      advantage = valid[row] ? static_cast<double>(c.reward[at]) + ahead - value : 0;
      c.advantage[at] = static_cast<float>(advantage);
      c.target[at] = static_cast<float>(advantage + value);
      next = value;
    }
  }
}

double masked_mean(const float* x, int32_t stride, const uint8_t* valid, int32_t count) {
  double sum = 0, n = 0;
  for (size_t i = 0; i < static_cast<size_t>(count); ++i)
    if (valid[i]) sum += static_cast<double>(x[i * static_cast<size_t>(stride)]), n += 1;
  return n > 0 ? sum / n : 0;
}

void standardize(float* x, int32_t stride, const uint8_t* valid, int32_t count, bool divide) {
  const double mean = masked_mean(x, stride, valid, count);
  double squares = 0, n = 0;
  for (size_t i = 0; i < static_cast<size_t>(count); ++i)
    if (valid[i]) {
      const double gap = static_cast<double>(x[i * static_cast<size_t>(stride)]) - mean;
      squares += gap * gap, n += 1;
    }
  const double scale = divide && n > 0 ? 1 / (std::sqrt(squares / n) + 1e-8) : 1;
  for (size_t i = 0; i < static_cast<size_t>(count); ++i)
    if (valid[i]) {
      float& v = x[i * static_cast<size_t>(stride)];
      v = static_cast<float>((static_cast<double>(v) - mean) * scale);
    }
}

}  // namespace rdm

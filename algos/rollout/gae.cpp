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

double masked_mean(const BlockRows& rows, const float* x, int32_t stride, Ranks& ranks) {
  const int32_t envs = ranks.block_envs();
  const auto [sum, n] = ranks.sum<2>([&](int32_t b, double* out) {
    out[0] = out[1] = 0;
    rows.each(b * envs, envs, [&](int32_t row) {
      out[0] += static_cast<double>(x[static_cast<size_t>(row) * static_cast<size_t>(stride)]), out[1] += 1;
    });
  });
  return n > 0 ? sum / n : 0;
}

void standardize(const BlockRows& rows, float* x, int32_t stride, bool divide, Ranks& ranks) {
  const double mean = masked_mean(rows, x, stride, ranks);
  const int32_t envs = ranks.block_envs();
  const auto at = [&](int32_t row) -> float& {
    return x[static_cast<size_t>(row) * static_cast<size_t>(stride)];
  };
  double scale = 1;
  if (divide) {
    const auto [squares, n] = ranks.sum<2>([&](int32_t b, double* out) {
      out[0] = out[1] = 0;
      rows.each(b * envs, envs, [&](int32_t row) {
        const double gap = static_cast<double>(at(row)) - mean;
        out[0] += gap * gap, out[1] += 1;
      });
    });
    if (n > 0) scale = 1 / (std::sqrt(squares / n) + 1e-8);
  }
  rows.each(0, rows.num_envs, [&](int32_t row) {
    at(row) = static_cast<float>((static_cast<double>(at(row)) - mean) * scale);
  });
}

}  // namespace rdm

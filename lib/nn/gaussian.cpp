#include "nn/gaussian.hpp"

#include <cmath>

namespace rdm {
namespace {
constexpr double kHalfLogTwoPi = 0.91893853320467274178;
}

float gaussian_log_prob(const float* mean, const float* log_std, const float* action, int32_t dim) {
  float sum = 0;
  for (int32_t j = 0; j < dim; ++j) {
    const float u = (action[j] - mean[j]) * std::exp(-log_std[j]);
    sum -= 0.5f * u * u + log_std[j] + static_cast<float>(kHalfLogTwoPi);
  }
  return sum;
}

void gaussian_log_prob_grad(const float* mean, const float* log_std, const float* action, int32_t dim,
                            float scale, float* dmean, float* dlog_std) {
  for (int32_t j = 0; j < dim; ++j) {
    const float s = std::exp(-log_std[j]), u = (action[j] - mean[j]) * s;
    dmean[j] = scale * u * s;
    dlog_std[j] += scale * (u * u - 1);
  }
}

float gaussian_entropy(const float* log_std, int32_t dim) {
  float sum = 0;
  for (int32_t j = 0; j < dim; ++j) sum += log_std[j] + static_cast<float>(kHalfLogTwoPi + 0.5);
  return sum;
}

float gaussian_kl(const float* mean0, const float* log_std0, const float* mean1, const float* log_std1,
                  int32_t dim) {
  float sum = 0;
  for (int32_t j = 0; j < dim; ++j) {
    const float d = log_std1[j] - log_std0[j], u = (mean0[j] - mean1[j]) * std::exp(-log_std1[j]);
    sum += d + 0.5f * (std::expm1(-2 * d) + u * u);
  }
  return sum;
}

}  // namespace rdm

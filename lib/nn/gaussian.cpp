#include "nn/gaussian.hpp"

#include "nn/kernels.hpp"

namespace rdm {

float gaussian_log_prob(const float* mean, const float* log_std, const float* action, int32_t dim) {
  return kernels().log_prob(mean, log_std, action, dim);
}

void gaussian_log_prob_grad(const float* mean, const float* log_std, const float* action, int32_t dim,
                            float scale, float* dmean, float* dlog_std) {
  kernels().log_prob_grad(mean, log_std, action, dim, scale, dmean, dlog_std);
}

float gaussian_kl(const float* mean0, const float* log_std0, const float* mean1, const float* log_std1,
                  int32_t dim) {
  return kernels().kl(mean0, log_std0, mean1, log_std1, dim);
}

}  // namespace rdm

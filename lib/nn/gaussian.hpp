// Diagonal Gaussian over actions with a log standard deviation that does not depend on the state.
// Formulas: log-probabilities and KL sum over action dimensions; natural logarithms.
#pragma once
#include <cstdint>

namespace rdm {

// log p(a) of one sample: sum_j -((a-mu)/sigma)^2/2 - log sigma - log(2 pi)/2.
float gaussian_log_prob(const float* mean, const float* log_std, const float* action, int32_t dim);

// d log p / d mu into dmean [dim] (overwritten), d log p / d log sigma added to dlog_std [dim], both times
// `scale`.
void gaussian_log_prob_grad(const float* mean, const float* log_std, const float* action, int32_t dim,
                            float scale, float* dmean, float* dlog_std);

// KL(p0 || p1).
float gaussian_kl(const float* mean0, const float* log_std0, const float* mean1, const float* log_std1,
                  int32_t dim);

}  // namespace rdm

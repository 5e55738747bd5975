// Products with the Fisher matrix of the policy, without forming it.
//
// For a Gaussian whose deviation does not depend on the state the Hessian of the mean KL(old || new) at
// new = old is J' diag(1 / sigma^2) J / N for the network, J the derivative of the mean, and 2 I for the log
// deviations, with nothing between the two. With std_mode=state it is J' diag(1 / sigma^2, 2) J / N, J the
// derivative of means and log deviations; where these are at a bound, J is 0.
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/core/networks.hpp"
#include "algos/core/rollout.hpp"

namespace rdm {

class Fisher {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved);
  // All must outlive it.
  void open(const ResolvedAgentConfig& resolved, const Rollout& rollout, const Networks& nets,
            BatchWorkers& workers);
  void read_live(const Options& options);

  // The matrix is of every stride-th of the listed rows, at the policy as it is at each product.
  void set_rows(const int32_t* order, int32_t rows);
  // out = (F + damping I) v; both laid out as the actor's block.
  void multiply(const float* v, float* out);

 private:
  // Tangents of the outputs of n rows into what is propagated back.
  void weigh(const float* y, int32_t n, float* dy) const;

  const ResolvedAgentConfig* resolved_ = nullptr;
  const Rollout* rollout_ = nullptr;
  const Networks* nets_ = nullptr;
  BatchWorkers* workers_ = nullptr;
  float* weight_ = nullptr;  // [action_dim] 1 / (N sigma^2); none with std_mode=state
  const int32_t* order_ = nullptr;
  int32_t rows_ = 0, stride_ = 1;
  double damping_ = 0.1, dims_ = 1;  // dims: what sums over action dimensions are divided by
};

}  // namespace rdm

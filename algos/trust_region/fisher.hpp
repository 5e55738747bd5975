// Products with the Fisher matrix of the policy, without forming it (Schulman et al. 2015, appendix C.1).
//
// Of two normals in one dimension
//   KL(old || new) = ln(s / s_old) + (s_old^2 + (m_old - m)^2) / (2 s^2) - 1/2
// has at new = old the second derivatives 1 / s^2 by m, 2 by ln s, and 0 between the two. So the Hessian of
// the mean KL over N rows is, with J the derivative of the network's outputs by its parameters,
//   std_mode=free    J' diag(1 / s^2) J / N for the network, 2 I for the log deviations
//   std_mode=state   J' diag(1 / s^2, 2) J / N; J is 0 where a deviation is at a bound
// and F v is one pass forward with tangents (J v), a scaling of the outputs, and one pass back (J').
//
// With a GRU the outputs are those of sequences, and both passes go through their decisions, from the states before
// them, which are constants, as in the gradient (rollout/sequences.hpp).
//
// Departures: damping I is added, as all do; the sum is over every fisher_stride-th row (1; 4 in the defaults
// of throws, for speed); kl_mean_over_dims divides KL and F by the number of actions, as the peers' code
// does, where the paper sums.
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/core/job.hpp"
#include "algos/core/networks.hpp"
#include "algos/rollout/rollout.hpp"

namespace rdm {

struct FisherOptions {
  double cg_damping;
  int32_t fisher_stride;
  bool kl_mean_over_dims;
};

class Fisher {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved);
  // All must outlive it.
  void open(const ResolvedAgentConfig& resolved, const Rollout& rollout, const Networks& nets,
            BatchWorkers& workers);
  void read_live(const FisherOptions& options) { options_ = options; }
  // What sums over action dimensions are divided by.
  double dims() const { return options_.kl_mean_over_dims ? resolved_->config.action_dim : 1; }

  // The matrix is of every stride-th of each block's rows, at the policy as it is at each product. An encoder
  // is held at what it is now: all points go through it here, once, and winners alone in each product; of no
  // job there are none.
  Job begin_rows(const Batch& batch);
  void set_rows(const Batch& batch) { begin_rows(batch).finish(); }
  // out = (F + damping I) v; both laid out as the actor's block.
  Job begin_product(const float* v, float* out);
  void multiply(const float* v, float* out) { begin_product(v, out).finish(); }

 private:
  int32_t stride() const { return options_.fisher_stride; }
  bool advance_rows(bool whole);
  bool advance_product(bool whole);
  void multiply_chunk(Workspace& workspace, const Chunk& chunk);
  void multiply_sequences(Workspace& workspace, const Chunk& chunk, float* grad) const;
  void end_product();
  PointRows clouds(const int32_t* rows) const;
  // Tangents of the outputs of n rows into what is propagated back.
  void weigh(const float* y, int32_t n, float* dy) const;

  const ResolvedAgentConfig* resolved_ = nullptr;
  const Rollout* rollout_ = nullptr;
  const Networks* nets_ = nullptr;
  BatchWorkers* workers_ = nullptr;
  float* weight_ = nullptr;    // [action_dim] 1 / (N sigma^2); none with std_mode=state
  float* features_ = nullptr;  // [samples][features] of an encoder that learns, and the points that won
  int32_t* winner_ = nullptr;  // likewise
  Batch batch_;
  Sweep sweep_;
  const float* v_ = nullptr;  // of the product at hand
  float* out_ = nullptr;
  int32_t rows_ = 0;  // that the matrix is of, of all ranks
  FisherOptions options_{};
};

}  // namespace rdm

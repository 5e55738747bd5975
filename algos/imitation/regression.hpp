// The actor's mean fitted to what a teacher meant, over listed rows of a recording:
//
//   L = 1/N sum_i sum_j p_j (mean_j(o_i) - label_ij)^2 / 2,   p_j = 1, or 1 / sigma_j^2 of the policy as it
//   is
//
// With p = 1 / sigma^2 it is -log pi(label | o) but for a constant, sigma held: its gradient moves the mean
// alone. Labels are cut to [-1, 1], as actions are. Chunks are reduced in order, as everywhere (learner.hpp).
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/core/networks.hpp"
#include "algos/rollout/collector.hpp"

namespace rdm {

// Rows of a recording; somebody else's arrays.
struct DemoRows {
  int32_t rows = 0;
  const float* obs = nullptr;        // [rows][obs_dim] as a pool gives them
  const float* label = nullptr;      // [rows][action_dim]
  const int64_t* episode = nullptr;  // [rows] number, null: one
  PointRows clouds = {};             // [rows], for an agent with eyes
};

class Regression {
 public:
  // All must outlive it.
  void open(const ResolvedAgentConfig& resolved, const Collector& collector, const Networks& nets,
            BatchWorkers& workers);

  // L, and weight dL of the actor's block: written to grad [Networks::size], or with `add` added to it.
  double gradient(const DemoRows& demo, const int32_t* order, int32_t rows, bool precise, double weight,
                  bool add, float* grad) const;
  double loss(const DemoRows& demo, const int32_t* order, int32_t rows, bool precise) const;
  // What the encoder makes of all clouds: out [rows][features].
  void features(const DemoRows& demo, float* out) const;

 private:
  // Twice the sum of L's terms; grad null: no gradient.
  double chunk(const Workspace& workspace, const DemoRows& demo, const int32_t* order, int32_t rows,
               bool precise, float scale, float* grad) const;
  const ResolvedAgentConfig* resolved_ = nullptr;
  const Collector* collector_ = nullptr;
  const Networks* nets_ = nullptr;
  BatchWorkers* workers_ = nullptr;
};

}  // namespace rdm

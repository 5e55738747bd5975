// The actor's mean fitted to what a teacher meant, over listed rows of a recording:
//
//   L = 1/N sum_i sum_j p_j (mean_j(o_i) - label_ij)^2 / 2,   p_j = 1, or 1 / sigma_j^2 of the policy as it
//   is
//
// With p = 1 / sigma^2 it is -log pi(label | o) but for a constant, sigma held: its gradient moves the mean
// alone. Labels are cut to [-1, 1], as actions are. Chunks are reduced in order, as everywhere (learner.hpp).
//
// What is listed are items: rows, or for an actor with a GRU the paths of a DemoMemory, of which the states before
// their first decisions are those that `remember` found, and constants.
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/core/networks.hpp"
#include "algos/imitation/demo_memory.hpp"
#include "algos/rollout/collector.hpp"

namespace rdm {

// Rows of a recording; somebody else's arrays.
struct DemoRows {
  int32_t rows = 0;
  const float* obs = nullptr;        // [rows][obs_dim] as a pool gives them
  const float* label = nullptr;      // [rows][action_dim]
  const int64_t* episode = nullptr;  // [rows] number, null: one
  PointRows clouds = {};             // [rows], for an agent with eyes
  const int32_t* before =
      nullptr;  // [rows] row of the decision before in the same episode, -1: none; of a history
  DemoMemory* memory = nullptr;  // of an agent with a GRU

  int64_t episode_of(int32_t row) const { return episode ? episode[row] : 0; }
  int64_t episodes() const {
    int64_t count = 1;
    for (int32_t i = 0; episode && i < rows; ++i) count = std::max(count, episode[i] + 1);
    return count;
  }
  int32_t items() const { return memory ? memory->paths() : rows; }
  int32_t rows_of(int32_t item) const { return memory ? memory->rows(item) : 1; }
  int32_t first_row(int32_t item) const { return memory ? memory->row(item, 0) : item; }
};

// L of listed items on its way.
struct Fit {
  const DemoRows* demo = nullptr;
  const int32_t* order = nullptr;  // [items]
  int32_t items = 0, rows = 0;     // rows: of all of them
  bool precise = false;            // p = 1 / sigma^2
  double weight = 0;               // of the gradient
  float* grad = nullptr;  // [Networks::size], of which the actor's block gets weight dL; null: L alone
  bool add = false;       // it is added
  int32_t group = 0;      // the chunk that comes next, -1: none
  double sum = 0;
  double loss() const { return sum / (2.0 * rows); }
};

class Regression {
 public:
  // All must outlive it.
  void open(const ResolvedAgentConfig& resolved, const Collector& collector, const Networks& nets,
            BatchWorkers& workers);

  // One group of chunks more; true when that was the last one.
  bool advance(Fit& fit) const;
  // L, and weight dL of the actor's block, written to grad [Networks::size].
  double gradient(const DemoRows& demo, const int32_t* order, int32_t items, bool precise, double weight,
                  float* grad) const;
  double loss(const DemoRows& demo, const int32_t* order, int32_t items, bool precise) const;
  // What the policy as it is remembers before each path of the recording: a group of episodes more, `group` the chunk
  // that comes next and at first 0; true when that was the last one. Nothing where there are no paths.
  bool remember_on(const DemoRows& demo, int32_t& group) const;
  void remember(const DemoRows& demo) const {
    for (int32_t group = 0; !remember_on(demo, group);) {
    }
  }
  // What the encoder makes of all clouds: out [rows][features].
  void features(const DemoRows& demo, float* out) const;

 private:
  // Listed rows as the actor sees them, normalised, in the workspace; with option history those before them too, which
  // are normalised as the row itself is.
  const float* gather(const Workspace& workspace, const DemoRows& demo, const int32_t* order,
                      int32_t rows) const;
  // Twice the sum of L's terms; grad null: no gradient.
  double chunk(Workspace& workspace, const Fit& fit, const int32_t* order, int32_t items, float* grad) const;
  double chunk_of_paths(Workspace& workspace, const Fit& fit, const int32_t* path, int32_t count,
                        float* grad) const;
  // Runs the listed paths side by side from their states: observations are in the workspace's obs [steps][count], what
  // the actor gives in its sequences.
  MemorySteps forward_paths(Workspace& workspace, const DemoRows& demo, const int32_t* path,
                            int32_t count) const;
  void remember_episodes(Workspace& workspace, const DemoRows& demo, int32_t first, int32_t count) const;
  int32_t chunk_items(const DemoRows& demo) const {
    return demo.memory ? std::max(1, resolved_->chunk_rows / resolved_->memory_chunk())
                       : resolved_->chunk_rows;
  }
  const ResolvedAgentConfig* resolved_ = nullptr;
  const Collector* collector_ = nullptr;
  const Networks* nets_ = nullptr;
  BatchWorkers* workers_ = nullptr;
};

}  // namespace rdm

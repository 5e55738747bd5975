// Batches cut into chunks of fixed size, several in flight. Chunks are reduced in their order, so sums are
// the same for any number of workers and any schedule: float sums depend on the order of their terms, so the
// cut depends on the batch alone, never on the threads. Sums over blocks of worlds, and over ranks, meet in a
// tree (ranks.hpp).
#pragma once
#include <memory>
#include <optional>

#include "algos/core/networks.hpp"
#include "algos/core/ranks.hpp"
#include "base/workers.hpp"

namespace rdm {

// Sums over the samples of a chunk or a batch.
struct BatchSums {
  double loss = 0, kl = 0, clipped = 0, reward_loss = 0, cost_loss = 0;
  BatchSums& operator+=(const BatchSums& b) {
    loss += b.loss, kl += b.kl, clipped += b.clipped;
    reward_loss += b.reward_loss, cost_loss += b.cost_loss;
    return *this;
  }
  BatchSums scaled(double s) const { return {s * loss, s * kl, s * clipped, s * reward_loss, s * cost_loss}; }
};

// Means over listed rows, or sums on the way to them, of what the policy as it is now does to them.
struct Surrogate {
  double gain = 0;              // rho (gain + linear)
  double cost[kMaxCosts] = {};  // rho A_c of each limited cost, or its clipped form
  double kl = 0;                // KL(old || now)
  bool finite() const;
  Surrogate& operator+=(const Surrogate& b);
};

// A run of a list of rows.
struct Segment {
  int32_t first = 0, rows = 0;
};

// Rows of a rollout, block after block.
struct Batch {
  Batch() = default;
  // One block's.
  Batch(const int32_t* listed, int32_t count) : order(listed), rows(count) {}

  Segment segment(int32_t block) const { return segments ? segments[block] : Segment{0, rows}; }

  const int32_t* order = nullptr;
  int32_t rows = 0;                   // of all blocks of all ranks: what means divide by
  int32_t blocks = 1;                 // of this rank
  const Segment* segments = nullptr;  // [blocks] of order; null: one of all rows
  // Rows that belong together, so that a chunk does not end between them: those of one of so many environments, of so
  // many decisions in a row (rollout/sequences.hpp), which stand one behind the other. path 0: each by itself.
  int32_t envs = 0, path = 0;
};

// What one thread does of a batch at a time.
struct Chunk {
  int32_t block = 0;
  const int32_t* order = nullptr;   // [rows], every stride-th entry
  int32_t rows = 0;                 // 0: of an empty block
  bool begins = true, ends = true;  // the block's first, its last
};

// Where a sweep over every stride-th row of each block of a batch is: groups of chunks that run together.
struct Sweep {
  Sweep() = default;
  explicit Sweep(const Batch& rows, int32_t every = 1) : batch(rows), stride(every) {}
  bool over() const { return block >= batch.blocks; }

  Batch batch;
  int32_t stride = 1;
  int32_t block = 0, done = 0;  // where the next group begins: rows of the block that are done
  int32_t chunks = 0;           // of the group at hand
  int32_t depth = 0;            // nodes of the tree that wait (BatchWorkers::reduce)
};

// Sequences of a chunk, of an actor that learns through its memory (rollout/sequences.hpp); time-major.
struct SequenceSpace {
  int32_t most = 0;              // sequences
  int32_t count = 0, steps = 0;  // of the chunk at hand
  int32_t *env = nullptr, *begin = nullptr,
          *last = nullptr;                // [most] of each: where, its first row, its last listed one
  int32_t* place = nullptr;               // [chunk_rows] of a listed row among all steps
  uint8_t* clear = nullptr;               // [most path]
  float* h0 = nullptr;                    // [most][units]
  float *out = nullptr, *dout = nullptr;  // [most path][actor's outputs]
};

// Workspace of one chunk in flight.
struct Workspace {
  int32_t rows = 0;
  ActorScratch actor;
  ActorScratch critic;
  SequenceSpace sequences;
  float* obs = nullptr;                   // [rows][seen_dim]; with sequences as many as these have steps
  float *out = nullptr, *dout = nullptr;  // [rows][widest output]
  float* grad = nullptr;                  // [num_params]
  BatchSums sums;
  Surrogate surrogate;
  Chunk chunk;
};

// One workspace per thread that helps, at most one per chunk.
class BatchWorkers {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params);
  void open(const HostHooks& hooks, int32_t threads) { threads_.emplace(hooks, threads); }

  Ranks& ranks() { return ranks_; }
  const Ranks& ranks() const { return ranks_; }
  int32_t count() const { return count_; }
  const Workspace& operator[](int32_t i) const { return workspaces_[i]; }

  // body(i) for i in [0, n), spread over the threads. body must not throw.
  template <class Body>
  void spread(int32_t n, Body&& body) {
    if (n == 1 || threads_->width() == 1) {
      for (int32_t i = 0; i < n; ++i) body(i);
      return;
    }
    using Plain = std::remove_reference_t<Body>;
    threads_->run(
        n, [](void* context, int32_t i) { (*static_cast<Plain*>(context))(i); },
        const_cast<void*>(static_cast<const void*>(std::addressof(body))));
  }

  // body(low, high) for ranges that [begin, end) is cut into, each on the thread that has it every time: what
  // one writes of a gradient lies near it when it comes to read it.
  template <class Body>
  void ranges(size_t begin, size_t end, Body&& body) {
    const auto n = static_cast<size_t>(count_), size = end - begin;
    spread(count_, [&](int32_t range) {
      const auto k = static_cast<size_t>(range);
      body(begin + size * k / n, begin + size * (k + 1) / n);
    });
  }

  // work(workspace, first, n) for the group of chunks of [0, rows) that begins with chunk `group`, then
  // reduce(group, n): chunk group + i was done by workspace i. Returns the next group's first chunk, -1 behind
  // the last group.
  template <class Work, class Reduce>
  int32_t sweep_group(int32_t rows, int32_t chunk_rows, int32_t group, Work&& work, Reduce&& reduce) {
    const int32_t chunks = (rows + chunk_rows - 1) / chunk_rows, n = std::min(count_, chunks - group);
    if (n <= 0) return -1;
    spread(n, [&](int32_t i) {
      const int32_t first = (group + i) * chunk_rows;
      work(workspaces_[i], first, std::min(chunk_rows, rows - first));
    });
    reduce(group, n);
    return group + n < chunks ? group + n : -1;
  }
  // The same for all groups, in order.
  template <class Work, class Reduce>
  void sweep(int32_t rows, int32_t chunk_rows, Work&& work, Reduce&& reduce) {
    for (int32_t group = 0; group >= 0;) group = sweep_group(rows, chunk_rows, group, work, reduce);
  }
  // Adds entries [begin, end) of the gradients of the n workers of a group to total, in order, every range of
  // them by another thread. The first chunk of all is taken to have written its part into total itself.
  void reduce(int32_t group, int32_t n, float* total, size_t begin, size_t end);
  template <class Work>
  void sweep(int32_t rows, int32_t chunk_rows, Work&& work) {
    sweep(rows, chunk_rows, work, [](int32_t, int32_t) {});
  }

  // Cuts the next group of chunks of a sweep, one for each of sweep.chunks workspaces.
  void cut(Sweep& sweep, int32_t chunk_rows);
  // work(workspace, chunk) for the chunks of the group.
  template <class Work>
  void each(const Sweep& sweep, Work&& work) {
    spread(sweep.chunks, [&](int32_t i) { work(workspaces_[i], workspaces_[i].chunk); });
  }
  // Where the gradient of a workspace's chunk goes: that of the first of all where the sum is wanted.
  static float* gradient_of(Workspace& workspace, float* total) {
    return workspace.chunk.begins && workspace.chunk.block == 0 ? total : workspace.grad;
  }
  // Adds entries [begin, end) of the gradients of a sweep's group, every range of them by another thread: to
  // their blocks', and these along the tree to total, which after the last group has the whole sum.
  void reduce(Sweep& sweep, float* total, size_t begin, size_t end);

 private:
  int32_t add_group(int32_t n, int32_t blocks, float* total, size_t low, size_t high, int32_t depth) const;

  Ranks ranks_;
  Workspace* workspaces_ = nullptr;
  int32_t count_ = 0, most_sequences_ = 0;
  float* nodes_ = nullptr;  // [levels of the tree over this rank's blocks][num_params]
  size_t num_params_ = 0;
  std::optional<Workers> threads_;
};

}  // namespace rdm

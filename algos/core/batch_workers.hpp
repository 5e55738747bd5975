// Batches cut into chunks of fixed size, several in flight. Chunks are reduced in their order, so sums are
// the same for any number of workers and any schedule: float sums depend on the order of their terms, so the
// cut depends on the batch alone, never on the threads.
#pragma once
#include <memory>
#include <optional>

#include "algos/core/networks.hpp"
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

// Means over listed rows of what the policy as it is now does to them.
struct Surrogate {
  double gain = 0;              // rho (gain + linear)
  double cost[kMaxCosts] = {};  // rho A_c of each limited cost, or its clipped form
  double kl = 0;                // KL(old || now)
  bool finite() const;
};

// Workspace of one chunk in flight.
struct Workspace {
  int32_t rows = 0;
  ActorScratch actor;
  MlpScratch critic;
  float* obs = nullptr;                   // [rows][obs_dim]
  float *out = nullptr, *dout = nullptr;  // [rows][widest output]
  float* grad = nullptr;                  // [num_params]
  BatchSums sums;
  Surrogate surrogate;
};

// One workspace per thread that helps, at most one per chunk.
class BatchWorkers {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params);
  void open(const HostHooks& hooks, int32_t threads) { threads_.emplace(hooks, threads); }

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

  // work(workspace, first, n) for the chunks of [0, rows), then reduce(first chunk, n) for each group of
  // chunks that ran together, in order: chunk `first chunk + i` was done by workspace i.
  template <class Work, class Reduce>
  void sweep(int32_t rows, int32_t chunk_rows, Work&& work, Reduce&& reduce) {
    const int32_t chunks = (rows + chunk_rows - 1) / chunk_rows;
    for (int32_t group = 0; group < chunks; group += count_) {
      const int32_t n = std::min(count_, chunks - group);
      spread(n, [&](int32_t i) {
        const int32_t first = (group + i) * chunk_rows;
        work(workspaces_[i], first, std::min(chunk_rows, rows - first));
      });
      reduce(group, n);
    }
  }
  // Adds entries [begin, end) of the gradients of the n workers of a group to total, in order, every range of
  // them by another thread. The first chunk of all is taken to have written its part into total itself.
  void reduce(int32_t group, int32_t n, float* total, size_t begin, size_t end);
  template <class Work>
  void sweep(int32_t rows, int32_t chunk_rows, Work&& work) {
    sweep(rows, chunk_rows, work, [](int32_t, int32_t) {});
  }

 private:
  Workspace* workspaces_ = nullptr;
  int32_t count_ = 0;
  std::optional<Workers> threads_;
};

}  // namespace rdm

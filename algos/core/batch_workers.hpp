// Batches cut into pieces of fixed size, several in flight. Pieces are folded in their order, so sums are
// the same for any number of lanes and any schedule.
#pragma once
#include <memory>
#include <optional>

#include "algos/core/resolved_config.hpp"
#include "base/workers.hpp"

namespace rdm {

// Sums over the samples of a piece or a batch.
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

// Workspace of one piece in flight.
struct Lane {
  int32_t rows = 0;
  MlpScratch actor, critic;
  float* obs = nullptr;                   // [rows][obs_dim]
  float *out = nullptr, *dout = nullptr;  // [rows][widest output]
  float* grad = nullptr;                  // [num_params]
  BatchSums sums;
  Surrogate surrogate;
};

// One lane per thread that helps, at most one per piece.
class BatchWorkers {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& plan, size_t num_params);
  void open(const HostHooks& hooks, int32_t threads) { workers_.emplace(hooks, threads); }

  int32_t count() const { return count_; }
  const Lane& operator[](int32_t i) const { return lanes_[i]; }

  // body(i) for i in [0, n), spread over the threads. body must not throw.
  template <class Body>
  void spread(int32_t n, Body&& body) {
    if (n == 1 || workers_->width() == 1) {
      for (int32_t i = 0; i < n; ++i) body(i);
      return;
    }
    using Plain = std::remove_reference_t<Body>;
    workers_->run(
        n, [](void* context, int32_t i) { (*static_cast<Plain*>(context))(i); },
        const_cast<void*>(static_cast<const void*>(std::addressof(body))));
  }

  // work(lane, first, n) for the pieces of [0, rows), then fold(first piece, n) for each group of pieces
  // that ran together, in order: piece `first piece + i` was done by lane i.
  template <class Work, class Fold>
  void sweep(int32_t rows, int32_t piece_rows, Work&& work, Fold&& fold) {
    const int32_t pieces = (rows + piece_rows - 1) / piece_rows;
    for (int32_t group = 0; group < pieces; group += count_) {
      const int32_t n = std::min(count_, pieces - group);
      spread(n, [&](int32_t i) {
        const int32_t first = (group + i) * piece_rows;
        work(lanes_[i], first, std::min(piece_rows, rows - first));
      });
      fold(group, n);
    }
  }
  // Adds entries [begin, end) of the gradients of the n lanes of a group to total, in order, every range of
  // them by another thread. The first piece of all is taken to have written its part into total itself.
  void fold(int32_t group, int32_t n, float* total, size_t begin, size_t end);
  template <class Work>
  void sweep(int32_t rows, int32_t piece_rows, Work&& work) {
    sweep(rows, piece_rows, work, [](int32_t, int32_t) {});
  }

 private:
  Lane* lanes_ = nullptr;
  int32_t count_ = 0;
  std::optional<Workers> workers_;
};

}  // namespace rdm

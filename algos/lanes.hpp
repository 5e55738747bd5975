// Batches cut into pieces of fixed size, several in flight. Pieces are folded in their order, so sums are
// the same for any number of lanes and any schedule.
#pragma once
#include "algos/networks.hpp"
#include "base/workers.hpp"

namespace rdm {

// Sums over samples of a piece or a batch.
struct BatchSums {
  double loss = 0, kl = 0, clipped = 0, reward_loss = 0, cost_loss = 0;
  BatchSums& operator+=(const BatchSums& b) {
    loss += b.loss, kl += b.kl, clipped += b.clipped;
    reward_loss += b.reward_loss, cost_loss += b.cost_loss;
    return *this;
  }
};

// Workspace of one piece in flight.
struct Lane {
  int32_t rows = 0;
  MlpScratch actor, critic;
  float* obs = nullptr;                   // [rows][obs_dim]
  float *out = nullptr, *dout = nullptr;  // [rows][widest output]
  float* grad = nullptr;                  // [Networks::size]
  BatchSums sums;
};
Lane carve_lane(Arena& arena, const Plan& plan, size_t num_params);

// body(i) for i in [0, n), spread over the workers. body must not throw.
template <class Body>
void spread(Workers& workers, int32_t n, Body&& body) {
  if (n == 1) {
    body(0);
    return;
  }
  workers.run(
      n, [](void* context, int32_t i) { (*static_cast<std::remove_reference_t<Body>*>(context))(i); }, &body);
}

// work(lane, piece) for all pieces, at most `lanes` at once; then fold(first, n) for each group in order.
template <class Work, class Fold>
void sweep(Workers& workers, int32_t lanes, int32_t pieces, Work&& work, Fold&& fold) {
  for (int32_t first = 0; first < pieces; first += lanes) {
    const int32_t n = std::min(lanes, pieces - first);
    spread(workers, n, [&](int32_t lane) { work(lane, first + lane); });
    fold(first, n);
  }
}

}  // namespace rdm

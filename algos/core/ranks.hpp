// One agent's share of a learner that many processes make together, and the sums that cross worlds.
//
// The worlds of all ranks have numbers: rank r of R has N from r N on. Option `blocks` cuts them all into
// equal blocks of neighbours. What crosses worlds is summed within a block in one order, and over blocks in
// one binary tree: neighbours, then neighbours of these, a last one without a neighbour as it is. A rank has
// blocks / ranks of them, a power of two (or all), hence whole subtrees: it sums these by itself, the
// exchange carries one sum a rank, and every rank adds the rest of the tree. So the bytes follow from the
// number of blocks and not from that of ranks; with one block they are those of a learner without ranks.
//
//   act, record  moments of observations, rewards, costs (collector)
//   update       ended episodes, valid rows, advantages' means, gradients of minibatches, surrogates and
//                Fisher products, the report; at the end hashes of what was learned, which must agree
//   save         each rank's rows, so that all write the same file
//
// The parameters, their optimisers, statistics, multipliers and schedules are the same on each rank, moved by
// the same numbers; rows, noise and running episodes are its own. Each message begins with the number of the
// exchange and whether its rank was cancelled, which cancels all of them at the same place. Before the first
// one they compare what they were set up with.
#pragma once
#include <array>

#include "algos/core/rank_setup.hpp"
#include "algos/core/resolved_config.hpp"
#include "base/arena.hpp"
#include "base/cancel.hpp"

namespace rdm {

class Ranks {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params);
  void open(CancelFlag& cancel) { cancel_ = &cancel, cancel.share(!alone()); }

  bool alone() const { return hooks_.count == 1; }
  int32_t rank() const { return hooks_.rank; }
  int32_t count() const { return hooks_.count; }
  int32_t blocks() const { return blocks_; }  // of this rank
  int32_t first_block() const { return hooks_.rank * blocks_; }
  int32_t block_envs() const { return block_envs_; }

  // pair(i, i + k) for the nodes of the tree over `leaves` ones, each of which stands where its first leaf
  // did.
  template <class Pair>
  static void tree(int32_t leaves, Pair&& pair) {
    for (int32_t k = 1; k < leaves; k *= 2)
      for (int32_t i = 0; i + k < leaves; i += 2 * k) pair(i, i + k);
  }

  // What all ranks give, in their order: all [count()][bytes]; mine may be its place in there.
  void gather(const void* mine, size_t bytes, void* all);
  int64_t total(int64_t mine);
  // x [n] and y [m] become their sums over ranks; m <= kFew.
  void sum(float* x, size_t n, double* y, size_t m);
  static constexpr size_t kFew = 32;
  // x [n] becomes what merge(double* a, const double* b) makes of the ranks' ones, in the tree; n <= most().
  template <class Merge>
  void fold(double* x, size_t n, Merge&& merge);
  // Sums over blocks: leaf(b, out) gives the N numbers of block b of this rank.
  template <size_t N, class Leaf>
  std::array<double, N> sum(Leaf&& leaf);
  // All ranks are at one place again, as they have loaded one state.
  void restart() { exchanges_ = 0; }
  // The pool that this rank's rollout steps, before the first exchange.
  void set_pool(uint64_t seed, int32_t autoreset, uint64_t options) {
    setup_.set_pool(seed, autoreset, options);
  }
  // Error(kState) naming the first rank whose hash most others do not have.
  void agree(uint64_t hash);

  // [blocks()][kFew], for the caller's leaves.
  double* leaves() const { return leaves_; }

 private:
  struct Head {
    uint64_t exchange;
    int64_t cancelled;
  };
  unsigned char* body() const { return mine_ + sizeof(Head); }
  const unsigned char* body_of(int32_t rank, size_t bytes) const {
    return all_ + static_cast<size_t>(rank) * (sizeof(Head) + bytes) + sizeof(Head);
  }
  void meet();
  void begin(Head& head);
  void look(const void* message, int32_t rank, Head& head) const;
  void heard(int32_t code) const;
  void end(const Head& head) const;
  // body() [bytes] goes out; afterwards body_of() has all.
  void exchange(size_t bytes);
  void sum_by_gather(float* x, size_t n, double* y, size_t m);
  void sum_by_swap(float* x, size_t n, double* y, size_t m);

  RankHooks hooks_;
  CancelFlag* cancel_ = nullptr;
  int32_t blocks_ = 1, block_envs_ = 1;
  size_t piece_ = 0;  // bytes of a body, at most
  unsigned char *mine_ = nullptr, *all_ = nullptr;
  double* leaves_ = nullptr;
  uint64_t exchanges_ = 0;
  RankSetup setup_;
  bool met_ = false;
};

template <class Merge>
void Ranks::fold(double* x, size_t n, Merge&& merge) {
  if (alone()) return;
  const size_t bytes = n * sizeof(double);
  std::memcpy(body(), x, bytes);
  exchange(bytes);
  // Bodies stand at multiples of 8 bytes, as heads and doubles are.
  const auto node = [&](int32_t r) {
    return reinterpret_cast<double*>(const_cast<unsigned char*>(body_of(r, bytes)));
  };
  tree(count(), [&](int32_t a, int32_t b) { merge(node(a), static_cast<const double*>(node(b))); });
  std::memcpy(x, node(0), bytes);
}

template <size_t N, class Leaf>
std::array<double, N> Ranks::sum(Leaf&& leaf) {
  static_assert(N <= kFew);
  const auto add = [](double* a, const double* b) {
    for (size_t k = 0; k < N; ++k) a[k] += b[k];
  };
  for (int32_t b = 0; b < blocks_; ++b) leaf(b, leaves_ + static_cast<size_t>(b) * N);
  tree(blocks_, [&](int32_t a, int32_t b) {
    add(leaves_ + static_cast<size_t>(a) * N, leaves_ + static_cast<size_t>(b) * N);
  });
  fold(leaves_, N, add);
  std::array<double, N> out;
  std::copy_n(leaves_, N, out.begin());
  return out;
}

}  // namespace rdm

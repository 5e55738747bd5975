#include "algos/core/ranks.hpp"

#include <cstring>

namespace rdm {
namespace {

constexpr size_t kPiece = size_t{1} << 19;  // bytes of a message, at most: memory is that for each rank
constexpr size_t kLeast = size_t{1} << 16;

void add(float* a, const float* b, size_t n) {
  for (size_t i = 0; i < n; ++i) a[i] += b[i];
}
void add(double* a, const double* b, size_t n) {
  for (size_t i = 0; i < n; ++i) a[i] += b[i];
}

}  // namespace

void Ranks::carve(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params) {
  hooks_ = resolved.config.ranks;
  blocks_ = resolved.blocks;
  block_envs_ = resolved.config.num_envs / blocks_;
  leaves_ = arena.make<double>(static_cast<size_t>(blocks_) * kFew);
  if (alone()) return;
  setup_.carve(arena, resolved);
  // Statistics go in one piece, whatever their width.
  const size_t moments = (1 + 2 * std::max(resolved.obs_dim(), size_t{kMaxCosts})) * sizeof(double);
  const size_t sums = (num_params + 2 * static_cast<size_t>(count())) * sizeof(float) + kFew * sizeof(double);
  piece_ = std::max({kLeast, moments, std::min(kPiece, sums)}) / 8 * 8;
  const size_t message = sizeof(Head) + piece_;
  mine_ = arena.make<unsigned char>(message);
  all_ = arena.make<unsigned char>(message * static_cast<size_t>(count()));
}

// Exchange 0.
void Ranks::meet() {
  if (met_) return;
  heard(hooks_.gather(hooks_.user, setup_.mine(), RankSetup::kBytes, setup_.all()));
  setup_.compare();
  met_ = true;
}

void Ranks::begin(Head& head) {
  meet();
  head = {++exchanges_, cancel_->take() ? 1 : 0};
  std::memcpy(mine_, &head, sizeof head);
}

void Ranks::heard(int32_t code) const {
  if (code != 0)
    fail(Code::kCancelled, "ranks: exchange %llu of rank %d failed: the host's hook returned %d",
         static_cast<unsigned long long>(exchanges_), rank(), code);
}

// What a message says beside its body; a cancel that one has heard of is everyone's.
void Ranks::look(const void* message, int32_t rank, Head& head) const {
  Head theirs;
  std::memcpy(&theirs, message, sizeof theirs);
  if (theirs.exchange != head.exchange)
    fail(Code::kState, "ranks: rank %d is at exchange %llu, but this one (%d) is at %llu", rank,
         static_cast<unsigned long long>(theirs.exchange), this->rank(),
         static_cast<unsigned long long>(head.exchange));
  head.cancelled |= theirs.cancelled;
}

void Ranks::end(const Head& head) const {
  if (head.cancelled) fail(Code::kCancelled, "cancelled by the host of one of the ranks");
}

void Ranks::exchange(size_t bytes) {
  Head head;
  begin(head);
  const size_t message = sizeof head + bytes;
  heard(hooks_.gather(hooks_.user, mine_, message, all_));
  for (int32_t r = 0; r < count(); ++r) look(all_ + static_cast<size_t>(r) * message, r, head);
  end(head);
}

void Ranks::gather(const void* mine, size_t bytes, void* all) {
  const auto* from = static_cast<const unsigned char*>(mine);
  auto* to = static_cast<unsigned char*>(all);
  if (alone()) {
    if (bytes) std::memmove(to, from, bytes);
    return;
  }
  for (size_t at = 0; at < bytes; at += piece_) {
    const size_t n = std::min(piece_, bytes - at);
    std::memcpy(body(), from + at, n);
    exchange(n);
    for (int32_t r = 0; r < count(); ++r)
      std::memcpy(to + static_cast<size_t>(r) * bytes + at, body_of(r, n), n);
  }
}

int64_t Ranks::total(int64_t mine) {
  if (alone()) return mine;
  std::memcpy(body(), &mine, sizeof mine);
  exchange(sizeof mine);
  int64_t sum = 0;
  for (int32_t r = 0; r < count(); ++r) {
    int64_t theirs;
    std::memcpy(&theirs, body_of(r, sizeof theirs), sizeof theirs);
    sum += theirs;
  }
  return sum;
}

void Ranks::sum(float* x, size_t n, double* y, size_t m) {
  if (alone()) return;
  const bool whole = (count() & (count() - 1)) == 0;
  do {
    const size_t step = 2 * static_cast<size_t>(count());
    const size_t most = (piece_ - m * sizeof(double)) / sizeof(float) / step * step, now = std::min(n, most);
    if (whole && hooks_.swap)
      sum_by_swap(x, now, y, m);
    else
      sum_by_gather(x, now, y, m);
    x += now, n -= now, m = 0;
  } while (n > 0);
}

// Each rank hears all others and adds the whole tree.
void Ranks::sum_by_gather(float* x, size_t n, double* y, size_t m) {
  const size_t few = m * sizeof(double), bytes = few + (n + 1) / 2 * sizeof(double);
  std::memset(body() + bytes - sizeof(double), 0, sizeof(double));
  if (m) std::memcpy(body(), y, few);
  if (n) std::memcpy(body() + few, x, n * sizeof(float));
  exchange(bytes);
  const auto node = [&](int32_t r) { return const_cast<unsigned char*>(body_of(r, bytes)); };
  tree(count(), [&](int32_t a, int32_t b) {
    add(reinterpret_cast<double*>(node(a)), reinterpret_cast<const double*>(node(b)), m);
    add(reinterpret_cast<float*>(node(a) + few), reinterpret_cast<const float*>(node(b) + few), n);
  });
  if (m) std::memcpy(y, node(0), few);
  if (n) std::memcpy(x, node(0) + few, n * sizeof(float));
}

// A level of the tree at a time: of what a rank still sums its partner takes one half and gives of the other,
// so that in the end each has a part of the whole sum; then they give these back, the last partner first.
// Twice the vector goes out, for any number of ranks. y is small: it goes along whole.
void Ranks::sum_by_swap(float* x, size_t n, double* y, size_t m) {
  const size_t few = m * sizeof(double), parts = static_cast<size_t>(count());
  const size_t padded = (n + parts - 1) / parts * parts;
  Head head;
  begin(head);
  float* const own = reinterpret_cast<float*>(body() + few);
  if (m) std::memcpy(body(), y, few);
  if (n) std::memcpy(own, x, n * sizeof(float));
  std::fill(own + n, own + padded, 0.0f);
  unsigned char* const out = all_ + sizeof(Head) + piece_;
  const auto swap = [&](int32_t partner, size_t first, const float* part, size_t length) {
    std::memcpy(out, &head, sizeof head);
    std::memcpy(out + sizeof head, body(), first);
    if (length) std::memcpy(out + sizeof head + first, part, length * sizeof(float));
    heard(hooks_.swap(hooks_.user, partner, out, sizeof head + first + length * sizeof(float), all_));
    look(all_, partner, head);
    return all_ + sizeof head;
  };
  size_t begins = 0, length = padded;
  for (int32_t k = 1; k < count(); k *= 2) {
    length /= 2;
    const bool upper = rank() & k;
    const float* const given = own + begins + (upper ? 0 : length);
    begins += upper ? length : 0;
    const unsigned char* const theirs = swap(rank() ^ k, few, given, length);
    // a + b is b + a, bit for bit
    add(reinterpret_cast<double*>(body()), reinterpret_cast<const double*>(theirs), m);
    add(own + begins, reinterpret_cast<const float*>(theirs + few), length);
  }
  for (int32_t k = count() / 2; k > 0; k /= 2, length *= 2) {
    const unsigned char* const theirs = swap(rank() ^ k, 0, own + begins, length);
    const bool upper = rank() & k;
    const size_t at = upper ? begins - length : begins + length;
    if (length) std::memcpy(own + at, theirs, length * sizeof(float));
    begins = std::min(begins, at);
  }
  end(head);
  if (m) std::memcpy(y, body(), few);
  if (n) std::memcpy(x, own, n * sizeof(float));
}

void Ranks::agree(uint64_t hash) {
  if (alone()) return;
  std::memcpy(body(), &hash, sizeof hash);
  exchange(sizeof hash);
  const auto of = [&](int32_t r) {
    uint64_t theirs;
    std::memcpy(&theirs, body_of(r, sizeof theirs), sizeof theirs);
    return theirs;
  };
  int32_t most = 0, held = 0;  // the rank whose hash most have; of as many, the lowest one
  for (int32_t r = 0; r < count(); ++r) {
    int32_t same = 0;
    for (int32_t other = 0; other < count(); ++other) same += of(other) == of(r);
    if (same > held) most = r, held = same;
  }
  for (int32_t r = 0; r < count(); ++r)
    if (of(r) != of(most))
      fail(Code::kState,
           "ranks: rank %d has other weights: its hash is %016llx, that of %d of %d ranks is %016llx", r,
           static_cast<unsigned long long>(of(r)), held, count(), static_cast<unsigned long long>(of(most)));
}

}  // namespace rdm

// A fixed pool of threads that runs numbered bodies. Zero threads is the default and a full citizen.
//
// Body i always runs on thread i mod T, so data stay with the core that used them last; no result may
// depend on it.
#pragma once
#include <atomic>
#include <cstdint>

#include "base/host.hpp"

namespace rdm {

// Body of a piece, the items [begin, end), worked on with what belongs to part `part`.
using PieceBody = void (*)(void* context, int32_t part, int32_t begin, int32_t end);

class Workers {
 public:
  // threads 0 or 1: the caller's own. T > 1: T - 1 threads are started, the caller is the T-th. With a
  // host's parallel hook no thread is started and `threads` only says how far work should be split.
  Workers(const HostHooks& hooks, int32_t threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  // Runs body(context, i) once for every i in [0, n) and returns when all are done. Bodies must not
  // throw. Between rounds threads look out for the next one for a moment, then sleep. In a forked child of a
  // process that had started threads: Error(kState). No heap use.
  void run(int32_t n, ParallelBody body, void* context);

  // Runs body over [0, n), cut into `parts` (at most width(); part p begins at part_begin) and these into
  // pieces of `grain` items: each part's own pieces in order, and then what other parts have left, so that
  // parts of unequal work end together. No two pieces run for one part at a time. No heap use.
  void run_pieces(int32_t n, int32_t parts, int32_t grain, PieceBody body, void* context);
  static int32_t part_begin(int32_t n, int32_t parts, int32_t part) {
    return static_cast<int32_t>(int64_t{n} * part / parts);
  }

  int32_t width() const { return width_; }
  // Bytes that the constructor takes from the alloc hook.
  static size_t memory(const HostHooks& hooks, int32_t threads);

 private:
  struct Shared;
  struct alignas(64) Cursor {
    std::atomic<int32_t> next;  // item of the part that nobody has taken
  };
  HostHooks hooks_;
  int32_t width_ = 1;
  Vector<Cursor> cursors_;  // [width] of the parts; none for one thread
  Shared* shared_ = nullptr;
};

}  // namespace rdm

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

  // Runs body(context, i) once for every i in [0, n), n <= kMost, and returns when all are done. Bodies must
  // not throw. Between rounds threads look out for the next one for a moment, then sleep. Error(kState) in a
  // forked child of a process that had started threads, and where a host's parallel hook did not do what it
  // should: some bodies were not run then. No heap use.
  void run(int32_t n, ParallelBody body, void* context);

  // Runs body over [0, n), cut into `parts` (at most width(); part p begins at part_begin) and these into
  // pieces of `grain` items: each part's own pieces in order, and then what other parts have left, so that
  // parts of unequal work end together. No two pieces run for one part at a time. No heap use.
  void run_pieces(int32_t n, int32_t parts, int32_t grain, PieceBody body, void* context);
  static int32_t part_begin(int32_t n, int32_t parts, int32_t part) {
    return static_cast<int32_t>(int64_t{n} * part / parts);
  }

  int32_t width() const { return width_; }
  static constexpr int32_t kMost = 256;
  // Bytes that the constructor takes from the alloc hook, call by call; their sum.
  struct Taken {
    size_t bytes[3];
    int32_t count;
  };
  static Taken takes(const HostHooks& hooks, int32_t threads);
  static size_t memory(const HostHooks& hooks, int32_t threads);

 private:
  struct Shared;
  struct alignas(64) Cursor {
    std::atomic<int32_t> next;  // item of the part that nobody has taken
  };
  // A round over a host's parallel hook, which is not trusted: each index runs once, none after the hook has
  // returned, whatever it calls and when.
  struct Round {
    static void call(void* round, int32_t i);
    int32_t close();  // bodies that still run when the hook returns; waits for them
    int32_t ran() const;

    int32_t n = 0;
    ParallelBody body = nullptr;
    void* context = nullptr;
    std::atomic<uint64_t> taken[kMost / 64] = {};      // a bit for each index
    std::atomic<int32_t> again = -1, outside = kNone;  // indices that it should not have run
    std::atomic<int64_t> inside = 0;                   // calls within; kOpen above them
    static constexpr int64_t kOpen = int64_t{1} << 32;
    static constexpr int32_t kNone = INT32_MIN;
  };
  void run_by_hook(int32_t n, ParallelBody body, void* context);

  HostHooks hooks_;
  int32_t width_ = 1;
  Vector<Cursor> cursors_;  // [width] of the parts; none for one thread
  Shared* shared_ = nullptr;
  Round round_;
};

}  // namespace rdm

#include "base/workers.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "base/error.hpp"
#include "base/fpmode.hpp"

namespace rdm {
namespace {

// A thread that sleeps takes longer to wake up than many rounds last, so one looks for a while first. It
// gives its core away at every look: whoever else wants it (another handle's threads, say) has it.
constexpr std::chrono::microseconds kPatience(60);

template <class F>
bool soon(F&& happened) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  do {
    if (happened()) return true;
    std::this_thread::yield();
  } while (std::chrono::steady_clock::now() < until);
  return happened();
}

}  // namespace

struct Workers::Shared {
  explicit Shared(int32_t count) : pid(getpid()), threads(static_cast<size_t>(count)) {}

  void loop(int32_t self, int32_t width) {
    uint64_t seen = 0;
    const auto called = [&] { return round.load(std::memory_order_acquire) != seen; };
    for (;;) {
      if (!soon(called)) {
        std::unique_lock lock(mutex);
        start.wait(lock, called);
      }
      if (stop) return;
      seen = round.load(std::memory_order_relaxed);
      share(self, width);
      if (running.fetch_sub(1, std::memory_order_acq_rel) > 1) continue;
      const std::lock_guard lock(mutex);
      finish.notify_one();
    }
  }
  void share(int32_t self, int32_t width) const {
    const FpMode mode;
    for (int32_t i = self; i < n; i += width) body(context, i);
  }
  void end() {
    {
      const std::lock_guard lock(mutex);
      stop = true;
      round.fetch_add(1, std::memory_order_release);
    }
    start.notify_all();
    for (auto& t : threads)
      if (t.joinable()) t.join();
  }

  pid_t pid;
  std::mutex mutex;
  std::condition_variable start, finish;
  // What a round is stands still while it runs: `round` and `running` hand it over and back.
  std::atomic<uint64_t> round = 0;
  std::atomic<int32_t> running = 0;
  int32_t n = 0;
  bool stop = false;
  ParallelBody body = nullptr;
  void* context = nullptr;
  Vector<std::thread> threads;
};

Workers::Workers(const HostHooks& hooks, int32_t threads)
    : hooks_(hooks),
      width_(threads > 1 ? threads : 1),
      cursors_(threads > 1 ? static_cast<size_t>(threads) : 0) {
  if (hooks_.parallel || width_ == 1) return;
  shared_ = host_new<Shared>(hooks_, width_ - 1);
  try {
    for (int32_t i = 1; i < width_; ++i)
      shared_->threads[static_cast<size_t>(i - 1)] =
          std::thread([s = shared_, i, w = width_] { s->loop(i, w); });
  } catch (const std::exception& e) {
    // std::system_error: no thread; std::bad_alloc: no memory for one's state
    shared_->end();
    host_delete(hooks_, shared_);
    fail(Code::kMemory, "num_threads: could not start %d threads: %s", threads, e.what());
  }
}

Workers::Taken Workers::takes(const HostHooks& hooks, int32_t threads) {
  const auto n = static_cast<size_t>(threads);
  if (threads <= 1) return {{}, 0};
  return {{n * sizeof(Cursor), sizeof(Shared), (n - 1) * sizeof(std::thread)}, hooks.parallel ? 1 : 3};
}

size_t Workers::memory(const HostHooks& hooks, int32_t threads) {
  const Taken taken = takes(hooks, threads);
  size_t sum = 0;
  for (int32_t i = 0; i < taken.count; ++i) sum += taken.bytes[i];
  return sum;
}

Workers::~Workers() {
  if (!shared_) return;
  if (shared_->pid == getpid()) {
    shared_->end();
    host_delete(hooks_, shared_);
  }  // in a forked child the threads do not exist: their memory is left alone
}

void Workers::Round::call(void* round, int32_t i) {
  Round& r = *static_cast<Round*>(round);
  if (r.inside.fetch_add(1, std::memory_order_acq_rel) & kOpen) {
    if (i < 0 || i >= r.n)
      r.outside.store(i == kNone ? -1 : i, std::memory_order_relaxed);
    else if (const uint64_t bit = uint64_t{1} << i % 64;
             r.taken[i / 64].fetch_or(bit, std::memory_order_relaxed) & bit)
      r.again.store(i, std::memory_order_relaxed);
    else {
      const FpMode mode;
      r.body(r.context, i);
    }
  }
  r.inside.fetch_sub(1, std::memory_order_release);
}

int32_t Workers::Round::close() {
  const int64_t left = inside.fetch_and(~kOpen, std::memory_order_acq_rel) & ~kOpen;
  while (inside.load(std::memory_order_acquire) != 0) std::this_thread::yield();
  return static_cast<int32_t>(left);
}

int32_t Workers::Round::ran() const {
  int32_t count = 0;
  for (const auto& word : taken)
    for (uint64_t bits = word.load(std::memory_order_relaxed); bits; bits &= bits - 1) ++count;
  return count;
}

void Workers::run_by_hook(int32_t n, ParallelBody body, void* context) {
  if (n > kMost) fail(Code::kInternal, "workers: there are %d pieces, but at most %d are allowed", n, kMost);
  Round& r = round_;
  r.n = n, r.body = body, r.context = context;
  for (auto& word : r.taken) word.store(0, std::memory_order_relaxed);
  r.again = -1, r.outside = Round::kNone;
  r.inside.fetch_or(Round::kOpen, std::memory_order_release);
  bool thrown = false;
  try {
    hooks_.parallel(hooks_.user, n, Round::call, &r);
  } catch (...) {
    thrown = true;
  }
  const int32_t left = r.close(), ran = r.ran();
  if (thrown) fail(Code::kArgument, "the parallel hook threw an exception");
  if (left > 0)
    fail(Code::kState, "the parallel hook returned while %d of %d pieces were still running", left, n);
  if (ran < n) fail(Code::kState, "the parallel hook ran %d of %d pieces", ran, n);
  if (r.again >= 0) fail(Code::kState, "the parallel hook ran index %d twice", r.again.load());
  if (r.outside != Round::kNone)
    fail(Code::kState, "the parallel hook ran index %d, which is outside [0, %d)", r.outside.load(), n);
}

void Workers::run(int32_t n, ParallelBody body, void* context) {
  if (hooks_.parallel) return run_by_hook(n, body, context);
  if (!shared_) {
    for (int32_t i = 0; i < n; ++i) body(context, i);
    return;
  }
  if (shared_->pid != getpid())
    fail(Code::kState, "worker threads do not survive fork: create the handle in the child process");
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->n = n;
    shared_->body = body;
    shared_->context = context;
    shared_->running.store(width_ - 1, std::memory_order_relaxed);
    shared_->round.fetch_add(1, std::memory_order_release);
  }
  shared_->start.notify_all();
  shared_->share(0, width_);
  const auto done = [&] { return shared_->running.load(std::memory_order_acquire) == 0; };
  if (soon(done)) return;
  std::unique_lock lock(shared_->mutex);
  shared_->finish.wait(lock, done);
}

void Workers::run_pieces(int32_t n, int32_t parts, int32_t grain, PieceBody body, void* context) {
  if (parts == 1) {
    const FpMode mode;
    body(context, 0, 0, n);
    return;
  }
  struct Call {
    Cursor* cursors;
    int32_t n, parts, grain;
    PieceBody body;
    void* context;
  } call{cursors_.data(), n, parts, grain, body, context};
  for (int32_t p = 0; p < parts; ++p)
    cursors_[static_cast<size_t>(p)].next.store(part_begin(n, parts, p), std::memory_order_relaxed);
  run(
      parts,
      [](void* argument, int32_t self) {
        const Call& c = *static_cast<Call*>(argument);
        for (int32_t i = 0; i < c.parts; ++i) {
          const int32_t part = (self + i) % c.parts, end = part_begin(c.n, c.parts, part + 1);
          std::atomic<int32_t>& next = c.cursors[part].next;
          while (next.load(std::memory_order_relaxed) < end) {
            const int32_t begin = next.fetch_add(c.grain, std::memory_order_relaxed);
            if (begin >= end) break;
            c.body(c.context, self, begin, begin + c.grain < end ? begin + c.grain : end);
          }
        }
      },
      &call);
}

}  // namespace rdm

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

size_t Workers::memory(const HostHooks& hooks, int32_t threads) {
  if (threads <= 1) return 0;
  const size_t cursors = static_cast<size_t>(threads) * sizeof(Cursor);
  if (hooks.parallel) return cursors;
  return cursors + sizeof(Shared) + static_cast<size_t>(threads - 1) * sizeof(std::thread);
}

Workers::~Workers() {
  if (!shared_) return;
  if (shared_->pid == getpid()) {
    shared_->end();
    host_delete(hooks_, shared_);
  }  // in a forked child the threads do not exist: their memory is left alone
}

void Workers::run(int32_t n, ParallelBody body, void* context) {
  if (hooks_.parallel) {
    struct Wrapped {
      ParallelBody body;
      void* context;
    } wrapped{body, context};
    hooks_.parallel(
        hooks_.user, n,
        [](void* c, int32_t i) {
          const FpMode mode;
          const auto* w = static_cast<Wrapped*>(c);
          w->body(w->context, i);
        },
        &wrapped);
    return;
  }
  if (!shared_) {
    for (int32_t i = 0; i < n; ++i) body(context, i);
    return;
  }
  if (shared_->pid != getpid())
    fail(Code::kState, "worker threads do not survive fork: make the handle in the child");
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

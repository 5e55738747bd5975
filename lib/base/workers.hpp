// A fixed pool of threads that runs numbered bodies. Zero threads is the default and a full citizen.
//
// Body i always runs on thread i mod T, so data stay with the core that used them last; no result may
// depend on it.
#pragma once
#include <cstdint>

#include "base/host.hpp"

namespace rdm {

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

  int32_t width() const { return width_; }
  // Bytes that the constructor takes from the alloc hook.
  static size_t memory(const HostHooks& hooks, int32_t threads);

 private:
  struct Shared;
  HostHooks hooks_;
  int32_t width_ = 1;
  Shared* shared_ = nullptr;
};

}  // namespace rdm

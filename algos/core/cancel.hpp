// A host's wish that a long call stop, heard between minibatches and between products of the trust region.
#pragma once
#include <atomic>

#include "base/error.hpp"

namespace rdm {

class CancelFlag {
 public:
  void set() { set_.store(true, std::memory_order_relaxed); }  // async-signal-safe
  // Error(kCancelled) once after set().
  void check() {
    if (set_.exchange(false, std::memory_order_relaxed)) fail(Code::kCancelled, "cancelled by the host");
  }

 private:
  std::atomic<bool> set_{false};
};

}  // namespace rdm

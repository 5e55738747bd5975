// A host's wish that a long call end, heard between minibatches, products of the trust region, steps of a plan.
#pragma once
#include <atomic>

#include "base/error.hpp"

namespace rdm {

class CancelFlag {
 public:
  void set() { set_.store(true, std::memory_order_relaxed); }  // async-signal-safe
  // Error(kCancelled) once after set(); not where the flag is shared.
  void check() {
    if (!shared_ && take()) fail(Code::kCancelled, "cancelled by the host");
  }
  // Whether it was set; it is not any more.
  bool take() { return set_.exchange(false, std::memory_order_relaxed); }
  // Among ranks it is heard in their exchanges alone (ranks.hpp), so that all of them stop at one place.
  void share(bool shared) { shared_ = shared; }

 private:
  std::atomic<bool> set_{false};
  bool shared_ = false;
};

}  // namespace rdm

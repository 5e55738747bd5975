// The floating-point mode of the library: nearest rounding, no traps, denormals flushed to zero.
//
// Every entry from a host and every body that a worker runs sets it and puts the host's back, so results
// do not depend on what the host does with its own control word.
#pragma once
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace rdm {

class FpMode {
 public:
#if defined(__SSE2__)
  FpMode() : saved_(_mm_getcsr()) {
    _mm_setcsr(0x1F80u | 0x8040u);
  }
  ~FpMode() {
    _mm_setcsr(saved_);
  }

 private:
  unsigned saved_;
#else
  FpMode() {}
#endif
  FpMode(const FpMode&) = delete;
  FpMode& operator=(const FpMode&) = delete;
};

}  // namespace rdm

// The floating-point mode of the library: nearest rounding, no traps, denormals flushed to zero.
//
// Every entry from a host and every body that a worker runs sets it and puts the host's back, so results
// do not depend on what the host does with its own control word. On x86-64 that is MXCSR: 0x1F80 masks all
// exceptions and rounds to nearest, 0x8040 flushes results (bit 15) and operands (bit 6). On AArch64 it is
// FPCR: bit 24 (FZ) flushes both, traps and the rounding mode are 0. Elsewhere nothing is set: results are
// the same as long as no denormal number comes up.
#pragma once
#if defined(__FAST_MATH__)
#error "-ffast-math and -Ofast give other results on every machine and compiler: build without them"
#endif

#if defined(__SSE2__)
#include <xmmintrin.h>
#elif defined(__aarch64__)
#include <cstdint>
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
#elif defined(__aarch64__)
  FpMode() {
    asm volatile("mrs %0, fpcr" : "=r"(saved_) : : "memory");
    asm volatile("msr fpcr, %0" : : "r"(uint64_t{1} << 24) : "memory");
  }
  ~FpMode() {
    asm volatile("msr fpcr, %0" : : "r"(saved_) : "memory");
  }

 private:
  uint64_t saved_;
#else
  FpMode() {}
#endif
  FpMode(const FpMode&) = delete;
  FpMode& operator=(const FpMode&) = delete;
};

}  // namespace rdm

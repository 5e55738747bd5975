// Steppers for x86-64-v4 (AVX-512), with sixteen lanes beside the others. The pragma stands after every
// header that has code in it, as in stepper_v3.cpp. These sets cannot be had without fused multiply-add:
// contraction is off, and so is what vectorises straight-line code (CMakeLists.txt), which GCC 12 lets fuse
// alternating sums and differences all the same.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/cpu.hpp"
#include "physics/articulated/stepper.hpp"
#include "physics/model/drive.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,avx512f,avx512bw,avx512dq,avx512vl"))), \
                             apply_to = function)
#else
#pragma GCC target("avx2,avx512f,avx512bw,avx512dq,avx512vl")
#endif
#define RDM_SIMD_AVX
#define RDM_SIMD_AVX512

#include "physics/articulated/stepper.inl"

namespace rdm {
StepperTable steppers_v4() {
  return stepper_table(kV4Isa);
}
}  // namespace rdm

#if defined(__clang__)
#pragma clang attribute pop
#endif
#else
namespace rdm {
StepperTable steppers_v4() {
  return {};
}
}  // namespace rdm
#endif

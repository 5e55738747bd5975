// Steppers for x86-64-v3 (AVX2). The pragma stands after every header that has code in it, so that no shared
// inline function is compiled with it. Fused multiply-add stays out: it would change the bits.
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
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define RDM_SIMD_AVX

#include "physics/articulated/stepper.inl"

namespace rdm {
StepperTable steppers_v3() {
  return stepper_table(kV3Isa);
}
}  // namespace rdm

#if defined(__clang__)
#pragma clang attribute pop
#endif
#else
namespace rdm {
StepperTable steppers_v3() {
  return {};
}
}  // namespace rdm
#endif

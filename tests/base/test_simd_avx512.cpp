// Sixteen lanes with AVX-512: the same numbers as without it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/cpu.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,avx512f,avx512bw,avx512dq,avx512vl"))), \
                             apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,avx512f,avx512bw,avx512dq,avx512vl")
#endif
#define RDM_SIMD_AVX
#define RDM_SIMD_AVX512

#include "base/simd.hpp"

namespace {
constexpr int kLanes = 16;
}
#include "simd_calls.inl"

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#include "simd_checks.hpp"

namespace rdm {
namespace {

class SimdAvx512 : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!cpu().v4) GTEST_SKIP() << "this processor has no AVX-512";
  }
};

TEST_F(SimdAvx512, GathersRowsIntoColumns) {
  check_columns();
}
TEST_F(SimdAvx512, ScattersColumnsIntoTheRowsThereAre) {
  check_rows();
}
TEST_F(SimdAvx512, RootsAndMasksAreThoseOfEachLane) {
  check_roots_and_masks();
}

}  // namespace
}  // namespace rdm
#endif

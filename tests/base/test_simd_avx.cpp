// Eight lanes with AVX: the same numbers as without it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/cpu.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
#define RDM_SIMD_AVX

#include "base/simd.hpp"

namespace {
constexpr int kLanes = 8;
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

class SimdAvx : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!cpu().avx2) GTEST_SKIP() << "this processor has no AVX2";
  }
};

TEST_F(SimdAvx, GathersRowsIntoColumns) {
  check_columns();
}
TEST_F(SimdAvx, ScattersColumnsIntoTheRowsThereAre) {
  check_rows();
}
TEST_F(SimdAvx, RootsAndMasksAreThoseOfEachLane) {
  check_roots_and_masks();
}

}  // namespace
}  // namespace rdm
#endif

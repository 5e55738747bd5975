// What holds for Simd<float, kLanes> (simd_calls.inl), whatever it is compiled for: the same numbers as lane
// by lane.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace rdm {
namespace {

inline float number(int row, int column) {
  return 1.0f + 16.0f * static_cast<float>(row) + static_cast<float>(column);
}

inline void check_columns() {
  float rows[kLanes][kMost];
  const float* from[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    from[l] = rows[l];
    for (int i = 0; i < kMost; ++i) rows[l][i] = number(l, i);
  }
  for (int count = 0; count <= kMost; ++count) {
    float out[kMost][kLanes];
    columns(from, count, out);
    for (int i = 0; i < kMost; ++i)
      for (int l = 0; l < kLanes; ++l) EXPECT_EQ(out[i][l], i < count ? number(l, i) : 0) << count;
  }
}

inline void check_rows() {
  float from[kMost][kLanes];
  for (int i = 0; i < kMost; ++i)
    for (int l = 0; l < kLanes; ++l) from[i][l] = number(l, i);
  for (int count = 0; count <= kMost; ++count)
    for (int lanes = 0; lanes <= kLanes; ++lanes) {
      float rows[kLanes][kMost] = {};
      float* to[kLanes];
      for (int l = 0; l < kLanes; ++l) to[l] = l < lanes ? rows[l] : nullptr;
      rows_of(from, count, lanes, to);
      for (int l = 0; l < kLanes; ++l)
        for (int i = 0; i < kMost; ++i)
          EXPECT_EQ(rows[l][i], l < lanes && i < count ? number(l, i) : 0) << count << ", " << lanes;
    }
}

inline void check_roots_and_masks() {
  constexpr float kSome[8] = {0, 2, 3, 1e-30f, 1e30f, 5, 7, 0.1f};
  float from[kLanes], out[kLanes];
  for (int l = 0; l < kLanes; ++l) from[l] = kSome[l % 8] * static_cast<float>(1 + l / 8);
  roots(from, out);
  for (int l = 0; l < kLanes; ++l) EXPECT_EQ(out[l], std::sqrt(from[l]));
  for (int l = 0; l < kLanes; ++l) {
    float one[kLanes];
    for (float& x : one) x = 1;
    one[l] = -1;
    EXPECT_EQ(bits_below(one, 0), 1u << l);
  }
}

}  // namespace
}  // namespace rdm

// How far a row is from the rows that were learned on, by what is known of each entry alone.
//
//   z_j = (x_j - mean_j) / deviation_j     of the entries that a policy sees
//   novelty = max(rms(z) / usual.rms, max |z| / usual.largest)
//
// The root mean square tells that much of a row is unusual, the largest that one entry is. Mean and deviation
// are those of the observation normaliser (a deviation is at least 0.01, so an entry that never moved counts
// too). usual: the rms, and the largest, that one row in a thousand of training exceeds. What is usual in each
// entry but not together is not found.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/simd.hpp"

namespace rdm {

struct Novelty {
  float rms = 0, largest = 0;  // 0: unknown
};

// The z of a row: (row - shift) scale.
struct ScaledRow {
  const float *row, *shift, *scale;
  const int32_t* columns = nullptr;  // entries of the row, null: the first ones
  bool whole = false;                // shift and scale are of whole rows too, not of the columns alone

  float operator[](int32_t j) const {
    const int32_t x = columns ? columns[j] : j, s = whole ? x : j;
    return (row[x] - shift[s]) * scale[s];
  }
  Float4 four(int32_t j) const {
    if (columns) return Float4{(*this)[j], (*this)[j + 1], (*this)[j + 2], (*this)[j + 3]};
    return (load4(row + j) - load4(shift + j)) * load4(scale + j);
  }
};

// Over count >= 1 entries, in eight sums.
inline Novelty novelty_of(const ScaledRow& z, int32_t count) {
  Float4 sum[2] = {}, top[2] = {};
  int32_t j = 0;
  for (; j + 8 <= count; j += 8)
    for (const int32_t half : {0, 1}) {
      const Float4 x = z.four(j + 4 * half);
      sum[half] += x * x;
      top[half] = max(top[half], abs(x));
    }
  for (int32_t lane = 0; j < count; ++j, ++lane) {
    const float x = z[j];
    sum[lane / 4][lane % 4] += x * x;
    top[lane / 4][lane % 4] = std::max(top[lane / 4][lane % 4], std::abs(x));
  }
  Novelty n;
  for (int32_t lane = 0; lane < 8; ++lane) {
    n.rms += sum[lane / 4][lane % 4];
    n.largest = std::max(n.largest, top[lane / 4][lane % 4]);
  }
  n.rms = std::sqrt(n.rms / static_cast<float>(count));
  return n;
}

// In units of what is usual, at most the largest float.
inline float scaled(const Novelty& n, const Novelty& usual) {
  const float x = std::max(n.rms / usual.rms, n.largest / usual.largest);
  constexpr float kMost = std::numeric_limits<float>::max();
  return x <= kMost ? x : kMost;
}

}  // namespace rdm

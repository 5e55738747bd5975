// Patterns of floors, averaged over what a sample stands for.
#pragma once
#include <cmath>

#include "base/simd.hpp"

namespace rdm {

inline Float4 floor(Float4 v) {
  return Float4{std::floor(v[0]), std::floor(v[1]), std::floor(v[2]), std::floor(v[3])};
}

// Mean over [x - w/2, x + w/2] of a wave that is +1 and -1 on alternate unit intervals.
inline Float4 square_wave(Float4 x, Float4 w) {
  const auto ramp = [](Float4 v) {
    const Float4 half = 0.5f * v;
    return abs(half - floor(half) - 0.5f);
  };
  return 2.0f * (ramp(x - 0.5f * w) - ramp(x + 0.5f * w)) / w;
}

// Share of [x - w/2, x + w/2] that lies within `half` of a whole number.
inline Float4 line_share(Float4 x, Float4 w, float half) {
  const auto covered = [half](Float4 v) {  // of [0, v]
    const Float4 whole = floor(v + 0.5f);
    return whole * (2 * half) + clamp(v - whole, -half, half);
  };
  return (covered(x + 0.5f * w) - covered(x - 0.5f * w)) / w;
}

}  // namespace rdm

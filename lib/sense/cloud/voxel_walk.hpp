// The voxels that a straight line passes through, in order (Amanatides and Woo, 1987).
#pragma once
#include <algorithm>
#include <cmath>

#include "base/vec.hpp"
#include "sense/cloud/key_set.hpp"

namespace rdm {

// Voxels of side `size`, m, numbered from the corner at -32768 size.
struct VoxelLattice {
  static constexpr int32_t kMiddle = kKeyCount / 2;
  double size = 0, inverse = 0;

  explicit VoxelLattice(double side) : size(side), inverse(1 / side) {}
  // False outside the lattice and for what is not finite.
  bool key(const Vec3& p, VoxelKey* out) const {
    const double x = std::floor(p.x * inverse) + kMiddle, y = std::floor(p.y * inverse) + kMiddle,
                 z = std::floor(p.z * inverse) + kMiddle;
    const bool inside = (x >= 0) & (x < kKeyCount) & (y >= 0) & (y < kKeyCount) & (z >= 0) & (z < kKeyCount);
    if (inside) *out = {{static_cast<int32_t>(x), static_cast<int32_t>(y), static_cast<int32_t>(z)}};
    return inside;
  }
  double low(int32_t k) const { return (k - kMiddle) * size; }
  Vec3 centre(const VoxelKey& key) const {
    return {low(key.k[0]) + 0.5 * size, low(key.k[1]) + 0.5 * size, low(key.k[2]) + 0.5 * size};
  }
};

// Calls visit(key, t) for each voxel from that of `from` to that of `to`, both included, where t in [0, 1] is
// the share of the way at which the line enters it; visit returns false to end the walk. Nothing is visited
// when an end lies outside the lattice: then the answer is false.
template <class Visit>
bool walk_voxels(const VoxelLattice& lattice, const Vec3& from, const Vec3& to, Visit&& visit) {
  VoxelKey key, last;
  if (!lattice.key(from, &key) || !lattice.key(to, &last)) return false;
  const Vec3 way = to - from;
  double next[3], stride[3];
  int32_t step[3];
  for (int i = 0; i < 3; ++i) {
    step[i] = way[i] > 0 ? 1 : way[i] < 0 ? -1 : 0;
    const double border = lattice.low(key.k[i] + (step[i] > 0));
    next[i] = step[i] ? (border - from[i]) / way[i] : HUGE_VAL;
    stride[i] = step[i] ? lattice.size / std::abs(way[i]) : HUGE_VAL;
  }
  double t = 0;
  while (visit(key, t) && (key.k[0] != last.k[0] || key.k[1] != last.k[1] || key.k[2] != last.k[2])) {
    const int i = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : next[1] < next[2] ? 1 : 2;
    t = next[i];
    if (!(t <= 1)) {  // rounding has passed the last voxel by
      visit(last, 1);
      return true;
    }
    key.k[i] += step[i];
    next[i] += stride[i];
  }
  return true;
}

}  // namespace rdm

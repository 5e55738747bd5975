// Hulls that tests share.
#pragma once
#include <list>

#include "physics/model/hull.hpp"

namespace rdm {

// Half sizes of the foot of a block and of its head, upright along z: a box where they are the same.
inline Hull block_hull(const Vec3& foot, const Vec3& head, const Pose& X = {}) {
  Vec3 p[8];
  for (int i = 0; i < 8; ++i) {
    const Vec3& half = i & 4 ? head : foot;
    p[i] = X * Vec3{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
  }
  return make_hull(p, 8, "block");
}
// The same for a block of these half sizes with its head `narrow` times as wide; kept for the life of the
// test.
inline const Hull& kept_hull(const Vec3& half, double narrow = 1) {
  struct Kept {
    Vec3 half;
    double narrow;
    Hull hull;
  };
  static std::list<Kept> kept;
  for (const Kept& k : kept)
    if (norm(k.half - half) == 0 && k.narrow == narrow) return k.hull;
  kept.push_back({half, narrow, block_hull(half, {narrow * half.x, narrow * half.y, half.z})});
  return kept.back().hull;
}

}  // namespace rdm

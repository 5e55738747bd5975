// How deep a free body stands in others, for both engines.
#pragma once
#include <algorithm>

#include "physics/collision/broadphase.hpp"
#include "physics/collision/shapes.hpp"

namespace rdm {

// The deepest point of all pairs that `body` has a shape in, m; 0: it touches nothing. `touch(pair, points)`
// writes at most kMaxPairPoints points of a pair and returns their number; the bounds of `broad` are those of
// now.
template <class Touch>
double deepest_overlap(const Scene& scene, const BroadPhase& broad, int32_t body, Touch&& touch) {
  const auto carries = [&](int32_t shape) {
    const SceneShape& s = scene.shapes[static_cast<size_t>(shape)];
    return s.carrier == Carrier::kBody && s.index == body;
  };
  double deepest = 0;
  dContactGeom points[kMaxPairPoints];
  for (int32_t k = 0; k < static_cast<int32_t>(scene.pairs.size()); ++k) {
    const ShapePair& pair = scene.pairs[static_cast<size_t>(k)];
    if (!(carries(pair.a) || carries(pair.b)) || !broad.near(k)) continue;
    const int n = touch(pair, points);
    for (int i = 0; i < n; ++i) deepest = std::max(deepest, static_cast<double>(points[i].depth));
  }
  return deepest;
}

}  // namespace rdm

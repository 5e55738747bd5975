// Furthest-point sampling (Gonzalez, "Clustering to minimize the maximum intercluster distance", 1985; of
// images Eldar et al., "The farthest point strategy for progressive image sampling", 1997; of clouds for
// networks PointNet++, Qi et al. 2017): from a set S that begins with one point, the next is
//   argmax_p d(p), d(p) = min over s in S of |p - s|^2,  and after it  d(p) <- min(d(p), |p - s_new|^2).
// Its largest d is at most twice that of the best set of as many points.
//
// Exact, of equals the first in the list, over a k-d tree of buckets of 16 points (as Han et al.'s QuickFPS,
// 2023): a node keeps its bounds and the largest d below it, so that a new point goes down only where it lies
// nearer to the bounds than that. A chosen point has d = -1, behind those that lie where it does.
#pragma once
#include <cstdint>

#include "base/arena.hpp"
#include "base/simd.hpp"

namespace rdm {

inline constexpr int32_t kMaxCloud = 1 << 22;  // points

// Workspace of one thread for up to max_points points, about 60 bytes each.
struct FurthestScratch {
  struct Node {
    Float4 low, high;  // bounds; the fourth lane is 0
    float best;        // square of the largest distance of a point of it to the chosen ones
    int32_t at;        // that point's place; of equals the one that came first
  };
  struct Item {
    float p[3];
    int32_t index;
  };
  int32_t max_points = 0;
  Item* items = nullptr;  // [max_points]
  Node* nodes = nullptr;  // of a full binary tree: children of k are 2k and 2k + 1
  float *x = nullptr, *y = nullptr, *z = nullptr, *distance = nullptr;  // in buckets, filled up
  int32_t* index = nullptr;
};
FurthestScratch carve_furthest_scratch(Arena& arena, int32_t max_points);

// Chooses `wanted` of points [count][3] (finite, 1 <= wanted <= count <= max_points), the first of them the
// point `start`; their numbers go to chosen [wanted], in the order of choice.
void sample_furthest(const float* points, int32_t count, int32_t wanted, int32_t start,
                     const FurthestScratch& scratch, int32_t* chosen);

}  // namespace rdm

// Furthest-point sampling: each next point is the one that lies furthest from all chosen so far. Exact, over
// a k-d tree of buckets: a new point only looks into buckets that it can come nearer to than they have been.
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

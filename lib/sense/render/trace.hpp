// Rays of one tile of pixels against a list of primitives: the inner loop of every picture.
#pragma once
#include <cstdint>

#include "sense/render/camera.hpp"
#include "sense/render/intersect.hpp"

namespace rdm {

inline constexpr int kTileSide = 4;  // pixels; a tile's row is one group of lanes
static_assert(kTileSide == kFloat4Lanes);

// Indices of primitives.
struct IndexList {
  const int32_t* at = nullptr;
  int32_t count = 0;
};

// The rays of a view, in E (primitive.hpp).
struct Rays {
  Lanes3 right, down;  // step of one pixel, at a depth of 1 m
  Lanes3 corner;       // through image point (0, 0)
};
Rays make_rays(const View& view);

// What the rays of one tile meet, row by row.
struct Hits {
  Lanes3 d[kTileSide];  // rays; z of C is 1
  Float4 t[kTileSide];  // depth, m; kMaxDepth where nothing is met
  Int4 who[kTileSide];  // primitive, -1: none
};

// Rays through (x + i + dx, y + j + dy), i and j in [0, kTileSide), pixels. `list` is in the order of
// Primitive::nearest, so that with `stop` the search ends where nothing nearer can follow; of equal depths
// the first in the list is met.
void trace(const Rays& rays, const Primitive* primitives, const IndexList& list, bool stop, float x, float y,
           Hits* out);

}  // namespace rdm

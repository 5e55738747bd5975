// What a tile of pixels needs of the light: which shapes may darken it, and how much of the key light arrives.
#pragma once
#include <cstdint>

#include "sense/render/paint.hpp"

namespace rdm {

// Sphere about points, in E (primitive.hpp); r < 0: there are none.
struct Ball {
  float x, y, z, r;
};
// About what `count` samples of a tile meet.
Ball ball_about(const Hits* hits, int count);

// Primitives of painter.all that may stand between the ball and a disc in direction `to` (unit), whose half
// angle has the tangent `spread`. Writes them to `out`, returns how many.
int32_t list_toward(const Painter& painter, const Ball& ball, const Vec3& to, double spread, int32_t* out);
// Primitives that may hide a part of the sky from the ball.
int32_t list_near(const Painter& painter, const Ball& ball, int32_t* out);

// Some of the light's rays: those numbered first + k * stride, k < count <= kMaxRaysPerSample.
struct RaySet {
  int first, stride, count;
};
// Share of these rays that reach the points p of primitives `who`, of row `row` of a tile.
Float4 light_share(const Painter& painter, const IndexList& list, Int4 who, const Lanes3& p, const Lanes3& n,
                   const RaySet& set, int row);

// Where the rays d meet plane s at depth t, in its frame, and the box that a sample stands for, m; `share` is the
// sample's part of a pixel's side.
struct Footprint {
  Float4 x, y, wx, wy;
};
Footprint footprint(const Painter& painter, const Primitive& s, const Lanes3& d, Float4 t, float share);

}  // namespace rdm

// One ray into a world: the nearest of its shapes, as pictures show them.
#pragma once
#include "physics/world.hpp"

namespace rdm {

struct RayHit {
  int32_t shape = -1;   // of the scene
  double distance = 0;  // m
  Vec3 p, n;            // where the ray enters, and the unit normal out of the shape; world
};

// The first surface that the ray from `origin` along the unit vector `direction` enters, at most `range` m
// away; false: there is none. A shape that holds the origin is not met. Of several at the same distance it is
// the first.
bool cast_ray(const World& world, const Vec3& origin, const Vec3& direction, double range, RayHit* out);

}  // namespace rdm

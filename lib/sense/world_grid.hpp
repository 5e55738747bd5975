// Worlds side by side in one picture: where each stands, and a camera that sees all of them.
#pragma once
#include <cstdint>

#include "physics/world.hpp"
#include "sense/render/camera.hpp"

namespace rdm {

// Rows go away from the camera and columns to its right, both level.
struct WorldGrid {
  int32_t columns = 1;
  Vec3 row, column;  // m, from a world to the next
  Camera camera;     // in the frame of world 0

  Vec3 place(int32_t i) const {
    const int32_t down = i / columns, across = i % columns;
    return static_cast<double>(down) * row + static_cast<double>(across) * column;
  }
};
// Of `count` worlds like this one, seen as `camera` sees this one, from further away and not from below 30 degrees.
// They stand as far apart as what the camera looks at is wide; what is far from its target is left out of account.
WorldGrid make_world_grid(const World& world, const Camera& camera, int32_t count, int32_t width,
                          int32_t height);

}  // namespace rdm

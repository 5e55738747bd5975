// From a world to what a picture is made of.
#pragma once
#include <cstdint>

#include "physics/world.hpp"
#include "sense/render/render_shape.hpp"

namespace rdm {

// Shape i of the world's scene at its present pose; id is i.
RenderShape shape_of(const World& world, int32_t i);
// Writes all shapes of the world's scene at their present poses to `out` [scene().shapes.size()], in the
// scene's order. Returns how many there are.
int32_t gather_shapes(const World& world, RenderShape* out);

}  // namespace rdm

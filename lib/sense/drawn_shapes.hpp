// From a world to a picture for people: round edges, what things are made of, and on hands what shapes that are
// there for contacts leave out.
//
// A hand is found by its shapes alone: three or more fingers, which are chains of links with capsules that end
// in a link without children and begin at a link with a box, the palm. Its boxes are rounded off as far as they
// are thick, a bone leads from each finger to the far end of the palm, and a nail lies on the back of each tip:
// away from where its joint bends to.
#pragma once
#include <cstdint>

#include "physics/world.hpp"
#include "sense/render/render_shape.hpp"

namespace rdm {

// At most so many are drawn.
int32_t most_drawn_shapes(const Scene& scene);
// Writes them to `out` [most_drawn_shapes]: first the scene's, in its order, then those that are added, which
// have the id of the shape that they sit on. Returns how many there are.
int32_t gather_drawn(const World& world, RenderShape* out);

}  // namespace rdm

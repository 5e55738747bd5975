#include "sense/scene_shapes.hpp"

namespace rdm {

RenderShape shape_of(const World& world, int32_t i) {
  const SceneShape& from = world.scene().shapes[static_cast<size_t>(i)];
  RenderShape shape;
  shape.kind = from.def.kind;
  shape.size = world.shape_size(i);
  shape.X_WS = world.shape_pose(i);
  for (int k = 0; k < 3; ++k) shape.color[k] = from.def.color[k];
  shape.id = i;
  shape.hull = world.shape_hull(i);
  return shape;
}

int32_t gather_shapes(const World& world, RenderShape* out) {
  const auto count = static_cast<int32_t>(world.scene().shapes.size());
  for (int32_t i = 0; i < count; ++i) out[i] = shape_of(world, i);
  return count;
}

}  // namespace rdm

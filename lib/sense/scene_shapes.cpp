#include "sense/scene_shapes.hpp"

namespace rdm {

int32_t gather_shapes(const World& world, RenderShape* out) {
  const Scene& scene = world.scene();
  const auto count = static_cast<int32_t>(scene.shapes.size());
  for (int32_t i = 0; i < count; ++i) {
    const SceneShape& from = scene.shapes[static_cast<size_t>(i)];
    const ShapeDef& def = from.def;
    RenderShape& shape = out[i];
    shape.kind = def.kind;
    shape.size = world.shape_size(i);
    shape.X_WS = world.shape_pose(i);
    for (int k = 0; k < 3; ++k) shape.color[k] = def.color[k];
    shape.id = i;
    shape.hull = world.shape_hull(i);
  }
  return count;
}

}  // namespace rdm

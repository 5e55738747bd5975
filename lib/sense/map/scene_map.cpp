#include "sense/map/scene_map.hpp"

#include <algorithm>

#include "sense/cloud/cloud.hpp"
#include "sense/render/raycast.hpp"

namespace rdm {

void scan_scene(const Scene& scene, bool statics, const int32_t* bodies, int32_t num_bodies,
                const Camera* cameras, int32_t num_cameras, int32_t side, Occupancy* map) {
  Vector<RenderShape> shapes;
  for (const SceneShape& s : scene.shapes) {
    const bool listed =
        s.carrier == Carrier::kBody && std::find(bodies, bodies + num_bodies, s.index) != bodies + num_bodies;
    const bool stands = statics && s.carrier == Carrier::kStatic;
    if (s.def.kind == ShapeKind::kPlane || !(listed || stands)) continue;
    RenderShape shape;
    shape.kind = s.def.kind;
    shape.size = s.def.size;
    shape.hull = scene.hull_of(s);
    shape.X_WS = listed ? scene.def.bodies[static_cast<size_t>(s.index)].X_WB * s.def.X_LS : s.def.X_LS;
    shapes.push_back(shape);
  }
  const auto count = static_cast<int32_t>(shapes.size());
  const auto pixels = static_cast<size_t>(side) * static_cast<size_t>(side);
  Vector<float> depth(pixels), points(3 * pixels);
  Vector<int32_t> ids(pixels), on(pixels);
  Arena measure;
  carve_raycast_scratch(measure, count);
  Arena arena(host(), measure.used());
  const RaycastScratch scratch = carve_raycast_scratch(arena, count);
  for (int32_t k = 0; k < num_cameras; ++k) {
    const Camera& camera = cameras[k];
    render(shapes.data(), count, camera, {side, side, nullptr, depth.data(), ids.data()}, {}, scratch);
    Cloud cloud{points.data(), on.data(), 0};
    append_points(make_view(camera, side, side), depth.data(), ids.data(), camera.target, kMaxDepth, &cloud);
    map->insert(camera.eye, cloud.points, static_cast<size_t>(cloud.count));
  }
}

}  // namespace rdm

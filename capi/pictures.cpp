// Pictures of worlds, for people.
#include "capi/handles.hpp"

#if RDM_WITH_SIM
#include "redman/sense.h"
#include "sense/drawn_shapes.hpp"
#include "sense/scene_shapes.hpp"
#include "sense/world_grid.hpp"

using namespace rdm;
using namespace rdm::capi;

namespace {

constexpr int kPlainSamples = 3;  // per side of a pixel

// Shapes of some worlds, each moved to its place; planes of the first one alone. Returns how many.
int32_t gather_grid(const rdm_pool* p, int32_t env, int32_t count, const WorldGrid& grid, bool fine,
                    RenderShape* out) {
  int32_t n = 0;
  const auto per_world = static_cast<int32_t>(p->pool->task().scene().shapes.size());
  for (int32_t k = 0; k < count; ++k) {
    const World& world = p->pool->world(env + k);
    const int32_t more = fine ? gather_drawn(world, out + n) : gather_shapes(world, out + n);
    int32_t kept = n;
    for (int32_t i = n; i < n + more; ++i) {
      if (k > 0 && out[i].kind == ShapeKind::kPlane) continue;
      out[kept] = out[i];
      out[kept].X_WS.p += grid.place(k);
      out[kept].id += k * per_world;
      ++kept;
    }
    n = kept;
  }
  return n;
}

// Colours of the shapes as they are for people, depth and segmentation of the true ones.
void draw(rdm_pool* p, const rdm_picture& picture, const WorldGrid& grid, int32_t count, RenderShape* shapes,
          const RaycastScratch& scratch) {
  const bool fine = picture.look == RDM_LOOK_FINE;
  if (picture.rgb) {
    RenderOptions options;
    options.samples_per_side = kPlainSamples;
    options.fine = fine;
    render(shapes, gather_grid(p, picture.env, count, grid, fine, shapes), grid.camera,
           {picture.width, picture.height, picture.rgb, nullptr, nullptr}, options, scratch);
  }
  if (picture.depth || picture.segmentation || !picture.rgb)
    render(shapes, gather_grid(p, picture.env, count, grid, false, shapes), grid.camera,
           {picture.width, picture.height, nullptr, picture.depth, picture.segmentation}, {}, scratch);
}

void draw_picture(rdm_pool* p, const rdm_picture& picture) {
  const int32_t worlds = p->pool->config().num_envs, count = std::max(picture.num_envs, 1);
  need_index(picture.env, worlds, "env");
  if (picture.num_envs < 0 || picture.num_envs > worlds - picture.env)
    fail(Code::kRange, "num_envs: %d is outside [0, %d], the worlds from env %d on", picture.num_envs,
         worlds - picture.env, picture.env);
  if (picture.look != RDM_LOOK_FINE && picture.look != RDM_LOOK_PLAIN)
    fail(Code::kRange, "look: %d is none of RDM_LOOK_", picture.look);
  const Camera camera = pool_camera(p, picture.env, picture.camera);
  const WorldGrid grid =
      make_world_grid(p->pool->world(picture.env), camera, count, picture.width, picture.height);
  if (count == 1) return draw(p, picture, grid, count, p->shapes, p->raycast);
  const int64_t most = static_cast<int64_t>(most_drawn_shapes(p->pool->task().scene())) * count;
  if (most > kMaxRenderShapes)
    fail(Code::kRange, "num_envs: %d worlds have %lld shapes, more than %d", count,
         static_cast<long long>(most), kMaxRenderShapes);
  const auto carve = [&](Arena& arena, RenderShape** shapes) {
    *shapes = arena.make<RenderShape>(static_cast<size_t>(most));
    return carve_raycast_scratch(arena, static_cast<int32_t>(most));
  };
  RenderShape* shapes = nullptr;
  Arena measure;
  carve(measure, &shapes);
  Arena arena(p->hooks, measure.used());
  const RaycastScratch scratch = carve(arena, &shapes);
  draw(p, picture, grid, count, shapes, scratch);
}

}  // namespace

rdm_result rdm_pool_render(rdm_pool* p, int32_t env, const char* camera, int32_t w, int32_t h, uint8_t* rgb,
                           float* depth, int32_t* segmentation) {
  return call_on(p, [&] {
    rdm_picture picture{};
    picture.env = env;
    picture.camera = camera;
    picture.width = w;
    picture.height = h;
    picture.rgb = rgb;
    picture.depth = depth;
    picture.segmentation = segmentation;
    draw_picture(p, picture);
  });
}

rdm_result rdm_pool_draw(rdm_pool* p, const rdm_picture* picture) {
  return call_on(
      p, [&] { draw_picture(p, read_struct(picture, sizeof(rdm_picture), rdm_picture{}, "picture")); });
}
#endif

#include "sense/render/raycast.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "sense/render/fine.hpp"
#include "sense/render/paint.hpp"
#include "sense/render/shade.hpp"
#include "sense/render/trace.hpp"

namespace rdm {

namespace {

void check(const RenderShape* shapes, int32_t num_shapes, const RenderOptions& options,
           const RaycastScratch& scratch) {
  if (num_shapes < 0 || num_shapes > scratch.max_shapes)
    fail(Code::kRange, "num_shapes: %d is outside [0, %d]", num_shapes, scratch.max_shapes);
  if (num_shapes > 0 && !shapes) fail(Code::kArgument, "shapes is NULL with num_shapes %d", num_shapes);
  if (options.samples_per_side < 1 || options.samples_per_side > kMaxSamplesPerSide)
    fail(Code::kRange, "samples_per_side: %d is outside [1, %d]", options.samples_per_side,
         kMaxSamplesPerSide);
}

// Makes the primitives and their order; returns how many are drawn.
int32_t prepare(const RenderShape* shapes, int32_t num_shapes, const View& view, bool color,
                const RaycastScratch& scratch) {
  int32_t n = 0;
  for (int32_t i = 0; i < num_shapes; ++i) {
    Primitive& s = scratch.primitives[n];
    if (!make_primitive(shapes[i], i, view, &s)) continue;
    if (color)
      for (int k = 0; k < 3; ++k) s.color[k] = from_srgb(shapes[i].color[k]);
    scratch.order[n] = n;
    ++n;
  }
  const Primitive* p = scratch.primitives;
  std::sort(scratch.order, scratch.order + n, [p](int32_t a, int32_t b) {
    return p[a].nearest < p[b].nearest || (p[a].nearest == p[b].nearest && a < b);
  });
  return n;
}

int32_t list_row(const Primitive* primitives, const IndexList& all, float y0, float y1, int32_t* out) {
  int32_t n = 0;
  for (int32_t k = 0; k < all.count; ++k) {
    const Primitive& s = primitives[all.at[k]];
    if (s.y0 < y1 && s.y1 > y0) out[n++] = all.at[k];
  }
  return n;
}

int32_t list_tile(const Primitive* primitives, const IndexList& row, float x0, float x1, int32_t* out) {
  int32_t n = 0;
  for (int32_t k = 0; k < row.count; ++k) {
    const Primitive& s = primitives[row.at[k]];
    if (s.x0 < x1 && s.x1 > x0) out[n++] = row.at[k];
  }
  return n;
}

void store(const Image& image, const Primitive* primitives, const Hits& hits, int32_t x, int32_t y) {
  for (int32_t r = 0; r < kTileSide && y + r < image.height; ++r) {
    const size_t at = static_cast<size_t>(y + r) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
    const int32_t columns = std::min(kTileSide, image.width - x);
    for (int32_t i = 0; i < columns; ++i) {
      const int32_t who = hits.who[r][i];
      if (image.depth) image.depth[at + static_cast<size_t>(i)] = who < 0 ? 0 : hits.t[r][i];
      if (image.segmentation)
        image.segmentation[at + static_cast<size_t>(i)] = who < 0 ? -1 : primitives[who].id;
    }
  }
}

}  // namespace

RaycastScratch carve_raycast_scratch(Arena& arena, int32_t max_shapes) {
  if (max_shapes < 0 || max_shapes > kMaxRenderShapes)
    fail(Code::kRange, "max_shapes: %d is outside [0, %d]", max_shapes, kMaxRenderShapes);
  const auto count = static_cast<size_t>(max_shapes);
  RaycastScratch scratch;
  scratch.max_shapes = max_shapes;
  scratch.primitives = arena.make<Primitive>(count);
  scratch.order = arena.make<int32_t>(count);
  scratch.row = arena.make<int32_t>(count);
  scratch.tile = arena.make<int32_t>(count);
  scratch.shadow = arena.make<int32_t>(count);
  scratch.near = arena.make<int32_t>(count);
  scratch.mirror = arena.make<int32_t>(count);
  return scratch;
}

void render(const RenderShape* shapes, int32_t num_shapes, const Camera& camera, const Image& image,
            const RenderOptions& options, const RaycastScratch& scratch) {
  check(shapes, num_shapes, options, scratch);
  const View view = make_view(camera, image.width, image.height);
  const Primitive* primitives = scratch.primitives;
  const int32_t count = prepare(shapes, num_shapes, view, image.rgb != nullptr, scratch);
  const IndexList all{scratch.order, count};
  const Rays rays = make_rays(view);
  LightRays lights;
  RenderOptions how = options;
  if (how.fine) how.samples_per_side = kFineLightSide;
  if (image.rgb) lights = make_light_rays(how.samples_per_side, how.fine ? kFineLightSpread : kLightSpread);
  const Painter painter{view, rays, lights, how, scratch, all};
  const bool measure = image.depth || image.segmentation;

  for (int32_t y = 0; y < image.height; y += kTileSide) {
    const auto fy = static_cast<float>(y);
    const IndexList row{scratch.row, list_row(primitives, all, fy, fy + kTileSide, scratch.row)};
    for (int32_t x = 0; x < image.width; x += kTileSide) {
      const auto fx = static_cast<float>(x);
      IndexList seen{scratch.tile, list_tile(primitives, row, fx, fx + kTileSide, scratch.tile)};
      const bool flat = std::all_of(seen.at, seen.at + seen.count,
                                    [&](int32_t k) { return primitives[k].kind == ShapeKind::kPlane; });
      if (!options.cull) seen = all;
      if (measure) {
        Hits hits;
        trace(rays, primitives, seen, options.cull, fx + 0.5f, fy + 0.5f, &hits);
        store(image, primitives, hits, x, y);
      }
      if (!image.rgb) continue;
      if (options.fine)
        paint_fine_tile(painter, seen, x, y, image.rgb);
      else
        paint_tile(painter, seen, flat, x, y, image.rgb);
    }
  }
}

}  // namespace rdm

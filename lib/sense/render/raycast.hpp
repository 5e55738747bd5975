// Pictures of shapes by casting rays: colour, depth and segmentation.
//
// Tiles of 4 x 4 pixels test only the shapes whose bounds they touch, nearest first, four rays at a time.
// No heap use; one scratch per thread. Same input, same bytes.
#pragma once
#include <cstdint>

#include "base/arena.hpp"
#include "sense/render/camera.hpp"
#include "sense/render/primitive.hpp"
#include "sense/render/render_shape.hpp"

namespace rdm {

inline constexpr int32_t kMaxRenderShapes = 65536;
inline constexpr int32_t kMaxSamplesPerSide = 8;
inline constexpr double kMaxDepth = 100;  // m; what is further is not seen

// The caller's buffers, row-major from the upper left pixel, any of them null.
struct Image {
  int32_t width = 0, height = 0;    // pixels, 1 to kMaxImageSide
  uint8_t* rgb = nullptr;           // [height][width][3], sRGB
  float* depth = nullptr;           // [height][width], m along the optical axis; 0 where nothing is hit
  int32_t* segmentation = nullptr;  // [height][width], RenderShape::id; -1 where nothing is hit
};

struct RenderOptions {
  int32_t samples_per_side = 1;  // colour takes the mean of n x n rays per pixel, 1 to kMaxSamplesPerSide
  bool shadows = true;           // n = 1: hard; more: soft, the samples share out the light's disc
  bool cull = true;              // false: every ray meets every shape; the same bytes, slowly
  bool fine = false;  // as people like it (fine.hpp); samples_per_side and shadows count for nothing
};

// Workspace of one thread for up to max_shapes shapes, about 240 bytes each.
struct RaycastScratch {
  int32_t max_shapes = 0;
  Primitive* primitives = nullptr;  // [max_shapes]
  int32_t* order = nullptr;         // [max_shapes], primitives by nearest depth
  int32_t* row = nullptr;           // [max_shapes], those that a row of tiles may see
  int32_t* tile = nullptr;          // [max_shapes], those that a tile may see
  int32_t* shadow = nullptr;        // [max_shapes], those that may darken a tile
  int32_t* near = nullptr;          // [max_shapes], those that may hide a tile's sky
  int32_t* mirror = nullptr;        // [max_shapes], those that a tile's floor may mirror
};
// Error(kRange) for max_shapes outside [0, kMaxRenderShapes].
RaycastScratch carve_raycast_scratch(Arena& arena, int32_t max_shapes);

// Depth and segmentation are those of the pixel's centre, whatever samples_per_side. Errors as make_view
// and make_primitive; Error(kRange) for a count that the scratch does not hold or a bad option. Nothing is
// written on error.
void render(const RenderShape* shapes, int32_t num_shapes, const Camera& camera, const Image& image,
            const RenderOptions& options, const RaycastScratch& scratch);

}  // namespace rdm

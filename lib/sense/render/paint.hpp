// Colour of one tile of pixels: traces its samples, finds shadows and closeness, shades, and averages.
#pragma once
#include <cstdint>

#include "sense/render/raycast.hpp"
#include "sense/render/trace.hpp"

namespace rdm {

// Directions to points of the light's disc, turned from pixel to pixel of a tile so that the edges of soft
// shadows show no bands. One ray for a single sample a pixel: hard shadows.
inline constexpr int kRaysPerSample = 4, kMaxRaysPerSample = 16;
struct LightRays {
  Lanes3 key;  // to the middle of the disc
  int32_t per_sample = 1;
  Lanes3 at[kMaxSamplesPerSide * kMaxSamplesPerSide][kTileSide];  // [ray][row of a tile]
};
LightRays make_light_rays(int32_t samples_per_side, double spread);

// What paint_tile needs to know of the picture.
struct Painter {
  const View& view;
  const Rays& rays;
  const LightRays& lights;
  const RenderOptions& options;
  const RaycastScratch& scratch;
  IndexList all;  // every primitive, by nearest depth
};

// Pixels from (x, y) on, clipped to the picture. `seen` holds what may be seen there; `flat` says that none
// of it but planes can be: where no shadow falls either, one sample does for all.
void paint_tile(const Painter& painter, const IndexList& seen, bool flat, int32_t x, int32_t y, uint8_t* rgb);

// Writes a tile's sums of linear light, times scale, as the bytes that `encode` makes of a channel.
template <uint8_t (*encode)(float)>
void store_tile(const Painter& painter, const Lanes3 (&sum)[kTileSide], float scale, int32_t x, int32_t y,
                uint8_t* rgb) {
  const int32_t width = painter.view.width, height = painter.view.height;
  for (int32_t r = 0; r < kTileSide && y + r < height; ++r)
    for (int32_t i = 0; i < kFloat4Lanes && x + i < width; ++i) {
      uint8_t* out =
          rgb + 3 * (static_cast<size_t>(y + r) * static_cast<size_t>(width) + static_cast<size_t>(x + i));
      out[0] = encode(scale * sum[r].x[i]);
      out[1] = encode(scale * sum[r].y[i]);
      out[2] = encode(scale * sum[r].z[i]);
    }
}

}  // namespace rdm

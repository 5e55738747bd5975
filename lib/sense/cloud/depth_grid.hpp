// A grid of cells about a place, as one set of depth pictures shows them: occupied, free, or not seen.
#pragma once
#include <cstdint>

#include "sense/render/camera.hpp"

namespace rdm {

struct DepthPicture {
  View view;
  const float* depth = nullptr;  // [height][width], 0: nothing was hit
};

// A cube of n x n x n cells of `side` m with its middle at `centre`, axes as the world's, x outermost: 1
// where a picture has a surface within half a cell of the cell's centre, else 0 where one sees past it, else
// -1.
void grid_from_depth(const DepthPicture* pictures, int32_t num_pictures, const Vec3& centre, int32_t n,
                     double side, int8_t* out);

}  // namespace rdm

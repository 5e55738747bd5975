#include "sense/cloud/depth_grid.hpp"

#include <cmath>

namespace rdm {
namespace {

constexpr double kNear = 1e-3;  // m: what is nearer to the eye's plane is not seen

// 1 surface, 0 free, -1 not seen.
int8_t look(const DepthPicture& picture, const Vec3& p, double half) {
  const View& v = picture.view;
  const Vec3 d = p - v.eye;
  const double z = dot(v.R_WC.col(2), d);
  if (z < kNear) return -1;
  const double x = dot(v.R_WC.col(0), d) / (z * v.pixel) + v.cx;
  const double y = dot(v.R_WC.col(1), d) / (z * v.pixel) + v.cy;
  if (!(x >= 0 && x < v.width && y >= 0 && y < v.height)) return -1;
  const double depth =
      static_cast<double>(picture.depth[static_cast<ptrdiff_t>(y) * v.width + static_cast<ptrdiff_t>(x)]);
  if (depth == 0 || z < depth - half) return 0;
  return z <= depth + half ? 1 : -1;
}

}  // namespace

void grid_from_depth(const DepthPicture* pictures, int32_t num_pictures, const Vec3& centre, int32_t n,
                     double side, int8_t* out) {
  const auto middle = [&](int32_t i) { return (i + 0.5 - 0.5 * n) * side; };
  for (int32_t x = 0; x < n; ++x)
    for (int32_t y = 0; y < n; ++y)
      for (int32_t z = 0; z < n; ++z) {
        const Vec3 p = centre + Vec3{middle(x), middle(y), middle(z)};
        int8_t state = -1;
        for (int32_t k = 0; k < num_pictures && state < 1; ++k) {
          const int8_t seen = look(pictures[k], p, 0.5 * side);
          if (seen > state) state = seen;
        }
        *out++ = state;
      }
}

}  // namespace rdm

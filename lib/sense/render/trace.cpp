#include "sense/render/trace.hpp"

#include "sense/render/raycast.hpp"

namespace rdm {

Rays make_rays(const View& view) {
  return {wide(view.pixel * view.R_WC.col(0)), wide(view.pixel * view.R_WC.col(1)),
          wide(view.R_WC * view.ray_C(0, 0))};
}

void trace(const Rays& rays, const Primitive* primitives, const IndexList& list, bool stop, float x, float y,
           Hits* out) {
  const Float4 columns = x + Float4{0, 1, 2, 3};
  for (int r = 0; r < kTileSide; ++r) {
    const Float4 rows = splat(y + static_cast<float>(r));
    out->d[r] = rays.corner + columns * rays.right + rows * rays.down;
    out->t[r] = splat(static_cast<float>(kMaxDepth));
    out->who[r] = splat_int(-1);
  }
  float farthest = static_cast<float>(kMaxDepth);
  for (int32_t k = 0; k < list.count; ++k) {
    const Primitive& s = primitives[list.at[k]];
    if (stop && s.nearest > farthest) break;
    const Lanes3 o = splat(s.o_S[0], s.o_S[1], s.o_S[2]);
    Int4 met = splat_int(0);
    for (int r = 0; r < kTileSide; ++r) {
      const Float4 t = entry(s, o, rotate_to_shape(s, out->d[r]));
      const Int4 closer = (t > 0.0f) & (t < out->t[r]);
      out->t[r] = select(closer, t, out->t[r]);
      out->who[r] = select(closer, splat_int(list.at[k]), out->who[r]);
      met |= closer;
    }
    if (any(met)) farthest = largest(max(max(out->t[0], out->t[1]), max(out->t[2], out->t[3])));
  }
}

}  // namespace rdm

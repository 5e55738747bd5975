// A shape made ready for one picture: its frame as seen from the eye, and what bounds it.
//
// Two frames: E has the world's axes and its origin in the eye, so that floats keep their precision
// wherever the scene stands; S is the shape's own. Rays are e + t d; with the d of View::ray_C turned into
// E, t is the depth along the optical axis.
#pragma once
#include <cstdint>

#include "sense/render/camera.hpp"
#include "sense/render/lanes3.hpp"
#include "sense/render/render_shape.hpp"

namespace rdm {

struct Primitive {
  ShapeKind kind;
  int32_t id;
  const Hull* hull;  // of kind kHull
  float R_SE[9];     // row-major
  float p_ES[3];     // centre, m
  float o_S[3];      // the eye in S, m
  float size[3];     // as ShapeDef::size, m
  float round;       // of the edges, as RenderShape::round, m
  Finish finish;
  float radius;           // of the bounding sphere about p_ES, m; infinite for a plane
  float color[3];         // linear light, 0 to 1; make_primitive leaves it black
  float nearest;          // no point of it has a smaller depth, m; 0 where the eye is close
  float x0, x1, y0, y1;   // it is seen between these image coordinates only, pixels; x0 > x1: nowhere
  float spine[3], thick;  // capsule that stands for it in ambient occlusion: half axis in E, radius; m
};

// Error(kArgument) for an unknown kind, Error(kRange) for a size that is not positive and finite; the text
// names shape `index`. False, and `out` is not to be used, where the shape's pose is not finite or further
// than 1e6 m from the world's origin.
bool make_primitive(const RenderShape& shape, int32_t index, const View& view, Primitive* out);

// The same vector for every ray.
inline Lanes3 wide(const Vec3& v) {
  return splat(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
}

inline Lanes3 rotate_to_shape(const Primitive& s, const Lanes3& v) {
  const float* r = s.R_SE;
  return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
          r[6] * v.x + r[7] * v.y + r[8] * v.z};
}
inline Lanes3 rotate_from_shape(const Primitive& s, const Lanes3& v) {
  const float* r = s.R_SE;
  return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
          r[2] * v.x + r[5] * v.y + r[8] * v.z};
}
inline Lanes3 to_shape(const Primitive& s, const Lanes3& p_E) {
  return rotate_to_shape(s, p_E - splat(s.p_ES[0], s.p_ES[1], s.p_ES[2]));
}

}  // namespace rdm

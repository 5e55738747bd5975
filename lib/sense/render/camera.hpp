// Pinhole cameras by name, and the rays of their pixels.
//
// The camera frame C has its origin in the eye, x to the right of the picture, y down, z forward along the
// optical axis. Pixel (0, 0) is the upper left one; its centre is (0.5, 0.5).
#pragma once
#include <cstdint>

#include "base/vec.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

inline constexpr int32_t kMaxImageSide = 8192;  // pixels
inline constexpr double kMaxShift = 10;         // pictures

struct Camera {
  Name name;
  Vec3 eye, target;     // m; the optical axis runs from eye to target
  double fov_y = 0;     // vertical field of view about the axis, rad, in (0, pi)
  Vec3 up = {0, 0, 1};  // what points up in the picture
  // In whose frame these three are: 0 the world's, k > 0 link k - 1's, -k the base's of articulation k - 1
  // (sense/mounted_camera.hpp brings them to the world).
  int32_t mount = 0;
  // Where the optical axis meets the picture: to the right of its middle, and below it, as a share of its width
  // and of its height, within +-kMaxShift.
  double cx = 0, cy = 0;
};

// A camera of the world with a picture size. One that looks straight along `up` has world -x up, so that
// `top` is `front` tipped over.
struct View {
  Vec3 eye;
  Mat3 R_WC;
  double pixel = 0;  // side of a pixel at a depth of 1 m, m
  int32_t width = 0, height = 0;
  double cx = 0, cy = 0;  // where the optical axis meets the picture, pixels

  // Direction through the image point (x, y), pixels, in C; z is 1: scaled by a depth it ends at that depth.
  Vec3 ray_C(double x, double y) const { return {(x - cx) * pixel, (y - cy) * pixel, 1}; }
  // World point at `depth` m along the optical axis, seen at the image point (x, y).
  Vec3 point(double x, double y, double depth) const { return eye + depth * (R_WC * ray_C(x, y)); }
};

// The mount is not looked at. Error(kRange) for a size outside [1, kMaxImageSide], a bad angle or shift;
// Error(kArgument) for an eye, target or up that is not finite, or eye and target less than 1e-6 m apart.
View make_view(const Camera& camera, int32_t width, int32_t height);

}  // namespace rdm

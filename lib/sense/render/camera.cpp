#include "sense/render/camera.hpp"

#include <cmath>
#include <numbers>

#include "base/elementary.hpp"
#include "base/error.hpp"

namespace rdm {

View make_view(const Camera& camera, int32_t width, int32_t height) {
  if (width < 1 || width > kMaxImageSide)
    fail(Code::kRange, "width: %d is outside [1, %d]", width, kMaxImageSide);
  if (height < 1 || height > kMaxImageSide)
    fail(Code::kRange, "height: %d is outside [1, %d]", height, kMaxImageSide);
  if (!(camera.fov_y > 0 && camera.fov_y < std::numbers::pi))
    fail(Code::kRange, "fov_y: %g rad is outside (0, pi)", camera.fov_y);
  for (const double shift : {camera.cx, camera.cy})
    if (!(shift >= -kMaxShift && shift <= kMaxShift))
      fail(Code::kRange, "camera: cx or cy is %g, outside [-%g, %g]", shift, kMaxShift, kMaxShift);
  const Vec3 ahead = camera.target - camera.eye;
  if (!finite(camera.eye) || !finite(camera.target) || !finite(ahead) || !finite(camera.up))
    fail(Code::kArgument, "camera: eye, target or up is not finite");
  if (!(norm(ahead) >= 1e-6)) fail(Code::kArgument, "camera: eye and target are less than 1e-6 m apart");

  const Vec3 z = normalized(ahead);
  const Vec3 side = cross(z, camera.up);
  const bool vertical = std::abs(side.x) < 1e-6 && std::abs(side.y) < 1e-6 && std::abs(side.z) < 1e-6;
  const Vec3 x = normalized(vertical ? cross(z, Vec3{-1, 0, 0}) : side);
  const Vec3 y = cross(z, x);
  View view;
  view.eye = camera.eye;
  view.R_WC = {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
  const elementary::SinCos half = elementary::sincos(0.5 * camera.fov_y);
  view.pixel = 2 * half.sin / (half.cos * height);
  view.width = width;
  view.height = height;
  view.cx = (0.5 + camera.cx) * width;
  view.cy = (0.5 + camera.cy) * height;
  return view;
}

}  // namespace rdm

#include "sense/render/camera.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/elementary.hpp"
#include "base/error.hpp"

namespace rdm {

Camera standard_camera(int32_t index) {
  constexpr double kFov = std::numbers::pi / 4;
  switch (index) {
    case 0:
      return {"front", {1.1, -0.5, 0.9}, {0, -0.5, 0.5}, kFov};
    case 1:
      return {"top", {0, -0.5, 1.8}, {0, -0.5, 0.5}, kFov};
    case 2:
      return {"right", {0.6, 0.3, 0.9}, {0, -0.4, 0.5}, kFov};
    case 3:
      return {"left", {0.6, -1.3, 0.9}, {0, -0.6, 0.5}, kFov};
  }
  fail(Code::kRange, "camera: %d is outside [0, %d]", index, kNumStandardCameras - 1);
}

const Camera& find_camera(const Camera* cameras, int32_t num_cameras, const char* name) {
  for (int32_t i = 0; i < num_cameras; ++i)
    if (cameras[i].name == name) return cameras[i];
  char list[160] = "";
  size_t used = 0;
  for (int32_t i = 0; i < num_cameras && used < sizeof list; ++i) {
    const int n = std::snprintf(list + used, sizeof list - used, i ? ", %s" : "%s", cameras[i].name.text);
    if (n < 0) break;
    used += static_cast<size_t>(n);
  }
  fail(Code::kNotFound, "camera: no '%.31s'; there are %s", name, num_cameras ? list : "none");
}

View make_view(const Camera& camera, int32_t width, int32_t height) {
  if (width < 1 || width > kMaxImageSide)
    fail(Code::kRange, "width: %d is outside [1, %d]", width, kMaxImageSide);
  if (height < 1 || height > kMaxImageSide)
    fail(Code::kRange, "height: %d is outside [1, %d]", height, kMaxImageSide);
  if (!(camera.fov_y > 0 && camera.fov_y < std::numbers::pi))
    fail(Code::kRange, "fov_y: %g rad is outside (0, pi)", camera.fov_y);
  const Vec3 ahead = camera.target - camera.eye;
  if (!finite(camera.eye) || !finite(camera.target) || !finite(ahead))
    fail(Code::kArgument, "camera: eye or target is not finite");
  if (!(norm(ahead) >= 1e-6)) fail(Code::kArgument, "camera: eye and target are less than 1e-6 m apart");

  const Vec3 z = normalized(ahead);
  const bool vertical = std::abs(z.x) < 1e-6 && std::abs(z.y) < 1e-6;
  const Vec3 x = normalized(cross(z, vertical ? Vec3{-1, 0, 0} : Vec3{0, 0, 1}));
  const Vec3 y = cross(z, x);
  View view;
  view.eye = camera.eye;
  view.R_WC = {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
  const elementary::SinCos half = elementary::sincos(0.5 * camera.fov_y);
  view.pixel = 2 * half.sin / (half.cos * height);
  view.width = width;
  view.height = height;
  return view;
}

}  // namespace rdm

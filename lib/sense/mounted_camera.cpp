#include "sense/mounted_camera.hpp"

namespace rdm {

Camera placed(const Camera& camera, const World& world) {
  if (camera.mount == 0) return camera;
  const Pose& X = camera.mount > 0 ? world.link(camera.mount - 1).X : world.base(-camera.mount - 1).X;
  Camera out = camera;
  out.eye = X * camera.eye;
  out.target = X * camera.target;
  out.up = rotate(X.q, camera.up);
  out.mount = 0;
  return out;
}

}  // namespace rdm

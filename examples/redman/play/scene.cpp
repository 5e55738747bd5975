#include "play/scene.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <redman/sense.hpp>

#include "common/names.hpp"
#include "draw/cloud.hpp"

namespace tool {
namespace {

// The camera, to look at clouds with.
rdm_camera_info cloud_camera(const redman::Pool& pool, const std::string& name) {
  if (!redman::sensors(pool).points)
    throw Usage(
        "--cloud: these worlds have no point clouds; give --set modality=points, or a policy that reads "
        "points");
  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  for (int32_t i = 0; rdm_pool_camera_at(pool.get(), i, &camera) == RDM_OK && !same_name(camera.name, name);)
    ++i;
  if (camera.mount != 0)
    throw Usage("--cloud: camera " + name + " is mounted on a robot; give one that is fixed");
  return camera;
}

}  // namespace

Scene::Scene(const PoolSettings& settings, const ActorChoice& choice, SceneView view)
    : pool_(make_pool(settings, RDM_AUTORESET_OFF)), actor_(choice, pool_), view_(std::move(view)) {
  pool_.reset();
  try {
    pool_.render(0, view_.camera.c_str(), 1, 1);
  } catch (const redman::Error& e) {
    throw Usage(std::string("--") + e.what());
  }
  if (view_.cloud) cloud_ = cloud_camera(pool_, view_.camera);
  actor_.restart();
}

bool Scene::advance() {
  if (pool_.terminated()[0] || pool_.truncated()[0]) return false;
  actor_.act(pool_);
  actor_.step(pool_);
  ++step_;
  intervened_ |= stepped_in();
  return true;
}

void Scene::advance_to(int32_t step) {
  while (step_ < step && advance()) {
  }
}

Image Scene::picture() {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  Image image{view_.width, view_.height, {}};
  auto what = redman::sized<rdm_picture>();
  what.num_envs = static_cast<int32_t>(pool_.num_envs());
  what.width = view_.width;
  what.height = view_.height;
  what.look = view_.plain ? RDM_LOOK_PLAIN : RDM_LOOK_FINE;
  what.camera = view_.camera.c_str();
  image.rgb = as_usage([&] { return redman::draw(pool_, what); });
  if (cloud_) {
    const rdm_sensors s = redman::sensors(pool_);
    image = one_below_the_other(image, draw_cloud(*cloud_, s.points, s.point_shape, s.point_class,
                                                  s.num_points, view_.width, view_.height));
  }
  if (frames_ > 0 ? intervened_ : stepped_in()) add_border(image);
  intervened_ = false;
  seconds_ += std::chrono::duration<double>(Clock::now() - begin).count();
  ++frames_;
  return image;
}

Image draw_strip(Scene& scene, int32_t moments, int32_t first, int32_t last) {
  first = std::min(first, last);
  PictureRow strip(moments);
  for (int32_t i = 0; i < moments; ++i) {
    const double share = moments > 1 ? static_cast<double>(i) / (moments - 1) : 0.5;
    scene.advance_to(first + static_cast<int32_t>(std::lround(share * (last - first))));
    strip.add(scene.picture());
  }
  return strip.take();
}

int32_t last_step(Scene scene, int32_t to) {
  scene.advance_to(to >= 0 ? to : scene.pool().spec().max_steps);
  return scene.step();
}

}  // namespace tool

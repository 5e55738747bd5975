#include "tasks/hand/hand_task.hpp"

#include <utility>

#include "base/error.hpp"
#include "env/options/simulation.hpp"
#include "tasks/hand/free_start.hpp"

namespace rdm {

namespace {

HandScene freed(const HandControlConfig& config, HandScene made) {
  free_start(config, &made);
  return made;
}

SceneDef adjusted(HandScene* made) {
  made->adjustable = made->adjustable || !made->draws.empty();
  return std::move(static_cast<SceneDef&>(*made));
}

// In the palm's frame (robot/kinematics.hpp): y into its back, z as the fingers point.
constexpr Vec3 kEye = {0, -0.14, -0.1}, kTarget = {0, -0.01, 0.03};
constexpr double kFov = 75 * kPi / 180;

}  // namespace

HandTask::HandTask(const HandControlConfig& config, const Options& o, int32_t max_steps, HandScene scene,
                   size_t own_bytes)
    : engine_(engine_from(o)),
      max_steps_(max_steps),
      own_bytes_(own_bytes),
      made_(freed(config, std::move(scene))),
      scene_(make_scene(adjusted(&made_))),
      hands_(config, o, scene_, made_),
      teams_(hands_) {
  if (own_bytes % alignof(double) != 0)
    fail(Code::kInternal, "hand task: %zu bytes of its own state are not a multiple of %zu", own_bytes,
         alignof(double));
  const bool copied = left_is_copied(o);
  for (int32_t i = 0; i < config.count; ++i) {
    mirrors_[i] = i > 0 && !copied && hands_.hand(i).robot->arm_links == 0;
    cameras_.push_back(palm_camera(i));
  }
}

Vec3 HandTask::palm_point(int32_t i, const Vec3& p) const {
  const Robot& robot = *hands_.hand(i).robot;
  const Vec3 q = mirrors_[i] ? mirrored_point(p, robot.mirror) : p;
  return robot.palm < 0 ? robot.X_BR * q : q;
}

CameraSpec HandTask::palm_camera(int32_t i) const {
  const Hand& hand = hands_.hand(i);
  const Robot& robot = *hand.robot;
  const Vec3 z = robot.z_palm, y = -robot.n_palm, x = cross(y, z);
  const auto place = [&](const Vec3& p) { return palm_point(i, robot.p_hold + p.x * x + p.y * y + p.z * z); };
  const int32_t mount = robot.palm < 0 ? -(hand.articulation + 1) : hand.first + robot.palm + 1;
  return {i == 0 ? "right_palm" : "left_palm",  place(kEye), place(kTarget), kFov,
          palm_point(i, z) - palm_point(i, {}), mount};
}

}  // namespace rdm

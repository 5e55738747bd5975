#include "physics/kinematic_world.hpp"

#include "base/error.hpp"

namespace rdm {
namespace {

[[noreturn]] void refuse(const char* what) {
  fail(Code::kUnsupported, "%s is not possible: this task moves its bodies itself", what);
}

}  // namespace

KinematicWorld::KinematicWorld(const Scene& scene, Arena& arena) : World(scene, arena) {
  if (!scene.def.articulations.empty()) refuse("articulation");
  if (scene.def.adjustable) refuse("adjustable");
}

void KinematicWorld::set_base(int32_t, const Motion&) {
  refuse("set_base");
}
void KinematicWorld::push_body(int32_t, const Vec3&, const Vec3&) {
  refuse("push");
}
void KinematicWorld::push_link(int32_t, const Vec3&, const Vec3&) {
  refuse("push");
}
void KinematicWorld::push_base(int32_t, const Vec3&, const Vec3&) {
  refuse("push");
}

void KinematicWorld::save(Writer& out) const {
  out.bytes(bodies_, sizeof(Motion) * static_cast<size_t>(scene_->num_bodies));
}

void KinematicWorld::check(Reader& in) const {
  for (int32_t i = 0; i < scene_->num_bodies; ++i)
    if (!sound(in.value<Motion>()))
      fail(Code::kFormat, "world state: the motion of body %d is not finite or out of range", i);
}

void KinematicWorld::take(Reader& in) {
  in.bytes(bodies_, sizeof(Motion) * static_cast<size_t>(scene_->num_bodies));
}

}  // namespace rdm

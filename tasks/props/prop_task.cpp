#include "tasks/props/prop_task.hpp"

#include <utility>

namespace rdm {
namespace {

constexpr Vec3 kPalmPoint = {0, -0.02, 0.08};  // right hand: palmar is -y, fingers +z

constexpr OptionSpec kRows[] = {
    number_option("reset_noise", 0, 0, 0.5, "half width of the draw by which things start elsewhere, m"),
    number_option("joint_noise", 0, 0, 1, "share of each joint's range that is drawn at a reset"),
};

}  // namespace

void add_prop_options(const HandControlConfig& plan, int32_t max_steps, int32_t contacts_max,
                      OptionTable& table) {
  table.add(integer_option("max_steps", max_steps, 1, 100000, "control steps of an episode"));
  table.add(kRows);
  add_rig_options(plan, table);
  table.set_default("contacts_max", contacts_max);
}

PropTask::PropTask(const HandControlConfig& plan, const Options& o, SceneDef scene, size_t own_bytes)
    : HandTask(plan, o, std::move(scene), own_bytes),
      reset_noise_(o.number("reset_noise")),
      joint_noise_(o.number("joint_noise")) {
  rig().add_fields(own_fields());
  const bool copied = same_name(o.text("left_model"), "right_copy");
  for (int32_t i = 0; i < kMaxHands; ++i) {
    palms_[i] = rig().hand(i).first + kShadowHand.palm;
    palm_points_[i] = i == 0 || copied ? kPalmPoint : mirrored_point(kPalmPoint, kShadowHand.mirror);
  }
}

void PropTask::reset(World& world, void* state, Stream& stream) const {
  rig().reset(joint_noise_, false, world, rig_state(state), stream);
  if (reset_noise_ > 0) draw_places(world, stream);
  start(world, state);
}

void PropTask::draw_places(World& world, Stream& stream) const {
  const double dx = reset_noise_ * stream.signed_unit(), dy = reset_noise_ * stream.signed_unit();
  for (int32_t i = 0; i < scene().num_bodies; ++i) {
    Motion m = world.body(i);
    m.X.p += {dx, dy, 0};
    world.set_body(i, m);
  }
}

void PropTask::observe(const World& world, const void* state, float* obs) const {
  obs = rig().write(world, last_action(state), obs);
  write_props(world, state, obs);
}

Vec3 PropTask::tip(const World& world, int32_t hand, int32_t finger, double beyond) const {
  return world.link(rig().hand(hand).tips[finger]).X * Vec3{0, 0, beyond};
}

Vec3 PropTask::palm(const World& world, int32_t hand) const {
  return world.link(palms_[hand]).X * palm_points_[hand];
}

}  // namespace rdm

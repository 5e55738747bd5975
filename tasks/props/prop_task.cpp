#include "tasks/props/prop_task.hpp"

#include <utility>

namespace rdm {
namespace {

constexpr OptionSpec kRows[] = {
    number_option("reset_noise", 0, 0, 0.5,
                  "half width of the draw by which things start elsewhere, m; with joint_noise 0 too: one "
                  "start for all episodes"),
    number_option("joint_noise", 0, 0, 1, "share of each joint's range that is drawn at a reset"),
};

}  // namespace

void add_prop_options(const HandControlConfig& config, int32_t max_steps, int32_t contacts_max,
                      OptionTable& table) {
  table.add(integer_option("max_steps", max_steps, 1, 100000, "control steps of an episode"));
  table.add(kRows);
  add_hand_control_options(config, table);
  table.set_default("contacts_max", contacts_max);
}

PropTask::PropTask(const HandControlConfig& config, const Options& o, SceneDef scene, size_t own_bytes)
    : HandTask(config, o, std::move(scene), own_bytes),
      reset_noise_(o.number("reset_noise")),
      joint_noise_(o.number("joint_noise")) {
  hands().add_fields(own_fields());
  const bool copied = same_name(o.text("left_model"), "right_copy");
  for (int32_t i = 0; i < kMaxHands; ++i) {
    const Hand& hand = hands().hand(i);
    const Robot& robot = *hand.robot;
    palms_[i] = hand.first + robot.palm;
    palm_points_[i] = i == 0 || copied ? robot.p_hold : mirrored_point(robot.p_hold, robot.mirror);
  }
}

void PropTask::reset(World& world, void* state, Stream& stream) const {
  hands().reset(joint_noise_, false, world, control_state(state), stream);
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
  obs = hands().write(world, last_action(state), obs);
  write_props(world, state, obs);
}

Vec3 PropTask::tip(const World& world, int32_t hand, int32_t finger, double beyond) const {
  return world.link(hands().hand(hand).tips[finger]).X * Vec3{0, 0, beyond};
}

Vec3 PropTask::palm(const World& world, int32_t hand) const {
  return world.link(palms_[hand]).X * palm_points_[hand];
}

}  // namespace rdm

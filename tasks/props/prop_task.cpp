#include "tasks/props/prop_task.hpp"

#include <utility>

namespace rdm {
namespace {

constexpr auto kRows = option_rows<PropOptions>(
    row<&PropOptions::max_steps>(
        basic(integer_option("max_steps", 1, 1, 100000, "number of control steps in an episode"))),
    row<&PropOptions::reset_noise>(number_option("reset_noise", 0, 0, 0.5,
                                                 "half width of the uniform shift of each object's start, m; "
                                                 "0 with joint_noise=0: always the same start")),
    row<&PropOptions::joint_noise>(number_option(
        "joint_noise", 0, 0, 1, "share of each joint's range over which its start is drawn at a reset")));

}  // namespace

void add_prop_options(const HandControlConfig& config, int32_t max_steps, int32_t contacts_max,
                      OptionTable& table) {
  table.add(kRows.with<&PropOptions::max_steps>(max_steps));
  add_hand_control_options(config, table, contacts_max);
}

PropTask::PropTask(const HandControlConfig& config, const Options& o, HandScene scene, size_t own_bytes)
    : HandTask(config, o, kRows.read(o).max_steps, std::move(scene), own_bytes), options_(kRows.read(o)) {
  hands().add_fields(own_fields());
  for (int32_t i = 0; i < kMaxHands; ++i) {
    const Hand& hand = hands().hand(i);
    const Robot& robot = *hand.robot;
    palms_[i] = robot.palm < 0 ? kRootLink : hand.first + robot.palm;
    palm_points_[i] = palm_point(i, robot.p_hold);
    for (int32_t f = 0; f < hand.num_tips; ++f) {
      const Vec3 p = mirrors(i) ? mirrored_point(robot.tips[f].p_L, robot.mirror) : robot.tips[f].p_L;
      const double length = norm(p);
      tip_axes_[i][f] = length > 0 ? (1 / length) * p : Vec3{0, 0, 1};
    }
  }
}

void PropTask::reset(World& world, void* state, Stream& stream) const {
  hands().reset(options_.joint_noise, false, world, control_state(state), stream);
  if (options_.reset_noise > 0) draw_places(world, stream);
  start(world, state);
}

void PropTask::draw_places(World& world, Stream& stream) const {
  const double dx = options_.reset_noise * stream.signed_unit(),
               dy = options_.reset_noise * stream.signed_unit();
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
  return world.link(hands().hand(hand).tips[finger]).X * (beyond * tip_axes_[hand][finger]);
}

Vec3 PropTask::palm(const World& world, int32_t hand) const {
  const Pose& X =
      palms_[hand] < 0 ? world.base(hands().hand(hand).articulation).X : world.link(palms_[hand]).X;
  return X * palm_points_[hand];
}

void PropTask::push_palm(World& world, int32_t hand, const Vec3& force, const Vec3& p_W) const {
  if (palms_[hand] >= 0) return world.push_link(palms_[hand], force, p_W);
  const int32_t articulation = hands().hand(hand).articulation;
  if (!hands().flying(hand)) return;
  const Vec3& com = scene().def.articulations[static_cast<size_t>(articulation)].base.com;
  world.push_base(articulation, force, cross(p_W - world.base(articulation).X * com, force));
}

}  // namespace rdm

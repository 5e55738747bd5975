#include "tasks/throw/throw_setup.hpp"

#include "base/elementary.hpp"

namespace rdm {
namespace {

constexpr auto kRows = option_rows<ThrowOptions>(
    row<&ThrowOptions::fall_height>(
        number_option("fall_height", 0, -10, 10, "the episode ends when the object is below this height, m")),
    row<&ThrowOptions::joint_noise>(number_option(
        "joint_noise", 0.2, 0, 1, "share of each joint's range over which its start is drawn at a reset")),
    row<&ThrowOptions::joint_noise_literal, false, true>(
        legacy(text_option("joint_noise_mode", "one_sided", "one_sided|literal",
                           "draw of joint_noise: one_sided: in [0, 1), per hand; literal: in [-1, 1), the "
                           "same for both hands"))),
    row<&ThrowOptions::alpha>(
        number_option("alpha", 50, 0, 1000, "weight of the distance from the goal in the reward, 1/m")),
    row<&ThrowOptions::reward_scale>(
        basic(number_option("reward_scale", 1, 0, 1000, "factor on the whole reward"))),
    row<&ThrowOptions::ignore_rotation>(
        flag_option("ignore_rotation", false, "leave the rotation error out of the reward")),
    row<&ThrowOptions::success_distance>(
        basic(number_option("success_distance", 0.05, 0, 1,
                            "largest distance of the object from its goal that counts as success, m"))),
    row<&ThrowOptions::success_steps>(
        integer_option("success_steps", 10, 1, 1000,
                       "consecutive control steps within success_distance that make a success")),
    row<&ThrowOptions::max_steps>(
        basic(integer_option("max_steps", 75, 1, 100000, "number of control steps in an episode"))));

}  // namespace

void add_throw_options(const ObjectPlace& place, double fall_height, OptionTable& table) {
  add_object_options(place, table);
  table.add(kRows.with<&ThrowOptions::fall_height>(fall_height));
}

ThrowSetup throw_setup_from(const Options& o) {
  return {object_goal_from(o), kRows.read(o)};
}

ThrowMeasure measure_throw(const ThrowSetup& setup, const World& world, const ThrowState& state) {
  const Pose& X = world.body(0).X;
  return {norm(X.p - setup.goal),
          setup.ignore_rotation ? 0 : rotation_angle(rotation_error(setup, X.q, state))};
}

double throw_reward(const ThrowMeasure& m, double alpha, double scale) {
  return scale * elementary::exp(-0.2 * (alpha * m.distance + m.theta));
}

bool count_success(const ThrowSetup& setup, double distance, ThrowState* state) {
  state->near = distance <= setup.success_distance ? state->near + 1 : 0;
  return state->near >= setup.success_steps;
}

const CameraSpec kThrowCameras[8] = {
    {"front", {1.1, -0.5, 0.9}, {0, -0.5, 0.5}, 45 * kDegree},
    {"top", {0, -0.5, 1.8}, {0, -0.5, 0.5}, 45 * kDegree},
    {"right", {0.6, 0.3, 0.9}, {0, -0.4, 0.5}, 45 * kDegree},
    {"left", {0.6, -1.3, 0.9}, {0, -0.6, 0.5}, 45 * kDegree},
    {"close", {0.62, -0.34, 0.84}, {0, -0.5, 0.53}, 45 * kDegree},
    // close by, for point clouds
    {"cloud_above", {0, -0.5, 0.95}, {0, -0.5, 0.5}, 57 * kDegree},
    {"cloud_front", {0.4, -0.5, 0.75}, {0, -0.5, 0.5}, 57 * kDegree},
    {"cloud_back", {-0.4, -0.5, 0.75}, {0, -0.5, 0.5}, 57 * kDegree},
};

}  // namespace rdm

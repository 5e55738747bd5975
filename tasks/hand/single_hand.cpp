#include "tasks/hand/single_hand.hpp"

#include <algorithm>

namespace rdm {
namespace {

struct SingleHandOptions {
  double joint_noise;
  int32_t max_steps;
};
constexpr auto kRows = option_rows<SingleHandOptions>(
    row<&SingleHandOptions::joint_noise>(number_option(
        "joint_noise", 0, 0, 1, "share of each joint's range over which its start is drawn at a reset")),
    row<&SingleHandOptions::max_steps>(
        basic(integer_option("max_steps", 74, 1, 100000, "number of control steps in an episode"))));

HandScene make_scene_def(const SingleHandConfig& config, const Options& o) {
  HandScene s = make_hand_scene(config.hands, o);
  add_object(o, &s);
  return s;
}

}  // namespace

void add_single_hand_options(const SingleHandConfig& config, OptionTable& table) {
  add_object_options(config.place, table);
  table.add(kRows.with<&SingleHandOptions::joint_noise>(config.joint_noise));
  add_hand_control_options(config.hands, table);
}

SingleHand::SingleHand(const SingleHandConfig& config, const Options& o, size_t state_size)
    : HandTask(config.hands, o, kRows.read(o).max_steps, make_scene_def(config, o), state_size),
      joint_noise_(kRows.read(o).joint_noise),
      goal_(object_goal_from(o)) {
  goal_.standing = config.place.standing;
  FieldTable& fields = own_fields();
  add_joint_fields(hand(), fields, "right");
  add_goal_fields(fields);
  add_tip_fields(hand(), fields, "right");
  add_action_field(hand(), fields, "right", false);
}

void SingleHand::reset(World& world, void* state, Stream& stream) const {
  State& s = *static_cast<State*>(state);
  hands().reset(joint_noise_, false, world, control_state(state), stream);
  reset_object(goal_, world, &s.goal, stream);
  s.goals = Stream(stream.next(), 0, Purpose::kReset);
}

void SingleHand::check_own_state(const void* state) const {
  check_goal(static_cast<const State*>(state)->goal);
}

Verdict SingleHand::judge(World& world, void* state, int32_t) const {
  State& s = *static_cast<State*>(state);
  const HandControlState now = control_state(state);
  Verdict v;
  judge_step({world, now.command, now.action, &s}, &v);
  return v;
}

void SingleHand::observe(const World& world, const void* state, float* obs) const {
  const State& s = *static_cast<const State*>(state);
  const HandView hand = hands().view(world, last_action(state), 0);
  obs = write_joints(hand, obs);
  obs = write_goal(goal_, world, s.goal, obs);
  write_action(hand, write_tips(hand, obs));
}

void SingleHand::initial_mean(float* action) const {
  std::copy_n(initial_mean_, action_dim(), action);
}

}  // namespace rdm

#include "tasks/hand/single_hand.hpp"

#include <algorithm>

namespace rdm {
namespace {

constexpr OptionSpec kRows[] = {
    integer_option("max_steps", 74, 1, 100000, "control steps of an episode"),
};

SceneDef make_scene_def(const SingleHandConfig& plan, const Options& o) {
  SceneDef s = make_rig_scene(plan.rig, o);
  s.bodies.push_back(object_body_from(o));
  set_friction(&s, kObject, kGround, o.number("friction.object_ground"));
  return s;
}

}  // namespace

void add_single_hand_options(const SingleHandConfig& plan, OptionTable& table) {
  add_object_options(plan.place, table);
  table.add(number_option("joint_noise", plan.joint_noise, 0, 1,
                          "share of each joint's range that is drawn at a reset"));
  table.add(kRows);
  add_rig_options(plan.rig, table);
}

SingleHand::SingleHand(const SingleHandConfig& plan, const Options& o)
    : HandTask(plan.rig, o, make_scene_def(plan, o), sizeof(State)),
      joint_noise_(o.number("joint_noise")),
      goal_(object_goal_from(o)) {
  FieldTable& fields = own_fields();
  add_joint_fields(fields, "right");
  add_goal_fields(fields);
  add_tip_fields(fields, "right");
  add_action_field(fields, "right", false);
}

void SingleHand::reset(World& world, void* state, Stream& stream) const {
  State& s = *static_cast<State*>(state);
  rig().reset(joint_noise_, false, world, rig_state(state), stream);
  reset_object(goal_, world, &s.goal, stream);
  s.goals = Stream(stream.next(), 0, Purpose::kReset);
}

void SingleHand::check_own_state(const void* state) const {
  check_goal(static_cast<const State*>(state)->goal);
}

Verdict SingleHand::judge(World& world, void* state, int32_t) const {
  State& s = *static_cast<State*>(state);
  const RigState rig = rig_state(state);
  Verdict v;
  judge_step({world, rig.command, rig.action, &s}, &v);
  return v;
}

void SingleHand::observe(const World& world, const void* state, float* obs) const {
  const State& s = *static_cast<const State*>(state);
  const HandView hand = rig().view(world, last_action(state), 0);
  obs = write_joints(hand, obs);
  obs = write_goal(goal_, world, s.goal, obs);
  write_action(hand, write_tips(hand, obs));
}

void SingleHand::initial_mean(float* action) const {
  std::copy(std::begin(initial_mean_), std::end(initial_mean_), action);
}

}  // namespace rdm

#include "tasks/single_hand.hpp"

#include <algorithm>

#include "env/sim_options.hpp"

namespace rdm {
namespace {

constexpr OptionSpec kRows[] = {
    integer_option("max_steps", 74, 1, 100000, "control steps of an episode"),
};

SceneDef make_scene_def(const SingleHandPlan& plan, const Options& o) {
  SceneDef s = make_rig_scene(plan.rig, o);
  s.bodies.push_back(object_body_from(o));
  set_friction(&s, kObject, kGround, o.number("friction.object_ground"));
  return s;
}

}  // namespace

void add_single_hand_options(const SingleHandPlan& plan, OptionTable& table) {
  add_object_options(plan.place, table);
  table.add(number_option("joint_noise", plan.joint_noise, 0, 1,
                          "share of each joint's range that is drawn at a reset"));
  table.add(kRows);
  add_rig_options(plan.rig, table);
}

SingleHand::SingleHand(const SingleHandPlan& plan, const Options& o)
    : engine_(engine_from(o)),
      max_steps_(o.integer("max_steps")),
      joint_noise_(o.number("joint_noise")),
      scene_(make_scene(make_scene_def(plan, o))),
      rig_(plan.rig, o, scene_),
      goal_(object_goal_from(o)) {
  add_joint_fields(fields_, "right");
  add_goal_fields(fields_);
  add_tip_fields(fields_, "right");
  add_action_field(fields_, "right", false);
}

void SingleHand::reset(World& world, void* state, Stream& stream) const {
  State& s = *static_cast<State*>(state);
  rig_.reset(joint_noise_, false, world, rig_.state(&s + 1), stream);
  reset_object(goal_, world, &s.goal, stream);
  s.goals = Stream(stream.next(), 0, Purpose::kReset);
}

void SingleHand::control(World& world, void* state, const float* action) const {
  rig_.control(world, rig_.state(static_cast<State*>(state) + 1), action);
}

Verdict SingleHand::judge(World& world, void* state, int32_t) const {
  State& s = *static_cast<State*>(state);
  const RigState rig = rig_.state(&s + 1);
  Verdict v;
  judge_step({world, rig.command, rig.action, &s}, &v);
  return v;
}

void SingleHand::observe(const World& world, const void* state, float* obs) const {
  const State& s = *static_cast<const State*>(state);
  const HandView hand = rig_.view(world, rig_.action(&s + 1), 0);
  obs = write_joints(hand, obs);
  obs = write_goal(goal_, world, s.goal, obs);
  write_action(hand, write_tips(hand, obs));
}

void SingleHand::initial_mean(float* action) const {
  std::copy(std::begin(initial_mean_), std::end(initial_mean_), action);
}

}  // namespace rdm

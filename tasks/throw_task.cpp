#include "tasks/throw_task.hpp"

#include <algorithm>

#include "env/sim_options.hpp"

namespace rdm {

void add_throw_task_options(const ThrowPlan& plan, OptionTable& table) {
  add_throw_options(plan.place, plan.fall_height, table);
  if (plan.rig.flying)
    table.add(number_option("base_limit", plan.base_limit, 0, 100,
                            "the episode ends with a base so far from its start, m"));
  add_rig_options(plan.rig, table);
}

SceneDef make_throw_scene(const ThrowPlan& plan, const Options& o, int32_t num_materials) {
  SceneDef s = make_rig_scene(plan.rig, o, num_materials);
  s.bodies.push_back(object_body_from(o));
  set_friction(&s, kObject, kGround, o.number("friction.object_ground"));
  return s;
}

void flat_throw_mean(const HandRig& rig, bool window, float* mean) {
  constexpr float kWristSide = 0.55f, kWristFlex = 0.18f, kBent = -0.4f;
  constexpr int kThumb = 15, kLateral[] = {2, 5, 8, 12};
  float *right = mean + rig.joint_entries(0), *left = mean + rig.joint_entries(1);
  std::fill(right + 2, right + kThumb, -1.0f);
  for (const int i : kLateral) right[i] = 0;
  if (window) right[3] = right[4] = kBent;
  right[0] = left[0] = kWristSide;
  right[1] = left[1] = kWristFlex;
}

ThrowTask::ThrowTask(const ThrowPlan& plan, const Options& o, SceneDef scene)
    : engine_(engine_from(o)),
      max_steps_(o.integer("max_steps")),
      base_limit_(plan.rig.flying ? o.number("base_limit") : 0),
      scene_(make_scene(std::move(scene))),
      rig_(plan.rig, o, scene_),
      game_(throw_game_from(o)) {
  rig_.add_fields(fields_);
  add_goal_fields(fields_);
}

void ThrowTask::reset(World& world, void* state, Stream& stream) const {
  State& s = *static_cast<State*>(state);
  rig_.reset(game_.joint_noise, game_.joint_noise_literal, world, rig_.state(&s + 1), stream);
  reset_object(game_, world, &s.game, stream);
}

void ThrowTask::control(World& world, void* state, const float* action) const {
  rig_.control(world, rig_.state(static_cast<State*>(state) + 1), action);
}

Verdict ThrowTask::judge(World& world, void* state, int32_t) const {
  State& s = *static_cast<State*>(state);
  const RigState rig = rig_.state(&s + 1);
  Verdict v;
  const ThrowMeasure m = measure_throw(game_, world, s.game);
  v.reward = throw_reward(m, game_.alpha, game_.reward_scale);
  v.success = count_success(game_, m.distance, &s.game);
  v.terminated = world.body(0).X.p.z <= game_.fall_height;
  if (rig_.flying() && rig_.strayed(world) > base_limit_) v.terminated = true;
  judge_costs({world, rig.command, rig.action, &s.release}, &v);
  return v;
}

void ThrowTask::observe(const World& world, const void* state, float* obs) const {
  const State& s = *static_cast<const State*>(state);
  obs = rig_.write(world, rig_.action(&s + 1), obs);
  write_goal(game_, world, s.game, obs);
}

}  // namespace rdm

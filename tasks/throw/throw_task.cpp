#include "tasks/throw/throw_task.hpp"

#include <algorithm>
#include <utility>

#include "tasks/state_check.hpp"

namespace rdm {

void add_throw_task_options(const ThrowConfig& plan, OptionTable& table) {
  add_throw_options(plan.place, plan.fall_height, table);
  if (plan.rig.flying)
    table.add(number_option("base_limit", plan.base_limit, 0, 100,
                            "the episode ends with a base so far from its start, m"));
  add_rig_options(plan.rig, table);
}

SceneDef make_throw_scene(const ThrowConfig& plan, const Options& o, int32_t num_materials) {
  SceneDef s = make_rig_scene(plan.rig, o, num_materials);
  s.bodies.push_back(object_body_from(o));
  set_friction(&s, kObject, kGround, o.number("friction.object_ground"));
  return s;
}

void flat_hand_mean(const HandControl& rig, bool window, float* mean) {
  constexpr float kBent = -0.4f;
  constexpr int kThumb = 15, kLateral[] = {2, 5, 8, 12};
  float* right = mean + rig.joint_entries(0);
  std::fill(right + 2, right + kThumb, -1.0f);
  for (const int i : kLateral) right[i] = 0;
  if (window) right[3] = right[4] = kBent;
}

void flat_throw_mean(const HandControl& rig, bool window, float* mean) {
  constexpr float kWristSide = 0.55f, kWristFlex = 0.18f;
  flat_hand_mean(rig, window, mean);
  for (float* hand : {mean + rig.joint_entries(0), mean + rig.joint_entries(1)}) {
    hand[0] = kWristSide;
    hand[1] = kWristFlex;
  }
}

ThrowTask::ThrowTask(const ThrowConfig& plan, const Options& o, SceneDef scene)
    : HandTask(plan.rig, o, std::move(scene), sizeof(State)),
      base_limit_(plan.rig.flying ? o.number("base_limit") : 0),
      game_(throw_game_from(o)) {
  rig().add_fields(own_fields());
  add_goal_fields(own_fields());
}

void ThrowTask::choose_mean(const char* word, void (*flat)(const HandControl&, bool, float*), bool window) {
  if (same_name(word, "hold"))
    rig().hold(initial_mean_);
  else if (!same_name(word, "zero"))
    flat(rig(), window, initial_mean_);
}

void ThrowTask::reset(World& world, void* state, Stream& stream) const {
  State& s = *static_cast<State*>(state);
  rig().reset(game_.joint_noise, game_.joint_noise_literal, world, rig_state(state), stream);
  reset_object(game_, world, &s.game, stream);
}

void ThrowTask::check_own_state(const void* state) const {
  const State& s = *static_cast<const State*>(state);
  check_goal(s.game);
  check_integer("near", s.game.near, 0, max_steps());
  check_integer("touching", s.release.touching, 0, 1);
  check_integer("thrown", s.release.thrown, 0, 1);
}

Verdict ThrowTask::judge(World& world, void* state, int32_t) const {
  State& s = *static_cast<State*>(state);
  const RigState now = rig_state(state);
  Verdict v;
  const ThrowMeasure m = measure_throw(game_, world, s.game);
  v.reward = throw_reward(m, game_.alpha, game_.reward_scale);
  v.success = count_success(game_, m.distance, &s.game);
  v.terminated = world.body(0).X.p.z <= game_.fall_height;
  if (rig().flying() && rig().strayed(world) > base_limit_) v.terminated = true;
  judge_costs({world, now.command, now.action, &s.release}, &v);
  return v;
}

void ThrowTask::observe(const World& world, const void* state, float* obs) const {
  const State& s = *static_cast<const State*>(state);
  obs = rig().write(world, last_action(state), obs);
  write_goal(game_, world, s.game, obs);
}

}  // namespace rdm

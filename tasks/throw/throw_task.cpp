#include "tasks/throw/throw_task.hpp"

#include <algorithm>
#include <utility>

#include "tasks/state_check.hpp"

namespace rdm {
namespace {

struct BaseOptions {
  double base_limit;  // m
};
constexpr auto kBaseRows = row<&BaseOptions::base_limit>(basic(number_option(
    "base_limit", 0, 0, 100, "the episode ends when a base is farther than this from its start, m")));

}  // namespace

void add_throw_task_options(const ThrowConfig& config, OptionTable& table) {
  add_throw_options(config.place, config.fall_height, table);
  if (config.hands.flying) table.add(kBaseRows.with<&BaseOptions::base_limit>(config.base_limit));
  add_hand_control_options(config.hands, table);
}

HandScene make_throw_scene(const ThrowConfig& config, const Options& o, int32_t num_materials) {
  HandScene s = make_hand_scene(config.hands, o, num_materials);
  add_object(o, &s);
  return s;
}

namespace {

// The command that straightens a finger's joint: at 0 it is straight, and a range may begin below.
float straight(const Hand& hand, int32_t link) {
  const int32_t entry = hand.robot->action_of(link);
  if (entry < 0 || !(hand.lower[link] < 0 && hand.upper[link] > 0)) return -1;
  return static_cast<float>(hand.command(entry, 0));
}

}  // namespace

void flat_hand_mean(const HandControl& hands, FirstFinger first, float* mean) {
  constexpr float kBent = -0.4f;
  const Robot& robot = *hands.hand(0).robot;
  const auto command = [&](int32_t link, float value) {
    if (const int32_t entry = hands.entry(0, robot.action_of(link)); entry >= 0) mean[entry] = value;
  };
  for (int32_t f = 0; f < robot.fingers.count; ++f) {
    const RobotFinger& finger = robot.fingers[f];
    if (finger.thumb) continue;
    for (int32_t link = finger.first; link <= robot.tips[f].link; ++link)
      command(link, straight(hands.hand(0), link));
    command(finger.lateral, 0);
  }
  const RobotFinger& finger = robot.fingers[0];
  if (first == FirstFinger::kBent)
    for (const int32_t link : {finger.proximal, finger.middle}) command(link, kBent);
  if (first == FirstFinger::kStart)
    for (const int32_t link : {finger.lateral, finger.proximal, finger.middle})
      if (const int32_t k = robot.action_of(link); k >= 0)
        command(link, static_cast<float>(hands.hand(0).command(k, hands.start(0, link))));
}

void flat_throw_mean(const HandControl& hands, FirstFinger first, float* mean) {
  constexpr float kWristSide = 0.55f, kWristFlex = 0.18f;
  flat_hand_mean(hands, first, mean);
  for (int32_t i = 0; i < hands.count(); ++i) {
    const Robot& robot = *hands.hand(i).robot;
    const int32_t flex = hands.entry(i, robot.action_of(robot.wrist_flexion())),
                  side = hands.entry(i, robot.action_of(robot.wrist_deviation()));
    if (side >= 0) mean[side] = kWristSide;
    if (flex >= 0) mean[flex] = kWristFlex;
  }
}

ThrowTask::ThrowTask(const ThrowConfig& config, const Options& o, HandScene scene)
    : HandTask(config.hands, o, throw_setup_from(o).max_steps, std::move(scene), sizeof(State)),
      base_limit_(config.hands.flying ? kBaseRows.read(o).base_limit : 0),
      setup_(throw_setup_from(o)) {
  hands().add_fields(own_fields());
  add_goal_fields(own_fields());
}

void ThrowTask::choose_mean(ThrowMean mean, void (*flat)(const HandControl&, FirstFinger, float*),
                            FirstFinger first) {
  if (mean == ThrowMean::kHold)
    hands().hold(initial_mean_);
  else
    hands().hold_arms(initial_mean_);
  if (mean != ThrowMean::kHold && mean != ThrowMean::kZero) flat(hands(), first, initial_mean_);
}

void ThrowTask::reset(World& world, void* state, Stream& stream) const {
  State& s = *static_cast<State*>(state);
  hands().reset(setup_.joint_noise, setup_.joint_noise_literal, world, control_state(state), stream);
  reset_object(setup_, world, &s.progress, stream);
}

void ThrowTask::check_own_state(const void* state) const {
  const State& s = *static_cast<const State*>(state);
  check_goal(s.progress);
  check_integer("near", s.progress.near, 0, max_steps());
  check_integer("touching", s.release.touching, 0, 1);
  check_integer("thrown", s.release.thrown, 0, 1);
}

Verdict ThrowTask::judge(World& world, void* state, int32_t) const {
  State& s = *static_cast<State*>(state);
  const HandControlState now = control_state(state);
  Verdict v;
  const ThrowMeasure m = measure_throw(setup_, world, s.progress);
  v.reward = throw_reward(m, setup_.alpha, setup_.reward_scale);
  v.success = count_success(setup_, m.distance, &s.progress);
  v.terminated = world.body(0).X.p.z <= setup_.fall_height;
  if (hands().flying() && hands().base_displacement(world) > base_limit_) v.terminated = true;
  judge_costs({world, now.command, now.action, &s.release}, &v);
  return v;
}

void ThrowTask::observe(const World& world, const void* state, float* obs) const {
  const State& s = *static_cast<const State*>(state);
  obs = hands().write(world, last_action(state), obs);
  write_goal(setup_, world, s.progress, obs);
}

}  // namespace rdm

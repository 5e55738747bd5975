// Safety-Gymnasium's SwimmerVelocity: swim along x, but slower than the limit.
//
//   r = v - 1e-4 |a|^2     v: mean speed of the free end along x over the step, m/s
//   c = [v > 0.2282]
#include "tasks/catalog.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/planar/planar_scene.hpp"
#include "tasks/planar/swimmer_body.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kHeight = kSwimmerRadius;  // m, of the axes in pictures

struct State {
  SwimmerState swimmer;
  double speed;   // m/s, mean over the control step
  double effort;  // sum of squared actions
};

struct SwimmerOptions {
  double speed_limit, effort_weight, reset_noise;
  int32_t max_steps;
};
constexpr auto kRows = option_rows<SwimmerOptions>(
    row<&SwimmerOptions::speed_limit>(
        basic(number_option("speed_limit", 0.2282, 0, 100, "speed along x above which a step costs 1, m/s"))),
    row<&SwimmerOptions::effort_weight>(
        basic(number_option("effort_weight", 1e-4, 0, 10, "weight of the squared action in the reward"))),
    row<&SwimmerOptions::reset_noise>(number_option(
        "reset_noise", 0.1, 0, 1,
        "half width of the uniform noise on start positions (m, rad) and velocities (m/s, rad/s)")),
    row<&SwimmerOptions::max_steps>(
        basic(integer_option("max_steps", 1000, 1, 100000, "number of control steps in an episode"))));

class SwimmerVelocity final : public PlanarTask {
 public:
  explicit SwimmerVelocity(const SwimmerOptions& o)
      : PlanarTask(make(), o.max_steps,
                   {{"joint_position", "rad", 3}, {"velocity", "m/s", 2}, {"joint_velocity", "rad/s", 3}}),
        options_(o) {}

  int32_t action_dim() const override { return kSwimmerMotors; }
  const char* action_order() const override { return "joint 1, joint 2"; }
  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    check_numbers("joint positions", s.swimmer.q, kSwimmerDofs);
    check_numbers("joint velocities", s.swimmer.qd, kSwimmerDofs);
    check_numbers("speed", &s.speed, 1);
    check_numbers("effort", &s.effort, 1);
  }

  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    for (double& q : s.swimmer.q) q = options_.reset_noise * stream.signed_unit();
    for (double& qd : s.swimmer.qd) qd = options_.reset_noise * stream.signed_unit();
    place(world, s.swimmer);
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    const double before = s.swimmer.q[0];
    body_.advance(action, &s.swimmer);
    s.speed = (s.swimmer.q[0] - before) / kSwimmerControlDt;
    s.effort = 0;
    for (int i = 0; i < kSwimmerMotors; ++i)
      s.effort += static_cast<double>(action[i]) * static_cast<double>(action[i]);
    place(world, s.swimmer);
  }

  Verdict judge(World&, void* state, int32_t) const override {
    const State& s = *static_cast<State*>(state);
    Verdict v;
    v.reward = s.speed - options_.effort_weight * s.effort;
    v.cost_raw[0] = s.speed;
    v.cost[0] = s.speed > options_.speed_limit;
    v.success = s.speed > 0.5 * options_.speed_limit && s.speed <= options_.speed_limit;
    return v;
  }

  void observe(const World&, const void* state, float* obs) const override {
    const SwimmerState& s = static_cast<const State*>(state)->swimmer;
    for (int i = 2; i < kSwimmerDofs; ++i) *obs++ = static_cast<float>(s.q[i]);
    for (const double qd : s.qd) *obs++ = static_cast<float>(qd);
  }

 private:
  static Scene make() {
    PlanarScene scene(kSwimmerControlDt);
    const Pose lying{{}, axis_angle({0, 1, 0}, kPi / 2)};
    const char* names[kSwimmerLinks] = {"front", "middle", "back"};
    const Color colors[kSwimmerLinks] = {kMarkYellow, kMarkBlue, kMarkCyan};
    for (int i = 0; i < kSwimmerLinks; ++i)
      scene.body(names[i], ShapeKind::kCapsule, {kSwimmerRadius, 0.5 * kSwimmerLength, 0}, colors[i], lying);
    for (int x = 0; x <= 100; x += 5) scene.disc("metres", 0.15, kMarkGrey, x, 0);
    return scene.build();
  }
  static void place(World& world, const SwimmerState& s) {
    for (int i = 0; i < kSwimmerLinks; ++i) {
      const SwimmerLink link = swimmer_link(s, i);
      world.set_body(i, planar_motion({link.x, link.y, kHeight}, link.angle));
    }
  }

  SwimmerBody body_;
  SwimmerOptions options_;
};

constexpr CostSpec kCosts[] = {
    {"cost", "1 if the robot is above the speed limit; raw: its speed along x, m/s", 25}};
constexpr CameraSpec kCameras[] = {
    {"front", {2, -7, 5}, {2, 0, 0}, 0.9},
    {"top", {2, -0.01, 10}, {2, 0, 0}, 0.9},
};
constexpr auto kDefaults = join_defaults(kSafetyLearner, {{"horizon", "500"},
                                                          {"learning_rate", "1e-3"},
                                                          {"minibatches", "64"},
                                                          {"discount", "0.995"},
                                                          {"ppo:discount", "0.999"},
                                                          {"trpo:action_repeat", "4"},
                                                          {"trpo:horizon", "250"},
                                                          {"trpo:trust_kl", "0.03"},
                                                          {"trpo:discount", "0.999"},
                                                          {"init_std", "0.6"},
                                                          {"std_min", "0.05"},
                                                          {"multiplier_init", "0.3"},
                                                          {"multiplier_lr", "0.05"},
                                                          {"trpo_lag:multiplier_lr", "0.1"},
                                                          {"trpo_lag:lr_schedule", "constant"},
                                                          {"cpo:trust_kl", "0.02"},
                                                          {"cpo:violation_scale", "discount"},
                                                          {"cpo:multiplier_window", "16"},
                                                          {"cpo:lr_schedule", "constant"}});

}  // namespace

constinit const TaskInfo kSwimmerVelocity = task_info<SwimmerVelocity, kRows, kCosts, kCameras, kDefaults>(
    "swimmer_velocity", "SwimmerVelocity",
    "a three-link swimmer swims along x; cost: faster than 0.2282 m/s");

}  // namespace rdm

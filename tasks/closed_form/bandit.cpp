// Gaussian bandit: one step per episode, nothing to see, reward -(a - target)^2, cost max(a, 0).
//
// With the limit d on the cost the best action is min(target, d), its multiplier max(0, 2 (target - d)). For
// a drawn from N(m, s^2) the expectations are
//   E r = -(m - target)^2 - s^2,   E c = m Phi(m/s) + s phi(m/s)
// with the normal distribution Phi and its density phi: for s = 0.5, where learning starts and stays, the
// limit 1 is met by m = 0.99566 with E r = -1.2587 (m = 1 has cost 1.0042).
#include <algorithm>

#include "tasks/catalog.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/planar/planar_scene.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kRadius = 0.2;  // m, of the ball in pictures, which stands at x = a
constexpr double kNear = 0.1;
constexpr double kLimit = 1;

struct BanditOptions {
  double target, action_scale;
};
constexpr auto kRows = option_rows<BanditOptions>(
    row<&BanditOptions::target>(basic(number_option("target", 2, -4, 4, "action with the highest reward"))),
    row<&BanditOptions::action_scale>(
        basic(number_option("action_scale", 5, 0.1, 100, "choice that an action entry of 1 stands for"))));

struct State {
  double a;
};

class Bandit final : public PlanarTask {
 public:
  explicit Bandit(const BanditOptions& o)
      : PlanarTask(make(o.target), 1, {{"constant", "1", 1, 1, 1}}), options_(o) {}

  int32_t action_dim() const override { return 1; }
  const char* action_order() const override { return "a"; }
  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    check_numbers("a", &static_cast<const State*>(state)->a, 1);
  }
  void reset(World&, void*, Stream&) const override {}

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    s.a = options_.action_scale * static_cast<double>(action[0]);
    world.set_body(0, planar_motion({s.a, 0, kRadius}, 0));
  }

  Verdict judge(World&, void* state, int32_t) const override {
    const double a = static_cast<State*>(state)->a;
    Verdict v;
    v.reward = -(a - options_.target) * (a - options_.target);
    v.cost[0] = std::max(a, 0.0);
    v.cost_raw[0] = a;
    v.success = std::fabs(a - std::min(options_.target, kLimit)) <= kNear;
    v.terminated = true;
    return v;
  }

  void observe(const World&, const void*, float* obs) const override { obs[0] = 1; }

 private:
  static Scene make(double target) {
    return PlanarScene(1)
        .body("choice", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkBlue, {})
        .disc("target", 2 * kRadius, kMarkGreen, target, 0)
        .disc("limit", 2 * kRadius, kMarkYellow, kLimit, 0)
        .build();
  }
  BanditOptions options_;
};

constexpr CostSpec kCosts[] = {{"cost", "the action a if it is positive, else 0; raw: a", kLimit}};
constexpr CameraSpec kCameras[] = {
    {"front", {1, -5, 3}, {1, 0, 0}, 0.8},
    {"top", {1, -0.01, 7}, {1, 0, 0}, 0.8},
};
constexpr auto kDefaults = join_defaults(kKnownLearner, {{"horizon", "128"},
                                                         {"minibatches", "8"},
                                                         {"passes", "5"},
                                                         {"discount", "1"},
                                                         {"lambda", "1"},
                                                         {"cost_lambda", "1"},
                                                         {"init_std", "0.1"},
                                                         {"learning_rate", "1e-3"},
                                                         {"multiplier_init", "1"},
                                                         {"multiplier_lr", "0.1"},
                                                         {"multiplier_window", "2000"},
                                                         {"cost_limit", "1"}});

}  // namespace

constinit const TaskInfo kBandit = task_info<Bandit, kRows, kCosts, kCameras, kDefaults>(
    "bandit", nullptr,
    "a bandit with one choice per episode; reward -(a - 2)^2, cost max(a, 0); the optimum is known");

}  // namespace rdm

// A point on a line: x' = x + a + noise, reward -(x^2 + 0.1 a^2), cost a^2, start N(0, 1), 20 steps.
//
// The point starts anew each episode; positions and displacements are in m.
//
// For actions drawn from N(-k x, 0.1^2): without a limit the best k is 0.915, return -1.52626 at cost
// 1.36366; limit 1: k 0.734456, return -1.583058; limit 0.75: k 0.571281, return -1.760243.
#include "tasks/catalog.hpp"
#include "tasks/closed_form/sampled_task.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kRadius = 0.1;  // m, of the point in pictures
constexpr double kNear = 0.2;

struct LqrOptions {
  double action_scale, noise, effort;
  int32_t max_steps;
};
constexpr auto kRows = option_rows<LqrOptions>(
    row<&LqrOptions::action_scale>(
        basic(number_option("action_scale", 5, 0.1, 100, "displacement by an action entry of 1, m"))),
    row<&LqrOptions::noise>(
        basic(number_option("noise", 0.1, 0, 10, "standard deviation of the noise on the position, m"))),
    row<&LqrOptions::effort>(
        basic(number_option("effort", 0.1, 0, 10, "weight of the squared action in the reward"))),
    row<&LqrOptions::max_steps>(
        basic(integer_option("max_steps", 20, 1, 100000, "number of control steps in an episode"))));

struct State {
  Stream noise;
  double x, reward, cost;
};

double normal(Stream& stream) {
  float out = 0;
  stream.normals(&out, 1);
  return static_cast<double>(out);
}

class LqrLine final : public SampledTask<State> {
 public:
  explicit LqrLine(const LqrOptions& o)
      : SampledTask(PlanarScene(1)
                        .body("point", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkBlue)
                        .disc("goal", 2 * kRadius, kMarkGreen, 0, 0)
                        .build(),
                    o.max_steps, {{"position", "m", 1}}),
        options_(o) {}

  const char* action_order() const override { return "displacement"; }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    constexpr double kMaxSquare = kMaxStateNumber * kMaxStateNumber;
    check_numbers("x", &s.x, 1);
    check_numbers("reward", &s.reward, 1, kMaxSquare);
    check_numbers("cost", &s.cost, 1, kMaxSquare);
  }

  void observe(const World&, const void* state, float* obs) const override {
    obs[0] = static_cast<float>(static_cast<const State*>(state)->x);
  }

 private:
  void start(State* s) const override { s->x = normal(s->noise); }

  void take(const float* action, State* s) const override {
    const double a = options_.action_scale * static_cast<double>(action[0]);
    s->reward = -(s->x * s->x + options_.effort * a * a);
    s->cost = a * a;
    s->x += a + options_.noise * normal(s->noise);
  }

  void judge_place(const State& s, Verdict* v) const override { v->success = std::fabs(s.x) <= kNear; }

  void place(World& world, const State& s) const override {
    world.set_body(0, planar_motion({s.x, 0, kRadius}, 0));
  }
  LqrOptions options_;
};

constexpr CostSpec kCosts[] = {{"cost", "squared displacement a^2, m2", 1}};
constexpr CameraSpec kCameras[] = {
    {"front", {0, -4, 2}, {0, 0, 0}, 0.8},
    {"top", {0, -0.01, 5}, {0, 0, 0}, 0.8},
};
constexpr auto kDefaults = join_defaults(kKnownLearner, {{"horizon", "140"},
                                                         {"minibatches", "8"},
                                                         {"passes", "10"},
                                                         {"discount", "0.95"},
                                                         {"lambda", "0.95"},
                                                         {"cost_lambda", "0.95"},
                                                         {"init_std", "0.02"},
                                                         {"learning_rate", "2e-3"},
                                                         {"multiplier_init", "3"},
                                                         {"multiplier_lr", "0.1"},
                                                         {"multiplier_window", "400"},
                                                         {"cost_limit", "1"}});

}  // namespace

constinit const TaskInfo kLqrLine = task_info<LqrLine, kRows, kCosts, kCameras, kDefaults>(
    "lqr_line", nullptr, "bring a point on a line to 0 with little effort; the optimum is known");

}  // namespace rdm

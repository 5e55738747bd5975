// A cue at the first step, a choice at the last: what a policy without a memory cannot do.
//
// The cue is +1 or -1 with probability 1/2 each and is seen at the first step alone. At step `delay` the entry
// `choose` is 1, and the sign of the action is the choice: reward 1 if it is the cue's, else 0, and cost 1 if it is
// +1. All steps before have reward and cost 0. With a memory the optimum is return 1 at cost 0.5, under a limit d <
// 0.5 it is 0.5 + d; without one the return is 0.5 whatever is done, and at most d under a limit d on the cost
// (choose +1 with probability d) adds nothing.
#include "tasks/catalog.hpp"
#include "tasks/closed_form/sampled_task.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kRadius = 0.2;  // m, of the token in pictures

struct RecallOptions {
  int32_t delay;
};
constexpr auto kRows = option_rows<RecallOptions>(row<&RecallOptions::delay>(basic(integer_option(
    "delay", 20, 1, 100000, "number of control steps in an episode: the choice is at the last"))));

struct State {
  Stream noise;
  double reward, cost;
  int32_t cue, step, right, padding;
};

class Recall final : public SampledTask<State> {
 public:
  explicit Recall(const RecallOptions& o)
      : SampledTask(PlanarScene(1)
                        .body("token", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkBlue)
                        .disc("minus", 2 * kRadius, kMarkRed, -1, 0)
                        .disc("plus", 2 * kRadius, kMarkGreen, 1, 0)
                        .build(),
                    o.delay, {{"cue", "1", 1, -1, 1}, {"choose", "1", 1, 0, 1}}),
        delay_(o.delay) {}

  const char* action_order() const override { return "choice"; }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    check_numbers("reward", &s.reward, 1);
    check_numbers("cost", &s.cost, 1);
    check_integer("cue", s.cue, -1, 1);
    check_integer("step", s.step, 0, delay_);
    check_integer("right", s.right, 0, 1);
  }

  void observe(const World&, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    obs[0] = s.step == 0 ? static_cast<float>(s.cue) : 0;
    obs[1] = s.step == delay_ - 1;
  }

 private:
  void start(State* s) const override {
    s->cue = s->noise.uniform() < 0.5 ? -1 : 1;
    s->step = s->right = 0;
    s->reward = s->cost = 0;
  }

  void take(const float* action, State* s) const override {
    if (s->step >= delay_) return;  // an episode that is over
    const bool chooses = ++s->step == delay_, plus = action[0] > 0;
    s->right = chooses && plus == (s->cue > 0);
    s->reward = s->right;
    s->cost = chooses && plus;
  }

  void judge_place(const State& s, Verdict* v) const override {
    v->success = s.right != 0;
    v->terminated = s.step == delay_;
  }

  // The token shows the cue while it is seen, and the choice where it was right.
  void place(World& world, const State& s) const override {
    const double x = s.step == 0 || s.right ? s.cue : 0;
    world.set_body(0, planar_motion({x, 0, kRadius}, 0));
  }
  int32_t delay_;
};

constexpr CostSpec kCosts[] = {{"cost", "1 for the choice +1", 0.6}};
constexpr auto kDefaults = join_defaults(kKnownLearner, {{"horizon", "80"},
                                                         {"minibatches", "8"},
                                                         {"passes", "5"},
                                                         {"discount", "1"},
                                                         {"lambda", "0.95"},
                                                         {"cost_lambda", "0.95"},
                                                         {"init_std", "0.6"},
                                                         {"learning_rate", "1e-3"},
                                                         {"memory_chunk", "20"},
                                                         {"cg_damping", "1e-3"},
                                                         {"multiplier_init", "0"},
                                                         {"multiplier_lr", "0.02"},
                                                         {"multiplier_window", "400"},
                                                         {"cost_limit", "0.6"}});

}  // namespace

constinit const TaskInfo kRecall = task_info<Recall, kRows, kCosts, kSampledCameras, kDefaults>(
    "recall", nullptr, "a cue at the first step, a choice at the last: needs a memory; the optimum is known");

}  // namespace rdm

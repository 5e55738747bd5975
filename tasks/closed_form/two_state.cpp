// A constrained Markov decision process of two states, solved by a linear programme. The action is one bit:
// a = 1 where the entry is positive. Each step ends the episode with probability 0.1.
//
// Without a limit: always a = 1, return 17.912088 at cost 8.329670. Limit 2.5: return 9.687058 with
// P(a = 1 | 0) = 1 and P(a = 1 | 1) = 0.294079.
//
// With show_every = k the state is seen in every k-th step alone, the first one included, and the task needs a memory:
// what is known of the state is the last one that was seen, and the choices since. For a multiplier l the best policy
// is one of 2^2k, each a choice for every state seen and every number of steps since, as the return less l times the
// cost is linear in each probability. Their lower bound over l is the optimum. k = 4, limit 2.5: 9.453685, with l =
// 1.673477; the best without a memory, which chooses alike in all steps that show nothing, has 8.589.
#include "tasks/catalog.hpp"
#include "tasks/closed_form/sampled_task.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

// [state][a]
constexpr double kToOne[2][2] = {{0.1, 0.8}, {0.2, 0.9}};
constexpr double kReward[2][2] = {{0, 1}, {0.5, 2}};
constexpr double kCost[2][2] = {{0, 0.2}, {0, 1}};

constexpr double kRadius = 0.3;  // m, of the token in pictures

struct TwoStateOptions {
  double end_probability;
  int32_t max_steps, show_every;
};
constexpr auto kRows = option_rows<TwoStateOptions>(
    row<&TwoStateOptions::end_probability>(basic(
        number_option("end_probability", 0.1, 0.001, 1, "probability that the episode ends, at each step"))),
    row<&TwoStateOptions::max_steps>(
        basic(integer_option("max_steps", 1000, 1, 100000, "number of control steps in an episode"))),
    row<&TwoStateOptions::show_every>(basic(
        integer_option("show_every", 1, 1, 1000,
                       "the state is observed in every n-th control step alone; above 1 a memory helps"))));

struct State {
  Stream noise;
  double reward, cost;
  int32_t at;
  int16_t over, hidden;  // hidden: steps since the state was observed
};

class TwoState final : public SampledTask<State> {
 public:
  explicit TwoState(const TwoStateOptions& o)
      : SampledTask(PlanarScene(1)
                        .body("token", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkBlue)
                        .disc("state_0", 2 * kRadius, kMarkGreen, -1, 0)
                        .disc("state_1", 2 * kRadius, kMarkRed, 1, 0)
                        .build(),
                    o.max_steps, {{"state", "1", 2, 0, 1}}),
        end_probability_(o.end_probability),
        show_every_(o.show_every) {}

  const char* action_order() const override { return "choice"; }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    check_numbers("reward", &s.reward, 1);
    check_numbers("cost", &s.cost, 1);
    check_integer("at", s.at, 0, 1);
    check_integer("over", s.over, 0, 1);
    check_integer("hidden", s.hidden, 0, show_every_ - 1);
  }

  void observe(const World&, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    obs[0] = s.hidden == 0 && s.at == 0;
    obs[1] = s.hidden == 0 && s.at == 1;
  }

 private:
  void start(State*) const override {}

  void take(const float* action, State* s) const override {
    const int a = action[0] > 0;
    s->reward = kReward[s->at][a];
    s->cost = kCost[s->at][a];
    s->over = s->noise.uniform() < end_probability_;
    s->at = s->noise.uniform() < kToOne[s->at][a];
    s->hidden = static_cast<int16_t>((s->hidden + 1) % show_every_);
  }

  void judge_place(const State& s, Verdict* v) const override {
    v->success = s.at == 1;
    v->terminated = s.over != 0;
  }

  void place(World& world, const State& s) const override {
    world.set_body(0, planar_motion({s.at ? 1.0 : -1.0, 0, kRadius}, 0));
  }
  double end_probability_;
  int32_t show_every_;
};

constexpr CostSpec kCosts[] = {{"cost", "0.2 for action 1 in state 0, 1 for action 1 in state 1", 2.5}};
constexpr auto kDefaults = join_defaults(kKnownLearner, {{"horizon", "256"},
                                                         {"minibatches", "16"},
                                                         {"passes", "5"},
                                                         {"discount", "1"},
                                                         {"lambda", "0.95"},
                                                         {"cost_lambda", "0.95"},
                                                         {"init_std", "0.6"},
                                                         {"learning_rate", "1e-3"},
                                                         {"multiplier_init", "0.25"},
                                                         {"multiplier_lr", "0.02"},
                                                         {"multiplier_window", "400"},
                                                         {"cost_limit", "2.5"}});

}  // namespace

constinit const TaskInfo kTwoState = task_info<TwoState, kRows, kCosts, kSampledCameras, kDefaults>(
    "two_state", nullptr, "a constrained Markov decision process of two states; the optimum is known");

}  // namespace rdm

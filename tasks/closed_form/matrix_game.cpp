// A game of two who want the same and observe half each. In each step both draw a side, -1 or 1, that the other does not
// see, and choose 0 or 1: 1 where the sign of their entry is that of their side. Both choose 0: reward 1. Both choose
// 1: reward 2, and a cost of 1. They differ: 0. An episode has ten steps.
//
// Without a limit: both always 1, return 20 at cost 10. Under the limit of 2.5 a team, whose members know nothing of
// each other's side, can do no better than 0 and 0 in each step, return 10 at cost 0: with probabilities p and q of
// choosing 1 it has (1 - p)(1 - q) + 2 p q in a step at cost p q <= 1/4, of which 1 at p = q = 0 is the most. One
// agent that observes both sides has 12.5 at cost 2.5: both 1 where both sides are 1, say, else both 0.
#include "tasks/catalog.hpp"
#include "tasks/closed_form/sampled_task.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kReward[2][2] = {{1, 0}, {0, 2}};  // [choice of the first][of the second]
constexpr double kRadius = 0.3;                     // m, of the tokens in pictures

struct GameOptions {
  int32_t max_steps;
};
constexpr auto kRows = option_rows<GameOptions>(row<&GameOptions::max_steps>(
    basic(integer_option("max_steps", 10, 1, 100000, "number of control steps in an episode"))));

struct State {
  Stream noise;
  double reward, cost;
  int32_t side[2], choice[2];  // each 0 or 1; a side of 1 is observed as 1, of 0 as -1
};

class MatrixGame final : public SampledTask<State, 2> {
 public:
  explicit MatrixGame(const GameOptions& o)
      : SampledTask(PlanarScene(1)
                        .body("first", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkBlue)
                        .body("second", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkYellow)
                        .disc("zero", 3 * kRadius, kMarkGreen, -1, 0)
                        .disc("one", 3 * kRadius, kMarkRed, 1, 0)
                        .build(),
                    o.max_steps, {{"first.side", "1", 1, -1, 1}, {"second.side", "1", 1, -1, 1}}) {}

  const char* action_order() const override { return "first, second"; }
  bool group_set_at(int32_t i, const char** key, const char** list) const override {
    if (i != 0) return false;
    *key = "groups.players";
    *list = "first:first.*:0-0;second:second.*:1-1";
    return true;
  }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    check_numbers("reward", &s.reward, 1);
    check_numbers("cost", &s.cost, 1);
    for (int32_t i = 0; i < 2; ++i) {
      check_integer("side", s.side[i], 0, 1);
      check_integer("choice", s.choice[i], 0, 1);
    }
  }

  void observe(const World&, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    for (int32_t i = 0; i < 2; ++i) obs[i] = s.side[i] ? 1.0f : -1.0f;
  }

 private:
  void start(State* s) const override { draw(s); }

  void take(const float* action, State* s) const override {
    for (int32_t i = 0; i < 2; ++i) s->choice[i] = (action[i] > 0) == (s->side[i] == 1);
    s->reward = kReward[s->choice[0]][s->choice[1]];
    s->cost = s->choice[0] && s->choice[1];
    draw(s);
  }

  static void draw(State* s) {
    for (int32_t& side : s->side) side = s->noise.uniform() < 0.5;
  }

  void judge_place(const State& s, Verdict* v) const override { v->success = s.choice[0] == s.choice[1]; }

  void place(World& world, const State& s) const override {
    for (int32_t i = 0; i < 2; ++i)
      world.set_body(i, planar_motion({s.choice[i] ? 1.0 : -1.0, i ? 0.4 : -0.4, kRadius}, 0));
  }
};

constexpr CostSpec kCosts[] = {{"cost", "1 where both choose 1", 2.5}};
constexpr auto kDefaults = join_defaults(kKnownLearner, {{"hidden", ""},
                                                         {"horizon", "50"},
                                                         {"minibatches", "4"},
                                                         {"passes", "5"},
                                                         {"discount", "0.9"},
                                                         {"lambda", "0.9"},
                                                         {"cost_lambda", "0.9"},
                                                         {"init_std", "0.6"},
                                                         {"learning_rate", "5e-3"},
                                                         {"multiplier_init", "0"},
                                                         {"multiplier_lr", "0.1"},
                                                         {"multiplier_window", "400"},
                                                         {"cost_limit", "2.5"}});

}  // namespace

constinit const TaskInfo kMatrixGame = task_info<MatrixGame, kRows, kCosts, kSampledCameras, kDefaults>(
    "matrix_game", nullptr,
    "a game of two players who share the reward and each observe half of the state; the optimum is known");

}  // namespace rdm

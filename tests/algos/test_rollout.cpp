#include "agents.hpp"
#include "algos/rollout/rollout.hpp"
#include "ranks.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

struct Made {
  ResolvedAgentConfig resolved;
  Arena arena;
  AloneRanks alone{2};
  Rollout rollout;
  explicit Made(AgentSetup& s) : resolved(resolve_config(s.ready())) {
    Arena measure;
    carve_rollout(measure, resolved);
    arena = Arena(host(), measure.used());
    rollout = carve_rollout(arena, resolved);
    for (int32_t i = 0; i < resolved.samples; ++i) rollout.valid[i] = 1, rollout.discount[i] = 0.5f;
  }
};

AgentSetup two_costs() {
  static const double limits[] = {5, -1, 7};
  AgentSetup s("ppo_lag", 2, 1, 2);
  s.config.cost_dim = 3;
  s.config.cost_limits = limits;
  s.with("horizon", "3");
  return s;
}

// A rollout of one sample with two costs.
struct OneSample {
  float advantage = 2, cost[2] = {1, 4}, gain = 0, linear = 9;
  Rollout rollout;
  explicit OneSample(int32_t costs) {
    rollout.horizon = rollout.num_envs = 1;
    rollout.num_costs = costs;
    rollout.advantage = &advantage;
    rollout.cost_advantage = cost;
    rollout.gain = &gain;
    rollout.linear = &linear;
  }
};

}  // namespace

TEST(Rollout, LimitedColumnsOnly) {
  AgentSetup s = two_costs();
  const Made m(s);
  EXPECT_EQ(m.rollout.num_costs, 2);
  EXPECT_EQ(m.resolved.column[0], 0);
  EXPECT_EQ(m.resolved.column[1], 2);
  EXPECT_EQ(m.resolved.limit[1], 7);
  EXPECT_EQ(m.rollout.samples(), 6);
  EXPECT_EQ(m.rollout.row(2), 4u);
}

TEST(Rollout, ColumnsAreEstimatedApart) {
  AgentSetup s = two_costs();
  Made m(s);
  Rollout& r = m.rollout;
  for (size_t i = 0; i < 6; ++i) {
    r.reward[i] = static_cast<float>(i);
    r.cost[2 * i] = 1;
    r.cost[2 * i + 1] = static_cast<float>(i % 3);
  }
  estimate_advantages(r,
                      {.lambda = 0, .cost_lambda = 0, .standardize_reward = false, .standardize_cost = false},
                      m.alone.ranks);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(r.advantage[i], static_cast<float>(i));
    EXPECT_EQ(r.target[i], static_cast<float>(i));
    EXPECT_EQ(r.cost_advantage[2 * i], 0);  // centred constants
    EXPECT_EQ(r.cost_target[2 * i], 1);
    EXPECT_EQ(r.cost_advantage[2 * i + 1], static_cast<float>(i % 3) - 1);
  }
  estimate_advantages(r,
                      {.lambda = 0, .cost_lambda = 0, .standardize_reward = true, .standardize_cost = true},
                      m.alone.ranks);
  EXPECT_FLOAT_EQ(r.advantage[5], 2.5f / 1.7078251f);
  EXPECT_FLOAT_EQ(r.cost_advantage[11], 1 / 0.8164966f);
}

TEST(Rollout, CostsHaveTheirOwnLambda) {
  AgentSetup s = two_costs();
  Made m(s);
  Rollout& r = m.rollout;
  for (size_t i = 0; i < 6; ++i) r.reward[i] = r.cost[2 * i] = i >= 4 ? 1 : 0;
  estimate_advantages(r,
                      {.lambda = 1, .cost_lambda = 0, .standardize_reward = false, .standardize_cost = false},
                      m.alone.ranks);
  EXPECT_EQ(r.advantage[0], 0.25f);
  EXPECT_EQ(r.cost_target[0], 0);
}

TEST(Rollout, ListOfValidRows) {
  AgentSetup s = two_costs();
  Made m(s);
  m.rollout.valid[0] = m.rollout.valid[4] = 0;
  ASSERT_EQ(list_valid(m.rollout, 0, 2, 0), 4);
  const int32_t wanted[] = {1, 2, 3, 5}, by_envs[] = {2, 1, 3, 5};
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(m.rollout.order[i], wanted[i]);
  ASSERT_EQ(list_valid(m.rollout, 0, 1, 0), 1);
  ASSERT_EQ(list_valid(m.rollout, 1, 1, 1), 3);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(m.rollout.order[i], by_envs[i]);
}

TEST(Rollout, CombinedAdvantage) {
  OneSample s(1);
  for (const auto& [weight, wanted] : {std::pair{1.0, 0.5f}, std::pair{0.0, 2.0f}}) {
    combine_advantages(s.rollout, &weight, Mix::kSum, false);
    EXPECT_FLOAT_EQ(s.gain, wanted);
    EXPECT_EQ(s.linear, 0);
  }
  const double large = 1e9;
  combine_advantages(s.rollout, &large, Mix::kSum, false);
  EXPECT_NEAR(s.gain, -1, 1e-6);
}

TEST(Rollout, SeveralCostsAndSplit) {
  OneSample s(2);
  const double weights[] = {1, 0.5};
  combine_advantages(s.rollout, weights, Mix::kSum, false);
  EXPECT_FLOAT_EQ(s.gain, (2 - 1 - 2) / 2.5f);
  combine_advantages(s.rollout, weights, Mix::kSum, true);
  EXPECT_FLOAT_EQ(s.gain, 2 / 2.5f);
  EXPECT_FLOAT_EQ(s.linear, -3 / 2.5f);
}

#include "agents.hpp"
#include "algos/lagrange.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup sgd(const char* warmup = "0") {
  AgentSetup s("ppo_lag", 1, 1, 1);
  s.with("multiplier_optimizer", "sgd").with("multiplier_lr", "0.1").with("multiplier_init", "0");
  s.with("cost_limit", "25").with("multiplier_warmup", warmup);
  return s;
}

EpisodeStats costing(double cost, bool fresh = true) {
  EpisodeStats s;
  s.fresh = fresh;
  s.charged_cost[0] = cost;
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

TEST(Lagrange, CombinedAdvantage) {
  OneSample s(1);
  for (const auto& [weight, wanted] : {std::pair{1.0, 0.5f}, std::pair{0.0, 2.0f}}) {
    combine_advantages(s.rollout, &weight, false);
    EXPECT_FLOAT_EQ(s.gain, wanted);
    EXPECT_EQ(s.linear, 0);
  }
  const double large = 1e9;
  combine_advantages(s.rollout, &large, false);
  EXPECT_NEAR(s.gain, -1, 1e-6);
}

TEST(Lagrange, SeveralCostsAndSplit) {
  OneSample s(2);
  const double weights[] = {1, 0.5};
  combine_advantages(s.rollout, weights, false);
  EXPECT_FLOAT_EQ(s.gain, (2 - 1 - 2) / 2.5f);
  combine_advantages(s.rollout, weights, true);
  EXPECT_FLOAT_EQ(s.gain, 2 / 2.5f);
  EXPECT_FLOAT_EQ(s.linear, -3 / 2.5f);
}

TEST(Lagrange, MovesOnFreshEpisodesOnly) {
  AgentSetup s = sgd();
  const Plan plan = make_plan(s.ready());
  Lagrange l(plan);
  l.step(costing(30, false), plan, 1);
  EXPECT_EQ(l.weight(0), 0);
  l.step(costing(30), plan, 2);
  EXPECT_DOUBLE_EQ(l.weight(0), 0.5);
}

TEST(Lagrange, WarmUpGrowsFromNothingToTheFullRate) {
  AgentSetup s = sgd("4");
  const Plan plan = make_plan(s.ready());
  Lagrange l(plan);
  const double steps[] = {0, 0.125, 0.25, 0.375, 0.5, 0.5};
  double before = 0;
  for (int32_t epoch = 1; epoch <= 6; ++epoch) {
    l.step(costing(30), plan, epoch);
    EXPECT_DOUBLE_EQ(l.weight(0) - before, steps[epoch - 1]) << epoch;
    before = l.weight(0);
  }
}

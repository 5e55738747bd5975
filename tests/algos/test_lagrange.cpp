#include "agents.hpp"
#include "algos/lagrange/lagrange.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup sgd(const char* warmup = "0") {
  AgentSetup s("ppo_lag", 1, 1, 1);
  s.with("multiplier_optimizer", "sgd").with("multiplier_lr", "0.1").with("multiplier_init", "0");
  s.with("cost_limit", "25").with("multiplier_warmup", warmup);
  return s;
}

JudgedCosts costing(double cost, bool fresh = true) {
  JudgedCosts j;
  j.count = 1;
  j.known[0] = true, j.fresh[0] = fresh;
  j.cost[0] = cost, j.limit[0] = 25;
  return j;
}

}  // namespace

TEST(Lagrange, MovesOnFreshEpisodesOnly) {
  AgentSetup s = sgd();
  const ResolvedAgentConfig resolved = resolve_config(s.ready());
  Lagrange l(resolved);
  l.step(costing(30, false), 1);
  EXPECT_EQ(l.weight(0), 0);
  l.step(costing(30), 2);
  EXPECT_DOUBLE_EQ(l.weight(0), 0.5);
}

TEST(Lagrange, WarmUpGrowsFromNothingToTheFullRate) {
  AgentSetup s = sgd("4");
  const ResolvedAgentConfig resolved = resolve_config(s.ready());
  Lagrange l(resolved);
  const double steps[] = {0, 0.125, 0.25, 0.375, 0.5, 0.5};
  double before = 0;
  for (int32_t epoch = 1; epoch <= 6; ++epoch) {
    l.step(costing(30), epoch);
    EXPECT_DOUBLE_EQ(l.weight(0) - before, steps[epoch - 1]) << epoch;
    before = l.weight(0);
  }
}

#include "bandit.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(PpoLag, BanditStopsAtTheLimit) {
  AgentSetup s = bandit("ppo_lag");
  s.with("cost_limit", "1").with("multiplier_optimizer", "sgd").with("multiplier_lr", "0.3");
  s.with("multiplier_window", "2000");
  Epoch e;
  EXPECT_NEAR(play_bandit(s, 100, &e), 1, 0.05);
  EXPECT_NEAR(e.multiplier[0], 1.8856, 0.1);
  EXPECT_NEAR(e.cost[0], 1, 0.2);
}

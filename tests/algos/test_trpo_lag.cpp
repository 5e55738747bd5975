#include "bandit.hpp"
#include "two_state.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(TrpoLag, BanditStopsAtTheLimit) {
  AgentSetup s = bandit("trpo_lag");
  s.with("cost_limit", "6").with("multiplier_optimizer", "sgd").with("multiplier_lr", "0.1");
  s.with("multiplier_window", "2000");
  Epoch e;
  EXPECT_NEAR(play_bandit(s, 140, &e), 1, 0.05);  // to the end of its schedule, the trust region shrinks
  EXPECT_NEAR(e.multiplier[0], 1.8856, 0.1);
}

TEST(TrpoLag, WithoutMultiplierItIsTrpo) {
  AgentSetup plain = bandit("trpo"), lag = bandit("trpo_lag");
  lag.with("multiplier_init", "0").with("multiplier_max", "0");
  Epoch a, b;
  EXPECT_EQ(play_bandit(plain, 5, &a), play_bandit(lag, 5, &b));
  EXPECT_EQ(a.ret, b.ret);
  EXPECT_EQ(a.kl, b.kl);
}

#include "bandit.hpp"
#include "two_state.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(PpoLag, BanditStopsAtTheLimit) {
  AgentSetup s = bandit("ppo_lag");
  s.with("cost_limit", "6").with("multiplier_optimizer", "sgd").with("multiplier_lr", "0.3");
  s.with("multiplier_window", "2000");
  Epoch e;
  EXPECT_NEAR(play_bandit(s, 100, &e), 1, 0.05);
  EXPECT_NEAR(e.multiplier[0], 1.8856, 0.1);
  EXPECT_NEAR(e.cost[0], 6, 0.2);
}

// 50 epochs of 100 episodes: standard errors 0.15 (return) and 0.04 (cost).
TEST(PpoLag, TwoStatesReachTheConstrainedOptimum) {
  const Outcome o = play_two_state("ppo_lag",
                                   {{"cost_limit", nullptr, 2.5},
                                    {"multiplier_optimizer", "sgd", 0},
                                    {"multiplier_lr", nullptr, 0.1},
                                    {"multiplier_window", nullptr, 300}},
                                   200, 50);
  EXPECT_NEAR(o.ret, 9.687058, 0.3);
  EXPECT_NEAR(o.cost, 2.5, 0.08);
}

TEST(PpoLag, SplitLossStopsAtTheLimitToo) {
  AgentSetup s = bandit("ppo_lag");
  s.with("cost_limit", "6").with("multiplier_optimizer", "sgd").with("multiplier_lr", "0.3");
  s.with("multiplier_window", "2000").with("cost_loss", "split");
  Epoch e;
  EXPECT_NEAR(play_bandit(s, 100, &e), 1, 0.05);
}

// With the multiplier held at 0 every number must be PPO's, bit for bit.
TEST(PpoLag, WithoutMultiplierItIsPpo) {
  AgentSetup plain = bandit("ppo"), lag = bandit("ppo_lag");
  lag.with("multiplier_init", "0").with("multiplier_max", "0");
  Epoch a, b;
  EXPECT_EQ(play_bandit(plain, 5, &a), play_bandit(lag, 5, &b));
  EXPECT_EQ(a.ret, b.ret);
  EXPECT_EQ(a.kl, b.kl);
}

#include "algos/trust_region/cpo.hpp"
#include "bandit.hpp"
#include "two_state.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(Cpo, BanditStopsAtTheLimit) {
  AgentSetup s = bandit("cpo");
  s.with("cost_limit", "6").with("multiplier_window", "2000");
  Epoch e;
  EXPECT_NEAR(play_bandit(s, 100, &e), 1, 0.05);
}

// Far from its limit it is TRPO, bit for bit.
TEST(Cpo, WithoutALimitInReachItIsTrpo) {
  AgentSetup plain = bandit("trpo"), s = bandit("cpo");
  s.with("cost_limit", "1e9");
  Epoch a, b;
  EXPECT_EQ(play_bandit(plain, 5, &a), play_bandit(s, 5, &b));
  EXPECT_EQ(a.kl, b.kl);
}

// Every epoch that starts above the limit lowers the cost.
TEST(Cpo, RecoversFromAnInfeasibleStart) {
  const float start[] = {4};
  AgentSetup s = bandit("cpo");
  s.config.initial_mean = start;
  s.with("cost_limit", "6").with("multiplier_window", "2000");
  Epoch e;
  float last = 4;
  for (int epochs = 1; epochs <= 20; epochs += 3) {
    const float now = play_bandit(s, epochs, &e);
    EXPECT_LT(now, last);
    last = now;
  }
  EXPECT_NEAR(play_bandit(s, 100, &e), 1, 0.05);
}

TEST(Cpo, TwoStatesReachTheConstrainedOptimum) {
  const Outcome o = play_two_state(
      "cpo",
      {{"cost_limit", nullptr, 2.5}, {"multiplier_window", nullptr, 300}, {"trust_kl", nullptr, 0.003}}, 150,
      50);
  EXPECT_NEAR(o.ret, 9.687058, 0.3);
  EXPECT_NEAR(o.cost, 2.5, 0.08);
}

#include "algos/lagrange/cppo_pid.hpp"
#include "bandit.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(CppoPid, WithoutGainsItIsPpo) {
  AgentSetup plain = bandit("ppo"), s = bandit("cppo_pid");
  s.with("cost_limit", "6").with("pid_max", "0");
  Epoch a, b;
  EXPECT_EQ(play_bandit(plain, 5, &a), play_bandit(s, 5, &b));
  EXPECT_EQ(a.kl, b.kl);
}

// Differences of weights share what is 1 together, whatever the violation.
TEST(CppoPid, DifferenceStaysWithinOne) {
  AgentSetup s = bandit("cppo_pid");
  s.with("cost_limit", "5.1").with("pid_norm", "diff").with("pid_kp", "100");
  Epoch e;
  play_bandit(s, 10, &e);
  EXPECT_GT(e.multiplier[0], 0.2);
  EXPECT_LE(e.multiplier[0], 1);
}

#include "bandit.hpp"
#include "two_state.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(Pcpo, BanditStopsAtTheLimit) {
  for (const char* metric : {"kl", "l2"}) {
    AgentSetup s = bandit("pcpo");
    s.with("cost_limit", "6").with("multiplier_window", "2000").with("projection", metric);
    Epoch e;
    EXPECT_NEAR(play_bandit(s, 100, &e), 1, 0.05) << metric;
  }
}

// A regression test of a peer whose line search tried one step and took its opposite: with a start above the
// limit the cost must fall from the first epoch.
TEST(Pcpo, RecoversFromAnInfeasibleStart) {
  const float start[] = {4};
  AgentSetup s = bandit("pcpo");
  s.config.initial_mean = start;
  s.with("cost_limit", "6").with("multiplier_window", "2000");
  Epoch e;
  EXPECT_LT(play_bandit(s, 2, &e), 3.9f);
  EXPECT_NEAR(play_bandit(s, 100, &e), 1, 0.05);
}

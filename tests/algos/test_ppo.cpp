#include "algos/first_order/ppo.hpp"
#include "bandit.hpp"
#include "two_state.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(Ppo, ClippedLossOfOneSample) {
  struct Case {
    float ratio, advantage, loss, slope;
  };
  const Case cases[] = {{1.1f, 1, -1.1f, -1.1f}, {1.3f, 1, -1.2f, 0},    {0.7f, 1, -0.7f, -0.7f},
                        {0.7f, -1, 0.8f, 0},     {1.3f, -1, 1.3f, 1.3f}, {0.9f, -1, 0.9f, 0.9f}};
  for (const Case& c : cases) {
    const SampleLoss l = clipped_loss(c.ratio, c.advantage, 0, 0.2f);
    EXPECT_FLOAT_EQ(l.loss, c.loss) << c.ratio << " " << c.advantage;
    EXPECT_FLOAT_EQ(l.slope, c.slope) << c.ratio << " " << c.advantage;
  }
}

TEST(Ppo, LinearPartIsNeverClipped) {
  const SampleLoss l = clipped_loss(1.5f, 1, -0.25f, 0.2f);
  EXPECT_FLOAT_EQ(l.loss, -1.2f + 0.375f);
  EXPECT_FLOAT_EQ(l.slope, 0.375f);
  EXPECT_TRUE(l.clipped);
}

TEST(Ppo, BanditGoesToTheBestAction) {
  AgentSetup s = bandit("ppo");
  Epoch e;
  EXPECT_NEAR(play_bandit(s, 100, &e), 2, 0.05);
  EXPECT_EQ(e.multiplier[0], 0);
  EXPECT_NEAR(e.ret, -0.25, 0.1);
}

// 20 epochs of 100 episodes: the standard error of the mean return is 0.4.
TEST(Ppo, TwoStatesReachTheOptimum) {
  const Outcome o = play_two_state("ppo", {}, 100, 20);
  EXPECT_NEAR(o.ret, 17.912088, 0.8);
  EXPECT_NEAR(o.cost, 8.329670, 0.4);
}

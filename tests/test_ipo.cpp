#include "algos/ipo.hpp"
#include "bandit.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(Ipo, GoldenSlopes) {
  const double wanted[][2] = {
      {24, 0.0099999999}, {24.9, 0.0999999900}, {24.99, 0.9999990000}, {24.999, 1}, {25, 1}, {26, 1}};
  for (const auto& w : wanted) EXPECT_NEAR(barrier_slope(w[0], 25, 0.01, 1), w[1], 1e-9) << w[0];
}

TEST(Ipo, SlopeIsTheDerivativeOfTheLogarithm) {
  const auto barrier = [](double cost) { return std::log(25 - cost) / 100; };
  EXPECT_NEAR((barrier(24 + 1e-5) - barrier(24 - 1e-5)) / 2e-5, -barrier_slope(24, 25, 0.01, 1), 1e-9);
}

// Without weight of the barrier every number is PPO's, bit for bit.
TEST(Ipo, WithoutBarrierItIsPpo) {
  AgentSetup plain = bandit("ppo"), s = bandit("ipo");
  s.with("cost_limit", "1").with("barrier_max", "0");
  Epoch a, b;
  EXPECT_EQ(play_bandit(plain, 5, &a), play_bandit(s, 5, &b));
  EXPECT_EQ(a.kl, b.kl);
}

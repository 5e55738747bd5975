#include "algos/penalty/ipo.hpp"
#include "bandit.hpp"
#include "learner_bench.hpp"

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
  for (const char* barrier : {"epoch", "exact"}) {
    AgentSetup plain = bandit("ppo"), s = bandit("ipo");
    s.with("cost_limit", "6").with("barrier_max", "0").with("barrier", barrier);
    Epoch a, b;
    EXPECT_EQ(play_bandit(plain, 5, &a), play_bandit(s, 5, &b));
    EXPECT_EQ(a.kl, b.kl);
  }
}

// One cost inside its domain, one at the bound of its slope because the batch is outside.
TEST(Ipo, ExactBarrierHasTheGradientOfTheLogarithm) {
  Bench b(two_costs({"ipo", 3, 2, 16}));
  std::fill_n(b.rollout.linear, b.order.size(), 0.0f);
  BarrierLoss loss;
  loss.kappa = 0.3, loss.max = 5;
  const double violation[] = {-0.4, 0.5};
  loss.aim(b.learner.measure({b.order.data(), b.resolved.samples}), violation, 2);
  EXPECT_NE(loss.weight[0], static_cast<float>(0.3 / 0.4));  // not the slope where the epoch began
  EXPECT_EQ(loss.weight[1], 5);
  b.learner.gradient(&loss, false, {b.order.data(), b.resolved.samples});
  const auto total = [&](const std::vector<double>& p) {
    double gain = 0, cost[2] = {};
    for (size_t i = 0; i < b.order.size(); ++i) {
      const double rho = b.ratio(p, i);
      gain += b.clipped_gain(rho, i) / b.resolved.samples;
      for (size_t k = 0; k < 2; ++k)
        cost[k] += rho * static_cast<double>(b.rollout.cost_advantage[2 * i + k]) / b.resolved.samples;
    }
    return -gain - 0.3 * std::log(-violation[0] - cost[0]) + 5 * cost[1];
  };
  expect_gradient(b, total, 5e-6);
}

// Nothing has ended, so nobody knows what an episode costs: no barrier, to the end of the update.
TEST(Ipo, ExactBarrierIsLeftOutWhereNoCostIsKnown) {
  AgentSetup s("ipo", 6, 3, 4);
  s.with("cost_limit", "0.1").with("barrier", "exact").with("horizon", "12").with("hidden", "8");
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  while (a->missing() > 0) {
    a->act(world.obs(), true, world.action());
    world.draw();
    Transition t = world.transition();
    t.terminated = t.truncated = nullptr;
    const std::vector<float> none(4);
    t.cost = none.data();
    a->record(t);
  }
  Epoch e;
  a->update(world.obs(), &e);
  EXPECT_EQ(e.multiplier[0], 0);
}

TEST(Ipo, ExactBarrierStopsBeforeTheLimit) {
  AgentSetup s = bandit("ipo");
  s.with("cost_limit", "6").with("barrier", "exact").with("multiplier_window", "2000");
  s.with("barrier_kappa", "0.1").with("barrier_max", "20");
  Epoch e;
  const float mean = play_bandit(s, 100, &e);
  // Where the slope kappa / (1 - mean) is the multiplier 1.8856: 0.053 before the limit.
  EXPECT_NEAR(mean, 1 - 0.053, 0.04);
  EXPECT_GT(e.multiplier[0], 1);
}

#include "algos/penalty/p3o.hpp"
#include "bandit.hpp"
#include "learner_bench.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(P3o, ClipHidesFallsOfTheCostAlone) {
  const float wanted[][5] = {// rho, A_c, loss, slope
                             {1.3f, 1, 1.3f, 1.3f},
                             {0.7f, 1, 0.8f, 0},
                             {1.3f, -1, -1.2f, 0},
                             {0.7f, -1, -0.7f, -0.7f}};
  for (const auto& w : wanted) {
    const SampleLoss l = penalty_loss(w[0], w[1], 0.2f);
    EXPECT_FLOAT_EQ(l.loss, w[2]);
    EXPECT_FLOAT_EQ(l.slope, w[3]);
  }
}

// A regression test: peers add J_c - limit of an episode to a mean over decisions, and clip no cost.
TEST(P3o, TheLimitIsInTheUnitsOfADecision) {
  struct Probe : Ppo {
    using Ppo::Ppo;
    using Ppo::violation;
  };
  JudgedCosts costs;
  costs.count = 1, costs.known[0] = true, costs.steps[0] = 40, costs.cost[0] = 35, costs.limit[0] = 25;
  const std::pair<const char*, double> wanted[] = {{nullptr, 0.5}, {"discount", 1.9}, {"raw", 10}};
  for (const auto& [scale, violation] : wanted) {
    AgentSetup s("p3o", 3, 2, 16);
    s.with("action_repeat", "2").with("discount", "0.9").with("cost_limit", "25");
    if (scale) s.with("violation_scale", scale);
    const Probe p(resolve_config(s.ready()));
    EXPECT_NEAR(p.violation(costs, 0), violation, 1e-12);
    EXPECT_TRUE(p.options().flag("penalty_clip"));
  }
}

TEST(P3o, WithoutPenaltyItIsPpo) {
  AgentSetup plain = bandit("ppo"), s = bandit("p3o");
  s.with("cost_limit", "6").with("penalty", "0").with("penalty_max", "0");
  Epoch a, b;
  EXPECT_EQ(play_bandit(plain, 5, &a), play_bandit(s, 5, &b));
  EXPECT_EQ(a.kl, b.kl);
}

TEST(P3o, KappaGrowsToItsBound) {
  AgentSetup s = bandit("p3o");
  s.with("cost_limit", "6").with("penalty", "1").with("penalty_growth", "2").with("penalty_max", "5");
  Epoch e;
  for (const double kappa : {1.0, 2.0, 4.0, 5.0}) {
    play_bandit(s, kappa == 1 ? 1 : kappa == 2 ? 2 : kappa == 4 ? 3 : 4, &e);
    EXPECT_EQ(e.multiplier[0], kappa);
  }
}

TEST(P3o, AKappaThatBeginsAboveTheBoundOfItsGrowthStays) {
  AgentSetup s = bandit("p3o");
  s.with("cost_limit", "6").with("penalty", "8").with("penalty_growth", "2").with("penalty_max", "5");
  Epoch e;
  play_bandit(s, 3, &e);
  EXPECT_EQ(e.multiplier[0], 8);
}

namespace {

void expect_finite_difference(AgentSetup s) {
  Bench b(two_costs(std::move(s)));
  std::fill_n(b.rollout.linear, b.order.size(), 0.0f);
  PenalizedSurrogate loss;
  loss.weight[0] = 3, loss.weight[1] = 0.5f;
  b.learner.gradient(&loss, false, {b.order.data(), b.resolved.samples});
  const auto total = [&](const std::vector<double>& p) {
    double sum = 0;
    for (size_t i = 0; i < b.order.size(); ++i) {
      const double rho = b.ratio(p, i), cut = std::clamp(rho, 1 - kClip, 1 + kClip);
      sum -= b.clipped_gain(rho, i);
      for (size_t k = 0; k < 2; ++k) {
        const auto c = static_cast<double>(b.rollout.cost_advantage[2 * i + k]);
        sum += static_cast<double>(loss.weight[k]) * std::max(rho * c, cut * c);
      }
    }
    return sum / b.resolved.samples;
  };
  expect_gradient(b, total, 5e-6);
}

}  // namespace

TEST(P3o, GradientIsTheFiniteDifference) {
  const AgentSetup s("p3o", 3, 2, 16);
  expect_finite_difference(s);
  expect_finite_difference(with_state_std(s));
}

#include "algos/lagrange/focops.hpp"
#include "bandit.hpp"
#include "learner_bench.hpp"

using namespace rdm;
using namespace rdm::test;

// One sample, one dimension, mu_k = 0.1, sigma_k = 0.8, lambda = 1.5, nu = 0.3, eta = 0.02.
TEST(Focops, GoldenLossAndGradients) {
  struct Case {
    double mu, sigma, action, reward, cost, loss, dmu, dlog_std, kl_old_new;
  };
  const Case cases[] = {{.15, .78, .5, 1.2, .4, -0.7540622739, -0.3571577045, 0.5549217603, 0.0027065181},
                        {.15, .78, -.3, -.7, 1.1, 0.6782817250, -0.4216518432, -0.5001737125, 0.0027065181},
                        {.4, .7, .5, 1.2, .4, 0, 0, 0, -1}};
  for (const Case& c : cases) {
    float action = static_cast<float>(c.action), old_mean = .1f, mean = static_cast<float>(c.mu);
    float gain = static_cast<float>(c.reward - .3 * c.cost), linear = 0;
    float old_log_std = static_cast<float>(std::log(.8)), log_std = static_cast<float>(std::log(c.sigma));
    const double z = (c.action - .1) / .8;
    auto old_log_prob = static_cast<float>(-z * z / 2 - std::log(.8) - 0.9189385332046727);
    const int32_t order = 0;
    Rollout r;
    r.action_dim = 1;
    r.action = &action, r.mean = &old_mean, r.log_std = &old_log_std, r.log_prob = &old_log_prob;
    r.gain = &gain, r.linear = &linear;
    float dmean = 9, dlog_std = 0;
    BatchSums sums;
    FocopsLoss loss;
    loss.add({&r, &order, 1, &mean, &log_std, 1, &dmean, &dlog_std, &sums});
    EXPECT_NEAR(sums.loss, c.loss, 1e-6);
    EXPECT_NEAR(static_cast<double>(dmean), c.dmu, 1e-6);
    EXPECT_NEAR(static_cast<double>(dlog_std), c.dlog_std, 1e-6);
    EXPECT_EQ(sums.clipped, c.kl_old_new < 0 ? 1 : 0);
    // The KL that is reported is the other order than the one in the loss.
    if (c.kl_old_new > 0) {
      EXPECT_NEAR(sums.kl, c.kl_old_new, 1e-7);
    }
  }
}

namespace {

void expect_finite_difference(AgentSetup s) {
  s.with("hidden", "5,4").with("horizon", "10").with("minibatches", "1").with("last_layer_scale", "1");
  Bench b(std::move(s));
  const bool state = b.resolved.state_std();
  for (size_t j = 0; !state && j < 2; ++j) b.rollout.log_std[j] += j == 0 ? 0.05f : -0.04f;
  FocopsLoss loss;
  loss.eta = state ? 0.02f : 0.01f;
  const BatchSums sums = b.learner.gradient(&loss, false, {b.order.data(), b.resolved.samples});
  EXPECT_GT(sums.clipped, 10);
  EXPECT_LT(sums.clipped, 150);
  const std::vector<double> start = b.params();
  const auto kl_of = [&](const std::vector<double>& p, size_t i) {
    return Bench::kl_of(b.head(p, i), b.acted(i));
  };
  const auto total = [&](const std::vector<double>& p) {
    double sum = 0;
    for (size_t i = 0; i < b.order.size(); ++i) {
      if (kl_of(start, i) > static_cast<double>(loss.eta)) continue;  // the indicator is a constant
      const double rho = b.ratio(p, i);
      sum += kl_of(p, i) - rho * static_cast<double>(b.rollout.gain[i]) / 1.5;
    }
    return sum / b.resolved.samples;
  };
  expect_gradient(b, total, 5e-6);
}

}  // namespace

TEST(Focops, GradientIsTheFiniteDifference) {
  const AgentSetup s("focops", 3, 2, 16);
  expect_finite_difference(s);
  expect_finite_difference(with_state_std(s));
}

TEST(Focops, NuIsBoundedByTwoAtALimitOfZero) {
  const auto bound = [](const char* limit, const char* given) {
    const OptionInput wide{"multiplier_max", nullptr, 100};
    AgentSetup s("focops", 1, 1, 1);
    s.config.defaults = &wide;
    s.config.num_defaults = 1;
    s.with("cost_limit", limit);
    if (given) s.with("multiplier_max", given);
    return resolve_config(s.ready()).options.number("multiplier_max");
  };
  EXPECT_EQ(bound("25", nullptr), 100);
  EXPECT_EQ(bound("1e-6", nullptr), 100);
  EXPECT_EQ(bound("0", nullptr), 2);
  EXPECT_EQ(bound("0", "50"), 50);
  EXPECT_EQ(bound("0", "1"), 1);
}

TEST(Focops, SeveralCostsAreRefusedOrTheWorstIsFollowed) {
  const double limits[] = {1, 0.5};
  for (const char* algo : {"focops", "cpo", "pcpo"}) {
    AgentSetup s(algo, 3, 2, 4);
    s.config.cost_dim = 2;
    s.config.cost_limits = limits;
    s.with("horizon", "4");
    const Thrown t = thrown([&] { s.make(); });
    EXPECT_EQ(t.code, Code::kUnsupported) << algo;
    EXPECT_NE(t.text.find("several_costs=worst"), std::string::npos) << t.text;
    s.with("several_costs", "worst");
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    Epoch e;
    for (int i = 0; i < 4; ++i) world.epoch(*a, &e);
    EXPECT_EQ(e.multiplier[0], 0) << algo;
  }
}

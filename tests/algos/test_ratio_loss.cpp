#include "algos/first_order/ratio_loss.hpp"
#include "golden_net.hpp"

using namespace rdm;
using namespace rdm::test;

TEST(RatioLoss, GoldenMeansAndLogProbabilities) {
  GoldenNet net;
  const double mean[] = {0.5544050634, 0.0508434906, -0.1305623958, 0.1668723753};
  std::vector<float> got(4);
  net.nets.forward(Networks::kActor, net.rollout.obs, 2, net.workers[0].actor, got.data());
  expect_near({got.begin(), got.end()}, mean, 1e-7);
  const double wanted[] = {-1.7658431757, -1.8360882960};
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(net.log_prob(net.params(), i), wanted[i], 5e-7);
    EXPECT_NEAR(sample_ratio(net.rollout, i, net.rollout.mean + 2 * i, net.rollout.log_std), 1, 1e-6);
  }
}

TEST(RatioLoss, GoldenGradients) {
  GoldenNet net;
  net.learner.gradient(nullptr, true, {net.order.data(), 2});
  const GainLoss gain;
  net.learner.gradient(&gain, false, {net.order.data(), 2});
  std::vector<double> g = net.get(net.learner.gradient());
  for (double& x : g) x = -x;
  expect_near(g, kGoldenG, 2e-7);
  const CostLoss cost(0);
  net.learner.gradient(&cost, false, {net.order.data(), 2});
  expect_near(net.get(net.learner.gradient()), kGoldenB, 2e-7);
}

TEST(RatioLoss, TheEntropyBonusIsNotTheCosts) {
  AgentSetup s = GoldenNet::setup("cpo");
  s.with("entropy", "0.5");
  GoldenNet net(std::move(s));
  const CostLoss cost(0);
  net.learner.gradient(&cost, false, {net.order.data(), 2});
  EXPECT_NEAR(static_cast<double>(net.learner.gradient()[0]), kGoldenB[0], 2e-7);
  const GainLoss gain;
  net.learner.gradient(&gain, false, {net.order.data(), 2});
  EXPECT_NEAR(static_cast<double>(net.learner.gradient()[0]), -kGoldenG[0] - 0.5, 2e-7);
}

TEST(RatioLoss, MeasureIsTheMeanOverTheRows) {
  Bench b(two_costs({"p3o", 3, 2, 16}));
  for (const float clip : {0.0f, 0.2f}) {
    const Surrogate got = b.learner.measure({b.order.data(), b.resolved.samples}, clip);
    double gain = 0, cost[2] = {};
    for (size_t i = 0; i < b.order.size(); ++i) {
      const double rho = b.ratio(b.params(), i);
      gain += rho * static_cast<double>(b.rollout.gain[i] + b.rollout.linear[i]) / b.resolved.samples;
      for (size_t k = 0; k < 2; ++k) {
        const auto a = static_cast<double>(b.rollout.cost_advantage[2 * i + k]);
        const double whole = rho * a, cut = std::clamp(rho, 0.8, 1.2) * a;
        cost[k] += (clip > 0 ? std::max(whole, cut) : whole) / b.resolved.samples;
      }
    }
    EXPECT_NEAR(got.gain, gain, 1e-5);
    for (size_t k = 0; k < 2; ++k) EXPECT_NEAR(got.cost[k], cost[k], 1e-5);
    EXPECT_TRUE(got.finite());
  }
}

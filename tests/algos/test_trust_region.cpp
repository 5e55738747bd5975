#include "algos/trust_region/cpo_problem.hpp"
#include "algos/trust_region/trust_region.hpp"
#include "golden_net.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

struct RegionBench {
  GoldenNet net;
  Arena arena;
  TrustRegion region;
  explicit RegionBench(AgentSetup s = GoldenNet::setup("cpo")) : net(std::move(s)) {
    Arena measure;
    region.carve(measure, net.resolved, net.nets, true);
    arena = Arena(HostHooks(), measure.used());
    region.carve(arena, net.resolved, net.nets, true);
    region.open(net.resolved, net.rollout, net.nets, net.workers, net.learner);
    region.read_live(net.resolved.options);
    region.linearize({net.order.data(), 2}, 0, 1);
  }
};

double length(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

}  // namespace

TEST(TrustRegion, GoldenScalars) {
  RegionBench b;
  EXPECT_NEAR(b.region.q(), 0.1134796044, 3e-7);
  EXPECT_NEAR(b.region.r(), 0.0750248207, 3e-7);
  EXPECT_NEAR(b.region.s(), 0.2062166918, 3e-7);
}

TEST(TrustRegion, GoldenStepLengths) {
  RegionBench b;
  const double wanted[][2] = {{-.01, 0.1116613313}, {.05, 0.1193032281}};
  for (const auto& w : wanted) {
    const CpoStep y = solve_cpo({b.region.q(), b.region.r(), b.region.s(), w[0], .01});
    b.region.set_step(y.along_x, y.along_p, 0);
    EXPECT_NEAR(length(b.net.get(b.region.step())), w[1], 1e-6);
  }
}

// A regression test: peers repeated an unshrunk step when a value was not finite; every refusal shrinks.
TEST(TrustRegion, EveryRefusalShrinksTheStep) {
  RegionBench b;
  b.region.set_step(0.1, 0, 0);
  std::vector<double> gains;
  const double f = b.region.search([&](const Surrogate&, const Surrogate& after) {
    gains.push_back(after.gain);
    return gains.size() == 4;
  });
  EXPECT_NEAR(f, 0.512, 1e-12);
  for (size_t i = 1; i < gains.size(); ++i) EXPECT_NE(gains[i], gains[i - 1]);
  // Steps so long that nothing is finite any more end in one that is.
  b.region.set_step(3e7, 0, 0);
  const double small = b.region.search([](const Surrogate&, const Surrogate&) { return true; });
  EXPECT_EQ(small, 0);  // 15 tries are too few for that
  for (const double x : b.net.params()) EXPECT_TRUE(std::isfinite(x));
}

TEST(TrustRegion, NoAcceptableStepLeavesTheParameters) {
  RegionBench b;
  const std::vector<double> before = b.net.params();
  b.region.set_step(1, 1, 1);
  EXPECT_EQ(b.region.search([](const Surrogate&, const Surrogate&) { return false; }), 0);
  EXPECT_EQ(b.net.params(), before);
}

TEST(TrustRegion, SearchKeepsTheKlWithinItsBound) {
  for (const double length : {0.5, 5.0, 50.0}) {
    RegionBench b;
    b.region.set_step(length, 0, 0);
    if (b.region.search([](const Surrogate&, const Surrogate&) { return true; }) == 0) continue;
    EXPECT_LE(b.net.learner.kl({b.net.order.data(), 2}), 0.01);
    EXPECT_EQ(b.region.reached().kl, b.net.learner.kl({b.net.order.data(), 2}));
  }
}

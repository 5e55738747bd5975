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

namespace {

// The actor and more after four epochs in a world of noise where every decision costs `cost`.
std::vector<float> play_noise(const char* algo, const char* limit, float cost) {
  AgentSetup s(algo, 3, 2, 8);
  s.with("horizon", "100").with("hidden", "16").with("passes", "2").with("cost_limit", limit);
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  const std::vector<float> costs(size_of(s.config.num_envs), cost);
  for (int epoch = 0; epoch < 4; ++epoch) {
    while (a->missing() > 0) {
      a->act(world.obs(), true, world.action());
      world.draw();
      Transition t = world.transition();
      t.cost = costs.data();
      a->record(t);
    }
    a->update(world.obs(), nullptr);
  }
  std::vector<float> all = parameters(*a);
  all.resize(3 * 16 + 16 + 16 * 2 + 2);
  return all;
}

}  // namespace

// The cost critic starts anywhere, so its advantages have a slope where nothing costs. At a limit of 0 that
// must not hold the policy back, as it does where something costs.
TEST(Cpo, AtALimitOfZeroAPolicyWithoutACostIsFree) {
  const std::vector<float> plain = play_noise("trpo", "0", 0);
  for (const char* algo : {"cpo", "pcpo"}) {
    EXPECT_EQ(play_noise(algo, "0", 0), plain) << algo;
    EXPECT_NE(play_noise(algo, "0", 0.1f), plain) << algo;
  }
}

TEST(Cpo, TwoStatesReachTheConstrainedOptimum) {
  const Outcome o = play_two_state(
      "cpo",
      {{"cost_limit", nullptr, 2.5}, {"multiplier_window", nullptr, 300}, {"trust_kl", nullptr, 0.003}}, 150,
      50);
  EXPECT_NEAR(o.ret, 9.687058, 0.3);
  EXPECT_NEAR(o.cost, 2.5, 0.08);
}

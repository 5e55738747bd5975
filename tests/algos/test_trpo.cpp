#include "algos/trust_region/trpo.hpp"
#include "bandit.hpp"
#include "two_state.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

// An epoch of a world of noise with rewards scaled; the parameters after it.
std::vector<float> after_one_epoch(const char* algo, float reward_scale) {
  AgentSetup s(algo, 4, 2, 20);
  s.config.seed = 2;
  s.with("hidden", "8").with("horizon", "10").with("passes", "1").with("last_layer_scale", "1");
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  std::vector<float> reward(20);
  while (a->missing() > 0) {
    a->act(world.obs(), true, world.action());
    world.draw();
    Transition t = world.transition();
    for (size_t i = 0; i < 20; ++i) reward[i] = reward_scale * t.reward[i];
    const std::vector<uint8_t> over(20, 1);
    t.reward = reward.data(), t.terminated = over.data(), t.truncated = nullptr;
    a->record(t);
  }
  a->update(world.obs(), nullptr);
  TensorInfo t;
  std::vector<float> actor;
  for (int32_t i = 0; a->tensor(i, &t); ++i)
    if (std::strncmp(t.name, "actor", 5) == 0) actor.insert(actor.end(), t.data, t.data + t.rows * t.cols);
  return actor;
}

}  // namespace

// Regression tests of a peer that stepped once for each minibatch, and tried lengths of at most 0.01 of the
// step.
TEST(Trpo, AnEpochIsOneStepOnTheWholeBatch) {
  AgentSetup one = bandit("trpo"), many = bandit("trpo");
  one.with("minibatches", "1"), many.with("minibatches", "40");
  Epoch e;
  const float whole = play_bandit(one, 1, &e);
  EXPECT_GT(e.kl, 0.005);
  EXPECT_LE(e.kl, 0.01);
  EXPECT_NEAR(play_bandit(many, 1, &e), whole, 1e-5);
}

TEST(Trpo, BanditGoesToTheBestAction) {
  AgentSetup s = bandit("trpo");
  Epoch e;
  EXPECT_NEAR(play_bandit(s, 100, &e), 2, 0.05);
  EXPECT_LE(e.kl, 0.01);
}

TEST(Trpo, TwoStatesReachTheOptimum) {
  const Outcome o = play_two_state("trpo", {}, 100, 20);
  EXPECT_NEAR(o.ret, 17.912088, 0.8);
  EXPECT_NEAR(o.cost, 8.329670, 0.4);
}

// Advantages are standardised: the scale of rewards does not matter (the critics start near 0).
TEST(Trpo, StepDoesNotDependOnTheScaleOfRewards) {
  const auto once = after_one_epoch("trpo", 100), seven = after_one_epoch("trpo", 700);
  for (size_t i = 0; i < once.size(); ++i) EXPECT_NEAR(once[i], seven[i], 2e-3) << i;
}

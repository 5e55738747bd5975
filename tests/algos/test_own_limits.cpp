// Episodes that have a limit of their own: what multipliers see is the mean of what each is beyond its own.
#include "bandit.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

// One step an episode, whose cost is 5 + a, with the limit 4.5 for all by the option; or 3 + a, with limits of 0.5 to 4.5.
std::vector<float> play(const char* algo, bool own, Epoch* e) {
  AgentSetup s = bandit(algo);
  s.with("cost_limit", "4.5").with("normalize_obs", "false");
  const AgentPtr a = s.make();
  const std::vector<float> obs(50, 1.0f);
  std::vector<float> action(50), reward(50), cost(50), limit(50);
  const std::vector<uint8_t> over(50, 1);
  Transition t;
  t.reward = reward.data(), t.cost = cost.data(), t.terminated = over.data();
  if (own) t.limit = limit.data();
  for (int epoch = 0; epoch < 3; ++epoch) {
    while (a->missing() > 0) {
      a->act(obs.data(), true, action.data());
      for (size_t i = 0; i < 50; ++i) {
        limit[i] = 0.5f + static_cast<float>(i % 5);  // 2.5 on the mean, which is 2 less
        reward[i] = -(action[i] - 2) * (action[i] - 2);
        cost[i] = 5 + action[i] - (own ? 2.0f : 0.0f);
      }
      a->record(t);
    }
    a->update(obs.data(), e);
  }
  return parameters(*a);
}

}  // namespace

// Costs and limits both 2 less: the same violations, and so the same multiplier; costs are reported as they are.
TEST(OwnLimits, TheMeanOfWhatIsBeyondThemCounts) {
  Epoch own, all;
  play("ppo_lag", true, &own);
  play("ppo_lag", false, &all);
  EXPECT_NEAR(own.multiplier[0], all.multiplier[0], 1e-6);
  EXPECT_NEAR(own.cost[0], all.cost[0] - 2, 1e-5);
  EXPECT_GT(all.multiplier[0], 0);
}

TEST(OwnLimits, EqualToTheOptionsTheyChangeNothing) {
  const auto play_at = [](bool given) {
    AgentSetup s = bandit("cppo_pid");
    s.with("cost_limit", "6");
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    const std::vector<float> limit(50, 6.0f);
    for (int e = 0; e < 3; ++e) {
      while (a->missing() > 0) {
        a->act(world.obs(), true, world.action());
        world.draw();
        Transition t = world.transition();
        if (given) t.limit = limit.data();
        a->record(t);
      }
      a->update(world.obs(), nullptr);
    }
    return saved(*a);
  };
  EXPECT_EQ(play_at(true), play_at(false));
}

TEST(OwnLimits, WrongOnesAreRefused) {
  AgentSetup s = bandit("ppo_lag"), rate = bandit("ppo_lag");
  rate.with("cost_limit_per_step", "0.1");
  const std::vector<float> negative(50, -1.0f), good(50, 5.0f);
  for (const bool per_step : {false, true}) {
    AgentSetup& setup = per_step ? rate : s;
    const AgentPtr a = setup.make();
    NoiseWorld world(setup.config);
    a->act(world.obs(), true, world.action());
    world.draw();
    Transition t = world.transition();
    t.limit = (per_step ? good : negative).data();
    EXPECT_EQ(thrown([&] { a->record(t); }).code, per_step ? Code::kState : Code::kArgument);
    t.limit = nullptr;
    a->record(t);
  }
}

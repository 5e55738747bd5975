// PDO, RCPO, CUP and CRPO: what each does that no other does. Their optima: tests/slow/slow_closed_form.cpp.
#include "bandit.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup limited(const char* algo) {
  AgentSetup s = bandit(algo);
  s.with("cost_limit", "6").with("multiplier_window", "2000");
  return s;
}

bool has_tensor(Agent& a, const char* name) {
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i)
    if (std::strcmp(t.name, name) == 0) return true;
  return false;
}

std::vector<float> critics(Agent& a) {
  std::vector<float> all;
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i)
    if (std::strstr(t.name, "critic"))
      all.insert(all.end(), t.data, t.data + size_of(t.rows) * size_of(t.cols));
  return all;
}

}  // namespace

// The multiplier of PDO is in deviations of the reward, 2 / std(r) = 1.8856; that of RCPO in rewards, 2.
TEST(Kin, BanditsStopAtTheLimit) {
  struct Row {
    const char* algo;
    double multiplier;
  };
  for (const Row& row : {Row{"pdo", 1.8856}, Row{"rcpo", 2}}) {
    AgentSetup s = limited(row.algo);
    s.with("multiplier_optimizer", "sgd").with("multiplier_lr", "0.3");
    Epoch e;
    EXPECT_NEAR(play_bandit(s, 100, &e), 1, 0.05) << row.algo;
    EXPECT_NEAR(e.multiplier[0], row.multiplier, 0.15) << row.algo;
    EXPECT_NEAR(e.cost[0], 6, 0.2) << row.algo;
  }
}

// With the multiplier held at 0 every number must be PPO's, bit for bit, though there is no critic of costs.
TEST(Kin, RcpoWithoutAMultiplierIsPpo) {
  AgentSetup plain = bandit("ppo"), s = limited("rcpo");
  s.with("multiplier_init", "0").with("multiplier_max", "0");
  Epoch a, b;
  EXPECT_EQ(play_bandit(plain, 5, &a), play_bandit(s, 5, &b));
  EXPECT_EQ(a.kl, b.kl);
  EXPECT_EQ(a.loss_reward_value, b.loss_reward_value);
}

TEST(Kin, RcpoHasOneCritic) {
  AgentSetup s = limited("rcpo");
  const AgentPtr a = s.make();
  EXPECT_TRUE(has_tensor(*a, "reward_critic.0.weight"));
  EXPECT_FALSE(has_tensor(*a, "cost_critic.0.weight"));
  const float obs = 1;
  float value = 0, cost = 0;
  EXPECT_EQ(thrown([&] { a->values(&obs, nullptr, 1, &value, &cost); }).code, Code::kUnsupported);
}

// A multiplier that stays where it was is a fixed price: the same numbers as PPO on a reward that has it in it.
// Powers of 2, so that both compute the same floats.
TEST(Kin, RcpoLearnsFromTheRewardMinusThePricedCost) {
  const auto play = [](const char* algo, bool priced) {
    AgentSetup s = bandit(algo);
    s.with("normalize_obs", "false");
    if (priced) s.with("multiplier_init", "2").with("multiplier_lr", "0").with("cost_limit", "6");
    const AgentPtr a = s.make();
    const std::vector<float> obs(50, 1.0f);
    std::vector<float> action(50), reward(50), cost(50);
    const std::vector<uint8_t> over(50, 1);
    Transition t;
    t.reward = reward.data(), t.cost = cost.data(), t.terminated = over.data();
    for (int e = 0; e < 3; ++e) {
      while (a->missing() > 0) {
        a->act(obs.data(), true, action.data());
        for (size_t i = 0; i < 50; ++i) {
          reward[i] = action[i] > 0 ? 2 : 1;
          cost[i] = action[i] > 0.25f ? 0.5f : 0;
          if (!priced) reward[i] -= 2 * cost[i];
        }
        a->record(t);
      }
      a->update(obs.data(), nullptr);
    }
    return parameters(*a);
  };
  EXPECT_EQ(play("rcpo", true), play("ppo", false));
}

// The second passes move the policy alone: after an epoch the critics are PPO-Lag's, and the policy is another one.
TEST(Kin, CupProjectsWithThePolicyAlone) {
  AgentSetup s = limited("cup"), lag = limited("ppo_lag");
  for (AgentSetup* one : {&s, &lag}) one->with("multiplier_init", "1").with("multiplier_lr", "0");
  const AgentPtr a = s.make(), b = lag.make();
  NoiseWorld world(s.config), same(s.config);
  Epoch e;
  world.epoch(*a, &e);
  same.epoch(*b);
  EXPECT_EQ(e.passes, 5);
  EXPECT_EQ(critics(*a), critics(*b));
  EXPECT_NE(parameters(*a), parameters(*b));
}

// Passes that went too far end, and the projection comes all the same.
TEST(Kin, CupProjectsAfterAnEarlyStop) {
  for (const char* price : {"0", "0.2"}) {
    AgentSetup s = limited("cup");
    s.with("passes", "50").with("early_stop_kl", "0.001").with("projection_passes", "20");
    s.with("multiplier_init", price).with("multiplier_lr", "0");
    Epoch e;
    const float mean = play_bandit(s, 15, &e);
    EXPECT_LT(e.passes, 50);
    if (std::strcmp(price, "0") == 0)
      EXPECT_GT(mean, 1.0f);  // on its way to 2, which the reward alone wants
    else
      EXPECT_LT(mean, 0.0f);  // 1.19 a unit of cost outweighs the reward
  }
}

// One or the other, never both: the weight that the epoch reports is 0 or 1, by J_c of that epoch's window.
TEST(Kin, CrpoServesTheRewardOrTheCost) {
  AgentSetup s = bandit("crpo");
  s.with("cost_limit", "6").with("multiplier_window", "100").with("crpo_tolerance", "0.1");
  const AgentPtr a = s.make();
  const std::vector<float> obs(50, 1.0f);
  std::vector<float> action(50), reward(50), cost(50);
  const std::vector<uint8_t> over(50, 1);
  Transition t;
  t.reward = reward.data(), t.cost = cost.data(), t.terminated = over.data();
  Epoch e;
  int rises = 0, falls = 0;
  for (int epoch = 0; epoch < 60; ++epoch) {
    while (a->missing() > 0) {
      a->act(obs.data(), true, action.data());
      for (size_t i = 0; i < 50; ++i) reward[i] = -(action[i] - 2) * (action[i] - 2), cost[i] = 5 + action[i];
      a->record(t);
    }
    a->update(obs.data(), &e);
    EXPECT_EQ(e.multiplier[0], e.cost[0] > 6.1 ? 1 : 0) << epoch;
    (e.multiplier[0] > 0 ? falls : rises) += 1;
  }
  EXPECT_GT(rises, 5);
  EXPECT_GT(falls, 5);
  EXPECT_NEAR(e.cost[0], 6, 0.4);
}

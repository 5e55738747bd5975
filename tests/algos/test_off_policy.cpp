// Learners from a replay memory: what values go on with, what they refuse, and what they say of an epoch.
#include <cmath>

#include "agents.hpp"
#include "nn/policy.hpp"

namespace rdm::test {
namespace {

// One state, a reward and a cost of 1 in every decision, each of which ends an episode in one of two ways.
Epoch learn_of_ends(const char* algo, bool terminated, bool with_final) {
  AgentSetup s(algo, 1, 1, 4,
               {{"cost_limit", "1e6", 0},
                {"hidden", "", 0},
                {"discount", "0.5", 0},
                {"normalize_obs", "off", 0},
                {"horizon", "100", 0},
                {"start_steps", "0", 0},
                {"batch_rows", "32", 0},
                {"critic_learning_rate", "2e-2", 0},
                {"learning_rate", "0", 0},
                {"tau", "0.1", 0}});
  s.with_known("temperature", "0").with_known("temperature_learning_rate", "0");
  const AgentPtr a = s.make();
  const std::vector<float> obs(4, 1.0f), ones(4, 1.0f);
  const std::vector<uint8_t> over(4, 1), none(4, 0);
  std::vector<float> action(4);
  Epoch e;
  for (int epoch = 0; epoch < 3; ++epoch) {
    while (a->missing() > 0) {
      a->act(obs.data(), true, action.data());
      for (const float x : action) EXPECT_LE(std::abs(x), 1);
      Transition t;
      t.reward = t.cost = ones.data();
      t.terminated = terminated ? over.data() : none.data();
      t.truncated = terminated ? none.data() : over.data();
      t.final_obs = with_final ? obs.data() : nullptr;
      a->record(t);
    }
    a->update(obs.data(), &e);
    EXPECT_EQ(e.passes, 400);
  }
  return e;
}

}  // namespace

// 1 + 0.5 + 0.25 + ... = 2 beyond a time limit, 1 beyond an end and where nothing was seen after a time limit.
TEST(OffPolicy, ATimeLimitGoesOnAndAnEndDoesNot) {
  for (const char* algo : {"td3_lag", "sac_lag"}) {
    const Epoch limit = learn_of_ends(algo, false, true), end = learn_of_ends(algo, true, true),
                unseen = learn_of_ends(algo, false, false);
    EXPECT_NEAR(limit.value_reward, 2, 0.1) << algo;
    EXPECT_NEAR(limit.value_cost, 2, 0.1) << algo;
    for (const Epoch* e : {&end, &unseen}) {
      EXPECT_NEAR(e->value_reward, 1, 0.05) << algo;
      EXPECT_NEAR(e->value_cost, 1, 0.05) << algo;
    }
  }
}

TEST(OffPolicy, NothingIsLearnedBeforeStartSteps) {
  AgentSetup s("td3", 3, 2, 10, {{"horizon", "10", 0}, {"start_steps", "150", 0}, {"hidden", "8", 0}});
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  const auto before = parameters(*a);
  Epoch e;
  world.epoch(*a, &e);
  EXPECT_EQ(parameters(*a), before);
  EXPECT_EQ(e.passes, 0);
  EXPECT_TRUE(std::isnan(e.loss_reward_value));
  for (int i = 0; i < 2; ++i) world.epoch(*a, &e);
  EXPECT_NE(parameters(*a), before);
  EXPECT_GT(e.passes, 50);
}

TEST(OffPolicy, RefusesWhatItDoesNotSupport) {
  AgentSetup s("sac", 3, 2, 4);
  const AgentPtr a = s.make();
  std::vector<float> obs(12), value(4);
  const Thrown values = thrown([&] { a->values(obs.data(), nullptr, 4, value.data(), nullptr); });
  EXPECT_EQ(values.code, Code::kUnsupported);
  EXPECT_NE(values.text.find("sac learns from a replay memory"), std::string::npos) << values.text;
  EXPECT_EQ(thrown([&] { a->clone({}, {}); }).code, Code::kUnsupported);
  for (const char* key : {"memory", "history", "encoder", "passes", "blocks", "std_mode", "imitation"})
    EXPECT_EQ(thrown([&] {
                AgentSetup("sac", 3, 2, 4, {{key, "1", 0}}).make();
              }).code,
              Code::kNotFound)
        << key;
  AgentSetup few("td3", 3, 2, 4, {{"replay_rows", "3", 0}});
  EXPECT_EQ(thrown([&] { few.make(); }).code, Code::kRange);
}

// A policy's samples stay within the bounds and its files act as the agent does.
TEST(OffPolicy, PolicyFilesActAsTheAgent) {
  for (const char* algo : {"td3", "sac"}) {
    AgentSetup s(algo, 6, 3, 40);
    few_updates(s);
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    for (int i = 0; i < 2; ++i) world.epoch(*a);
    const auto bytes = policy_file(*a);
    Policy* const p = Policy::read(bytes.data(), bytes.size(), HostHooks());
    EXPECT_EQ(p->view().squash, std::strcmp(algo, "td3") ? Squash::kSample : Squash::kMean);
    std::vector<float> mean(120), action(120), noise(120, 30.0f), scratch(p->scratch_bytes(40) / 4 + 16);
    void* const at = scratch.data() + (64 - reinterpret_cast<uintptr_t>(scratch.data()) % 64) % 64 / 4;
    a->act(world.obs(), false, mean.data());
    p->act(world.obs(), 40, nullptr, action.data(), at);
    EXPECT_EQ(action, mean);
    p->act(world.obs(), 40, noise.data(), action.data(), at);
    for (const float x : action) EXPECT_GT(x, 0.99f);  // 30 deviations up, within the bound
    for (const float x : action) EXPECT_LE(x, 1.0f);
    Policy::destroy(p);
  }
}

}  // namespace rdm::test

#include <cmath>
#include <cstring>

#include "agents.hpp"
#include "algos/core/networks.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

struct Made {
  ResolvedAgentConfig resolved;
  Arena arena;
  Networks nets;
  explicit Made(AgentSetup& s) : resolved(resolve_config(s.ready())) {
    Arena measure;
    carve_networks(measure, resolved);
    arena = Arena(host(), measure.used());
    nets = carve_networks(arena, resolved);
    init_networks(nets, resolved);
  }
};

}  // namespace

TEST(Networks, TensorsByName) {
  AgentSetup s("ppo_lag", 5, 3, 2);
  s.config.cost_dim = 2;
  const double limits[] = {1, 2};
  s.config.cost_limits = limits;
  s.with("hidden", "7,6").with("critic_hidden", "4");
  Made m(s);
  struct Wanted {
    const char* name;
    int32_t rows, cols;
  };
  const Wanted wanted[] = {
      {"actor.log_std", 3, 1},          {"actor.0.weight", 7, 5},         {"actor.0.bias", 7, 1},
      {"actor.1.weight", 6, 7},         {"actor.1.bias", 6, 1},           {"actor.2.weight", 3, 6},
      {"actor.2.bias", 3, 1},           {"reward_critic.0.weight", 4, 5}, {"reward_critic.0.bias", 4, 1},
      {"reward_critic.1.weight", 1, 4}, {"reward_critic.1.bias", 1, 1},   {"cost_critic.0.weight", 4, 5},
      {"cost_critic.0.bias", 4, 1},     {"cost_critic.1.weight", 2, 4},   {"cost_critic.1.bias", 2, 1}};
  ASSERT_EQ(m.nets.num_tensors(), static_cast<int32_t>(std::size(wanted)));
  char name[kTensorNameSize];
  TensorInfo t;
  const float* end = nullptr;
  for (int32_t i = 0; i < m.nets.num_tensors(); ++i) {
    ASSERT_TRUE(find_tensor(m.nets, i, name, &t));
    EXPECT_STREQ(name, wanted[i].name);
    EXPECT_EQ(t.rows, wanted[i].rows) << name;
    EXPECT_EQ(t.cols, wanted[i].cols) << name;
    EXPECT_GE(t.data, end) << name;
    end = t.data + t.rows * t.cols;
  }
  EXPECT_LE(end, m.nets.params + m.nets.size);
  EXPECT_FALSE(find_tensor(m.nets, m.nets.num_tensors(), name, &t));
  EXPECT_FALSE(find_tensor(m.nets, -1, name, &t));
}

TEST(Networks, StateDeviationsAreOutputsWithinTheirBounds) {
  AgentSetup s("ppo", 5, 3, 2);
  s.with("std_mode", "state").with("hidden", "7").with("init_std", "0.4").with("last_layer_scale", "0");
  s.with("std_min", "0.1").with("std_max", "2").with("noise_correlation", "0.6");
  Made m(s);
  char name[kTensorNameSize];
  TensorInfo t;
  ASSERT_TRUE(find_tensor(m.nets, 0, name, &t));
  EXPECT_STREQ(name, "actor.0.weight");
  ASSERT_TRUE(find_tensor(m.nets, 3, name, &t));
  EXPECT_STREQ(name, "actor.1.bias");
  ASSERT_EQ(t.rows, 6);
  t.data[4] = -9, t.data[5] = 9;
  Arena measure;
  carve_actor_scratch(measure, m.resolved, 1);
  Arena arena(host(), measure.used());
  const float x[] = {3, -1, 2, 0.5f, 1}, share = std::log(0.8f);
  float y[6], dy[] = {1, 1, 1, 1, 1, 1};
  m.nets.forward(Networks::kActor, x, 1, carve_actor_scratch(arena, m.resolved, 1), y);
  EXPECT_NEAR(y[3], std::log(0.4f) + share, 1e-6);
  EXPECT_NEAR(y[4], std::log(0.1f) + share, 1e-6);
  EXPECT_NEAR(y[5], std::log(2.0f) + share, 1e-6);
  m.nets.gate_std(y, 1, dy);
  const float wanted[] = {1, 1, 1, 1, 0, 0};
  EXPECT_EQ(0, std::memcmp(dy, wanted, sizeof dy));
}

TEST(Networks, StateDeviationsAreNeitherFixedNorScheduled) {
  struct Bad {
    const char *key, *value;
    Code code;
  };
  const Bad bad[] = {{"learn_std", "false", Code::kUnsupported},
                     {"std_schedule", "linear", Code::kUnsupported},
                     {"init_std", "10", Code::kRange}};
  for (const Bad& b : bad) {
    AgentSetup s("ppo", 5, 3, 2);
    s.with("std_mode", "state").with(b.key, b.value);
    EXPECT_EQ(thrown([&] { s.make(); }).code, b.code) << b.key;
  }
}

TEST(Networks, NoCostCriticWithoutLimits) {
  AgentSetup s("ppo", 5, 3, 2);
  EXPECT_EQ(Made(s).nets.count, 2);
}

TEST(Networks, TheFirstPolicyIsTheInitialMean) {
  const float mean[] = {0.5f, -1, 0.25f};
  AgentSetup s("ppo", 5, 3, 2);
  s.config.initial_mean = mean;
  s.with("init_std", "0.4").with("last_layer_scale", "0");
  Made m(s);
  Arena measure;
  carve_actor_scratch(measure, m.resolved, 1);
  Arena arena(host(), measure.used());
  const ActorScratch scratch = carve_actor_scratch(arena, m.resolved, 1);
  const float x[] = {3, -1, 2, 0.5f, 1};
  float y[3];
  m.nets.forward(Networks::kActor, x, 1, scratch, y);
  for (int j = 0; j < 3; ++j) {
    EXPECT_EQ(y[j], mean[j]);
    EXPECT_FLOAT_EQ(std::exp(m.nets.log_std()[j]), 0.4f);
  }
}

TEST(Networks, SeedsAndNetworksDrawDifferentWeights) {
  AgentSetup s("ppo_lag", 5, 3, 2);
  Made a(s), same(s);
  s.config.seed = 9;
  Made b(s);
  EXPECT_EQ(a.nets.net(0)[0], same.nets.net(0)[0]);
  EXPECT_NE(a.nets.net(0)[0], b.nets.net(0)[0]);
  EXPECT_NE(a.nets.net(Networks::kReward)[0], a.nets.net(Networks::kCost)[0]);
}

TEST(Networks, TheAverageIsPlainFirstThenForgets) {
  AgentSetup s("ppo", 5, 2, 2);
  s.with("hidden", "4").with("average", "0.75").with("std_min", "0.5");
  Made m(s);
  restart_average(m.nets);
  ASSERT_NE(m.nets.average, nullptr);
  const size_t size = m.nets.block[Networks::kActor].size, at = m.nets.std_size + 3;
  EXPECT_EQ(0, std::memcmp(m.nets.average, m.nets.params, size * sizeof(float)));
  const float values[] = {3, 5, 1, 7, 20};
  // means of 1, 2, 3 and 4 of them; from then on a quarter of what is new
  const float wanted[] = {3, 4, 3, 4, 8};
  for (int k = 0; k < 5; ++k) {
    m.nets.params[at] = values[k];
    average_actor(m.nets);
    EXPECT_FLOAT_EQ(m.nets.average[at], wanted[k]) << k;
    EXPECT_EQ(m.nets.params[at], values[k]);
  }
  m.nets.average[0] = -9;
  clamp_log_std(m.nets);
  EXPECT_FLOAT_EQ(std::exp(m.nets.average[0]), 0.5f);
  restart_average(m.nets);
  EXPECT_EQ(m.nets.average[at], 20);
  m.nets.params[at] = 2;
  average_actor(m.nets);
  EXPECT_EQ(m.nets.average[at], 2);
  AgentSetup none("ppo", 5, 2, 2);
  EXPECT_EQ(Made(none).nets.average, nullptr);
}

TEST(Networks, DeviationStaysInItsBounds) {
  AgentSetup s("ppo", 5, 2, 2);
  s.with("std_min", "0.1").with("std_max", "1");
  Made m(s);
  m.nets.log_std()[0] = -5, m.nets.log_std()[1] = 5;
  clamp_log_std(m.nets);
  EXPECT_FLOAT_EQ(m.nets.log_std()[0], std::log(0.1f));
  EXPECT_FLOAT_EQ(m.nets.log_std()[1], 0);
}

TEST(Networks, DeviationOnALinearSchedule) {
  AgentSetup s("ppo_lag", 5, 3, 2);
  s.with("std_schedule", "linear").with("init_std", "0.5").with("std_min", "0.1").with("total_epochs", "4");
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  TensorInfo t;
  for (const double wanted : {0.5, 0.4, 0.3, 0.2, 0.1, 0.1}) {
    ASSERT_TRUE(a->tensor(0, &t));
    for (int32_t j = 0; j < 3; ++j) EXPECT_NEAR(std::exp(t.data[j]), wanted, 1e-6);
    world.epoch(*a);
  }
}

// Through the C ABI: an update in slices, and decisions that were taken elsewhere.
#include "contract.hpp"

namespace {

// A row of observations, and what follows it, of decision h.
struct Decision {
  float obs[12], action[8] = {}, reward[4], cost[4];
  uint8_t ended[4];
  rdm_transition t = RDM_INIT(rdm_transition);

  explicit Decision(int h) {
    for (int i = 0; i < 12; ++i) obs[i] = static_cast<float>((7 * i + 3 * h) % 11) * 0.1f;
    for (int i = 0; i < 4; ++i) {
      reward[i] = static_cast<float>((h + i) % 5);
      cost[i] = static_cast<float>((h * i) % 2);
      ended[i] = h % 4 == 3;
    }
    t.reward = reward;
    t.cost = cost;
    t.terminated = ended;
  }
};

void collect(rdm_agent* a) {
  for (int h = 0; h < 8; ++h) {
    Decision d(h);
    ASSERT_EQ(rdm_agent_act(a, d.obs, RDM_ACT_SAMPLE, d.action), RDM_OK);
    ASSERT_EQ(rdm_agent_record(a, &d.t), RDM_OK);
  }
}

bool refused(rdm_result r, const rdm_agent* a) {
  return r == RDM_ERROR_STATE && std::string(rdm_agent_error(a)).find("an update is under way") < 20;
}

}  // namespace

TEST(ContractSlices, AreOneUpdate) {
  for (const char* algo : {"ppo_lag", "cpo"}) {
    auto config = agent_config();
    config.algo = algo;
    rdm_agent *whole = make_agent(config), *parts = make_agent(config);
    const Decision last(8);
    for (int epoch = 1; epoch <= 2; ++epoch) {
      auto e = RDM_INIT(rdm_epoch), f = RDM_INIT(rdm_epoch);
      collect(whole), collect(parts);
      ASSERT_EQ(rdm_agent_update(whole, last.obs, &e), RDM_OK);
      ASSERT_EQ(rdm_agent_update_begin(parts, last.obs), RDM_OK);
      int slices = 0;
      for (int32_t done = 0; !done; ++slices) {
        EXPECT_EQ(f.epoch, 0);
        ASSERT_EQ(rdm_agent_update_slice(parts, 1 + slices % 3, &done, &f), RDM_OK) << rdm_last_error();
      }
      EXPECT_GT(slices, 5);
      EXPECT_EQ(f.epoch, epoch);
      EXPECT_EQ(0, std::memcmp(&e, &f, sizeof e));
    }
    EXPECT_EQ(saved(whole), saved(parts));
    rdm_agent_destroy(whole);
    rdm_agent_destroy(parts);
  }
}

TEST(ContractSlices, WhatGoesOnBetweenThem) {
  rdm_agent* a = make_agent(agent_config());
  const Decision d(3);
  float action[8], before[8], tensor[2];
  int32_t done = 7;
  EXPECT_EQ(rdm_agent_update_slice(a, 1, &done, nullptr), RDM_ERROR_STATE);
  EXPECT_EQ(rdm_agent_update_begin(a, d.obs), RDM_ERROR_STATE);
  collect(a);
  EXPECT_EQ(rdm_agent_update_begin(a, nullptr), RDM_ERROR_ARGUMENT);
  ASSERT_EQ(rdm_agent_act(a, d.obs, RDM_ACT_MEAN, before), RDM_OK);
  const auto policy = policy_bytes(a);
  ASSERT_EQ(rdm_agent_update_begin(a, d.obs), RDM_OK);
  EXPECT_EQ(rdm_agent_update_slice(a, 0, &done, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_agent_update_slice(a, 1, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(done, 7);
  for (int i = 0; i < 12; ++i) ASSERT_EQ(rdm_agent_update_slice(a, 1, &done, nullptr), RDM_OK);
  ASSERT_EQ(done, 0);

  ASSERT_EQ(rdm_agent_act(a, d.obs, RDM_ACT_MEAN, action), RDM_OK);
  EXPECT_EQ(0, std::memcmp(action, before, sizeof action));
  EXPECT_EQ(policy_bytes(a), policy);
  size_t size = 0;
  EXPECT_EQ(rdm_agent_get_settings(a, nullptr, 0, &size), RDM_OK);

  const rdm_option rate = {"learning_rate", nullptr, 1e-3};
  const std::string path = testing::TempDir() + "redman_slices.rdm";
  EXPECT_TRUE(refused(rdm_agent_act(a, d.obs, RDM_ACT_SAMPLE, action), a));
  EXPECT_TRUE(refused(rdm_agent_record(a, &d.t), a));
  EXPECT_TRUE(refused(rdm_agent_put(a, d.obs, d.action, &d.t), a));
  EXPECT_TRUE(refused(rdm_agent_update(a, d.obs, nullptr), a));
  EXPECT_TRUE(refused(rdm_agent_update_begin(a, d.obs), a));
  EXPECT_TRUE(refused(rdm_agent_set_option(a, &rate), a));
  EXPECT_TRUE(refused(rdm_agent_get_tensor(a, "actor.log_std", tensor, 2), a));
  EXPECT_TRUE(refused(rdm_agent_set_tensor(a, "actor.log_std", tensor, 2), a));
  EXPECT_TRUE(refused(rdm_agent_write_state(a, nullptr, 0, &size), a));
  EXPECT_TRUE(refused(rdm_checkpoint_write(path.c_str(), a, nullptr, nullptr, 0), a));
  EXPECT_EQ(std::fopen(path.c_str(), "rb"), nullptr);

  EXPECT_EQ(rdm_agent_discard(a), RDM_OK);
  EXPECT_EQ(policy_bytes(a), policy);
  EXPECT_EQ(rdm_agent_update_slice(a, 1, &done, nullptr), RDM_ERROR_STATE);
  collect(a);
  const auto later = policy_bytes(a);  // the normaliser has counted more rows
  ASSERT_EQ(rdm_agent_update_begin(a, d.obs), RDM_OK);
  ASSERT_EQ(rdm_agent_update_slice(a, 12, &done, nullptr), RDM_OK);
  rdm_agent_cancel(a);
  EXPECT_EQ(rdm_agent_update_slice(a, 1, &done, nullptr), RDM_ERROR_CANCELLED);
  EXPECT_EQ(policy_bytes(a), later);
  EXPECT_EQ(feed_epoch(a), RDM_OK) << rdm_last_error();
  // an agent may end in the middle
  collect(a);
  ASSERT_EQ(rdm_agent_update_begin(a, d.obs), RDM_OK);
  rdm_agent_destroy(a);
}

TEST(ContractSlices, ARolloutWaitsForTheUpdate) {
  rdm_pool* pool = make_pool(pool_config(2));
  ASSERT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  rdm_agent_config c;
  ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  ASSERT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
  c.settings = "horizon=1\npasses=1\nminibatches=1";
  rdm_agent* a = make_agent(c);
  const rdm_buffers b = buffers_of(pool);
  auto t = RDM_INIT(rdm_transition);
  t.reward = b.reward;
  t.cost = b.cost;
  ASSERT_EQ(rdm_agent_act(a, b.obs, RDM_ACT_SAMPLE, b.action), RDM_OK) << rdm_last_error();
  ASSERT_EQ(rdm_agent_record(a, &t), RDM_OK) << rdm_last_error();
  ASSERT_EQ(rdm_agent_update_begin(a, b.obs), RDM_OK) << rdm_last_error();
  EXPECT_TRUE(refused(rdm_agent_rollout(a, pool, nullptr), a)) << rdm_agent_error(a);
  int32_t done = 0;
  EXPECT_EQ(rdm_agent_update_slice(a, 1 << 20, &done, nullptr), RDM_OK);
  EXPECT_EQ(done, 1);
  EXPECT_EQ(rdm_agent_rollout(a, pool, nullptr), RDM_OK) << rdm_last_error();
  rdm_agent_destroy(a);
  rdm_pool_destroy(pool);
}

// As an agent that acted and one that was told of it; stale data are refused.
TEST(ContractPut, StandsForActAndRecord) {
  rdm_agent *actor = make_agent(agent_config()), *fed = make_agent(agent_config());
  const Decision last(8);
  rdm_policy* played = nullptr;
  const auto policy = policy_bytes(actor);
  ASSERT_EQ(rdm_policy_read(&played, policy.data(), policy.size()), RDM_OK);
  const auto generation = [&] {
    auto info = RDM_INIT(rdm_policy_info);
    EXPECT_EQ(rdm_policy_update_from(played, actor), RDM_OK);
    EXPECT_EQ(rdm_policy_get_info(played, &info), RDM_OK);
    return info.generation;
  };
  for (uint64_t epoch = 0, before = 1, now = 0; epoch < 2; ++epoch, before = now) {
    now = generation();
    for (int h = 0; h < 8; ++h) {
      Decision d(h);
      ASSERT_EQ(rdm_agent_act(actor, d.obs, RDM_ACT_SAMPLE, d.action), RDM_OK);
      ASSERT_EQ(rdm_agent_record(actor, &d.t), RDM_OK);
      d.t.generation = before;
      EXPECT_EQ(rdm_agent_put(fed, d.obs, d.action, &d.t), RDM_ERROR_STATE);
      d.t.generation = h % 2 ? now : 0;
      ASSERT_EQ(rdm_agent_put(fed, d.obs, d.action, &d.t), RDM_OK) << rdm_last_error();
    }
    ASSERT_EQ(rdm_agent_update(actor, last.obs, nullptr), RDM_OK);
    ASSERT_EQ(rdm_agent_update(fed, last.obs, nullptr), RDM_OK);
  }
  EXPECT_EQ(policy_bytes(actor), policy_bytes(fed));
  rdm_policy_destroy(played);
  Decision d(0);
  EXPECT_EQ(rdm_agent_put(fed, nullptr, d.action, &d.t), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_put(fed, d.obs, nullptr, &d.t), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_put(fed, d.obs, d.action, nullptr), RDM_ERROR_ARGUMENT);
  d.t.cost = nullptr;
  EXPECT_EQ(rdm_agent_put(fed, d.obs, d.action, &d.t), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_agent_error(fed), "transition.cost is NULL");
  rdm_agent_destroy(actor);
  rdm_agent_destroy(fed);
}

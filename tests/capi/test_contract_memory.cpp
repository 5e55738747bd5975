// Policies and agents that remember, through the ABI: one decision with a state in and out, actors, forgetting, and
// each refusal.
#include <cmath>
#include <redman/memory.hpp>
#include <redman/plan.hpp>

#include "contract.hpp"
#include "heap_count.hpp"
#include "policies.hpp"
#include "shields.hpp"
#include "written.hpp"

namespace {

using Bytes = std::vector<unsigned char>;
const char* const kKinds[] = {"memory=gru:6\nhidden=8", "history=4\nhidden=8",
                              "history=3\nhistory_fields=speed\nhidden=8",
                              "memory=gru:3\nactor_obs=speed\nhidden="};
const rdm_field kFields[] = {{"place", "m", 0, 1}, {"speed", "m/s", 1, 2}};

rdm_agent* agent_of(const char* settings) {
  rdm_agent_config c = agent_config();
  c.settings = settings;
  c.fields = kFields;
  c.num_fields = 2;
  return make_agent(c);
}

struct Kept {
  explicit Kept(const char* settings) : agent(agent_of(settings)) {
    EXPECT_EQ(feed_epoch(agent), RDM_OK) << rdm_last_error();
    const Bytes bytes = policy_bytes(agent);
    EXPECT_EQ(rdm_policy_read(&policy, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
    info = RDM_INIT(rdm_policy_info);
    EXPECT_EQ(rdm_policy_get_info(policy, &info), RDM_OK);
    scratch.resize(rdm_policy_scratch(policy, 4));
  }
  ~Kept() {
    rdm_policy_destroy(policy);
    rdm_agent_destroy(agent);
  }
  rdm_result act(const float* obs, float* state, int32_t rows, float* action) {
    return rdm_policy_act_state(policy, obs, state, rows, nullptr, action, scratch.data(), scratch.size());
  }
  rdm_agent* agent;
  rdm_policy* policy = nullptr;
  rdm_policy_info info;
  Bytes scratch;
};

// Row t of an episode of world e.
std::vector<float> row(int t, int e) {
  const auto at = static_cast<float>(t);
  return {std::sin(0.7f * at + static_cast<float>(e)), std::cos(1.3f * at),
          0.1f * static_cast<float>(t * (e + 1) % 7)};
}

TEST(ContractMemory, RowsTogetherAndOneByOneActAlike) {
  for (const char* kind : kKinds) {
    SCOPED_TRACE(kind);
    Kept k(kind);
    ASSERT_GT(k.info.state_dim, 0);
    const auto dim = static_cast<size_t>(k.info.state_dim);
    std::vector<float> together(4 * dim), alone(4 * dim), action(8), one(2);
    float moved = 0;
    for (int t = 0; t < 12; ++t) {
      std::vector<float> obs;
      for (int e = 0; e < 4; ++e)
        for (const float x : row(t, e)) obs.push_back(x);
      const int64_t before = heap_count();
      ASSERT_EQ(k.act(obs.data(), together.data(), 4, action.data()), RDM_OK) << rdm_last_error();
      EXPECT_EQ(heap_count(), before);
      for (size_t e = 0; e < 4; ++e) {
        ASSERT_EQ(k.act(&obs[3 * e], &alone[e * dim], 1, one.data()), RDM_OK);
        EXPECT_EQ(one, std::vector<float>(action.begin() + static_cast<long>(2 * e),
                                          action.begin() + static_cast<long>(2 * e + 2)));
      }
      // from zeros the same row gives another action: what came before counts
      std::vector<float> fresh(dim), first(2);
      ASSERT_EQ(k.act(obs.data(), fresh.data(), 1, first.data()), RDM_OK);
      moved = std::max(moved, std::abs(first[0] - action[0]));
    }
    EXPECT_EQ(together, alone);
    EXPECT_GT(moved, 0);
  }
}

TEST(ContractMemory, AnActorKeepsItAndClearsItWhereAnEpisodeEnds) {
  for (const char* kind : kKinds) {
    SCOPED_TRACE(kind);
    Kept k(kind);
    const auto dim = static_cast<size_t>(k.info.state_dim);
    rdm_actor_config c;
    ASSERT_EQ(rdm_actor_config_init(&c, sizeof c), RDM_OK);
    c.policy = k.policy;
    c.num_envs = 2;
    redman::Actor actor(c), resumed(c);
    std::vector<float> state(2 * dim), wanted(4), action(4), again(4);
    for (int t = 0; t < 15; ++t) {
      std::vector<float> obs = row(t, 0);
      for (const float x : row(t, 1)) obs.push_back(x);
      ASSERT_EQ(k.act(obs.data(), state.data(), 2, wanted.data()), RDM_OK);
      ASSERT_EQ(rdm_actor_act(actor.get(), obs.data(), nullptr, nullptr, action.data()), RDM_OK);
      EXPECT_EQ(action, wanted) << t;
      if (t == 9) {  // a state that was saved goes on alike
        ASSERT_EQ(rdm_actor_act(resumed.get(), obs.data(), nullptr, nullptr, again.data()), RDM_OK);
        EXPECT_EQ(again, wanted);
      }
      const uint8_t ends[2] = {t % 4 == 3, t == 6};
      ASSERT_EQ(rdm_actor_reset(actor.get(), ends, nullptr), RDM_OK);
      for (size_t e = 0; e < 2; ++e)
        if (ends[e]) std::fill_n(state.begin() + static_cast<long>(e * dim), dim, 0.0f);
      if (t != 8) continue;
      const Bytes bytes = written_bytes([&](void* out, size_t n, size_t* size) {
        return rdm_actor_write_state(actor.get(), out, n, size);
      });
      ASSERT_EQ(rdm_actor_read_state(resumed.get(), bytes.data(), bytes.size()), RDM_OK)
          << rdm_actor_error(resumed.get());
    }
  }
}

TEST(ContractMemory, EveryTensorIsListedAndCanBeRead) {
  for (const char* kind : kKinds) {
    SCOPED_TRACE(kind);
    Kept k(kind);
    bool found = false;
    rdm_tensor t;
    for (int32_t i = 0; rdm_policy_tensor_at(k.policy, i, &t) == RDM_OK; ++i) {
      std::vector<float> values(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols));
      EXPECT_EQ(rdm_policy_get_tensor(k.policy, t.name, values.data(), values.size()), RDM_OK) << t.name;
      found |= std::strstr(t.name, "memory.") || std::strstr(t.name, "history.");
      if (std::strcmp(t.name, "history.columns") == 0 && std::strstr(kind, "speed")) {
        EXPECT_EQ(values, (std::vector<float>{1, 2}));
      }
    }
    EXPECT_TRUE(found);
  }
}

TEST(ContractMemory, RefusalsNameTheCall) {
  Kept k(kKinds[0]);
  const std::vector<float> obs(12, 0.5f), noise(8);
  std::vector<float> action(8), state(4 * 6);
  EXPECT_EQ(
      rdm_policy_act(k.policy, obs.data(), 4, nullptr, action.data(), k.scratch.data(), k.scratch.size()),
      RDM_ERROR_STATE);
  EXPECT_NE(std::string(rdm_last_error()).find("rdm_policy_act_state"), std::string::npos);
  EXPECT_EQ(rdm_policy_sample(k.policy, obs.data(), 4, noise.data(), action.data(), nullptr, k.scratch.data(),
                              k.scratch.size()),
            RDM_ERROR_STATE);
  EXPECT_EQ(k.act(obs.data(), nullptr, 4, action.data()), RDM_ERROR_ARGUMENT);
  state[3] = NAN;
  EXPECT_EQ(k.act(obs.data(), state.data(), 4, action.data()), RDM_ERROR_ARGUMENT);
  state[3] = 0;
  EXPECT_EQ(k.act(obs.data(), state.data(), 0, action.data()), RDM_ERROR_RANGE);
  EXPECT_EQ(state, std::vector<float>(24, 0));
  const uint8_t any[4] = {0, 2, 0, 0};  // not 0: cleared, as in rdm_pool_reset
  EXPECT_EQ(rdm_agent_forget(k.agent, 7, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_agent_forget(k.agent, RDM_ACT_MEAN, any), RDM_OK);
  EXPECT_EQ(rdm_agent_forget(k.agent, RDM_ACT_SAMPLE, nullptr), RDM_OK);
  // one without a memory: the state is not looked at
  Kept plain("hidden=8");
  EXPECT_EQ(plain.info.state_dim, 0);
  EXPECT_EQ(plain.act(obs.data(), nullptr, 4, action.data()), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_agent_forget(plain.agent, RDM_ACT_MEAN, nullptr), RDM_OK);
}

// An expert's choices on recall, 20 steps after the cue, cloned: with a GRU the policy chooses right, without one it
// cannot. Labels say nothing of the cue in between. Judged in 64 worlds, over 1,280 episodes.
TEST(ContractMemory, RecallIsClonedFromAnExpert) {
  rdm_pool_config pc = pool_config(64);
  pc.task = "recall";
  pc.seed = 3;
  const Pool pool(make_pool(pc));
  ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
  const rdm_buffers b = buffers_of(pool.get());
  rdm_recording_config rc;
  ASSERT_EQ(rdm_recording_config_init(&rc, sizeof rc), RDM_OK);
  ASSERT_EQ(rdm_recording_config_for_pool(&rc, pool.get()), RDM_OK);
  rdm_recording* shown = nullptr;
  ASSERT_EQ(rdm_recording_create(&shown, &rc), RDM_OK) << rdm_last_error();
  float cue[64], label[64];
  for (int step = 0; step < 200; ++step) {
    for (size_t e = 0; e < 64; ++e) {
      if (b.obs[2 * e] != 0) cue[e] = b.obs[2 * e];
      label[e] = b.action[e] = b.obs[2 * e + 1] * cue[e];
    }
    ASSERT_EQ(rdm_recording_begin_step(shown, pool.get(), label, nullptr), RDM_OK);
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    ASSERT_EQ(rdm_recording_end_step(shown, pool.get(), nullptr), RDM_OK);
  }
  for (const char* settings : {"memory=gru:16\nhidden=16", "hidden=16"}) {
    SCOPED_TRACE(settings);
    rdm_agent_config ac;
    ASSERT_EQ(rdm_agent_config_init(&ac, sizeof ac), RDM_OK);
    ASSERT_EQ(rdm_agent_config_for_pool(&ac, pool.get()), RDM_OK);
    ac.settings = settings;
    ac.algo = "ppo";
    const Agent agent(make_agent(ac));
    rdm_clone_config how;
    ASSERT_EQ(rdm_clone_config_init(&how, sizeof how), RDM_OK);
    how.epochs = 60, how.patience = 0, how.learning_rate = 1e-2, how.learning_rate_end = 1e-4;
    ASSERT_EQ(rdm_agent_clone(agent.get(), shown, &how, nullptr), RDM_OK) << rdm_agent_error(agent.get());
    const Policy policy = read_policy(policy_bytes(agent.get()));
    auto info = RDM_INIT(rdm_policy_info);
    ASSERT_EQ(rdm_policy_get_info(policy.get(), &info), RDM_OK);
    const auto dim = static_cast<size_t>(info.state_dim);
    std::vector<float> state(64 * dim);
    Bytes scratch(rdm_policy_scratch(policy.get(), 64));
    double right = 0;
    ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
    for (int step = 0; step < 400; ++step) {
      ASSERT_EQ(rdm_policy_act_state(policy.get(), b.obs, dim ? state.data() : nullptr, 64, nullptr, b.action,
                                     scratch.data(), scratch.size()),
                RDM_OK);
      ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
      for (size_t e = 0; e < 64; ++e) {
        right += static_cast<double>(b.reward[e]);
        if (b.terminated[e]) std::fill_n(state.begin() + static_cast<long>(e * dim), dim, 0.0f);
      }
    }
    if (dim)
      EXPECT_GE(right / 1280, 0.99);
    else
      EXPECT_NEAR(right / 1280, 0.5, 0.06);  // four standard errors
  }
  rdm_recording_destroy(shown);
}

// Calls that cannot have the state say no and name what is the matter; what has it, or does not ask for it, works.
TEST(ContractMemory, WhatCannotKeepItSaysNo) {
  for (const char* kind : {"memory=gru:6\nhidden=8\nhorizon=20", "history=4\nhidden=8\nhorizon=20"}) {
    SCOPED_TRACE(kind);
    rdm_pool_config pc = pool_config(4);
    pc.task = "recall";
    const Pool pool(make_pool(pc));
    ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
    rdm_agent_config ac;
    ASSERT_EQ(rdm_agent_config_init(&ac, sizeof ac), RDM_OK);
    ASSERT_EQ(rdm_agent_config_for_pool(&ac, pool.get()), RDM_OK);
    ac.algo = "ppo";
    ac.settings = kind;
    const Agent agent(make_agent(ac));
    auto epoch = RDM_INIT(rdm_epoch);
    ASSERT_EQ(rdm_agent_rollout(agent.get(), pool.get(), &epoch), RDM_OK) << rdm_agent_error(agent.get());
    const Policy policy = read_policy(policy_bytes(agent.get()));
    const auto says = [&](rdm_result got, const char* error, const char* word) {
      EXPECT_EQ(got, RDM_ERROR_UNSUPPORTED) << word;
      EXPECT_NE(std::string(error).find("memory"), std::string::npos) << word << ": " << error;
    };
    // a shield that falls back on it, and training under a shield (test_shield_memory)
    const Shield shield = shield_of(shield_config(pool));
    EXPECT_EQ(rdm_shield_add_policy(shield.get(), policy.get()), RDM_OK) << rdm_shield_error(shield.get());
    EXPECT_EQ(rdm_agent_set_shield(agent.get(), shield.get()), RDM_OK) << rdm_agent_error(agent.get());
    // what is proposed to it is the caller's
    const rdm_buffers b = buffers_of(pool.get());
    std::vector<float> state(4 * static_cast<size_t>([&] {
                               auto info = RDM_INIT(rdm_policy_info);
                               rdm_policy_get_info(policy.get(), &info);
                               return info.state_dim;
                             }()));
    std::vector<unsigned char> scratch(rdm_policy_scratch(policy.get(), 4));
    ASSERT_EQ(rdm_policy_act_state(policy.get(), b.obs, state.data(), 4, nullptr, b.action, scratch.data(),
                                   scratch.size()),
              RDM_OK);
    EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK)
        << rdm_shield_error(shield.get());
    // a planner that is proposed its actions (test_planner_memory)
    rdm_planner_config plan;
    ASSERT_EQ(rdm_planner_config_init(&plan, sizeof plan), RDM_OK);
    char error[256] = "";
    plan.pool = pool.get();
    plan.policy = policy.get();
    plan.error = error;
    plan.error_size = sizeof error;
    rdm_planner* planner = nullptr;
    EXPECT_EQ(rdm_planner_create(&planner, &plan), RDM_OK) << error;
    rdm_planner_destroy(planner);
    // one network is no team
    size_t size = 0;
    EXPECT_NE(rdm_policy_write_group(policy.get(), 0, nullptr, 0, &size), RDM_OK);
    // values: critics beside a GRU see rows alone, those of a history do not
    std::vector<float> value(4);
    const rdm_result values = rdm_agent_get_values(agent.get(), b.obs, 4, value.data(), nullptr);
    if (std::strstr(kind, "gru"))
      EXPECT_EQ(values, RDM_OK) << rdm_agent_error(agent.get());
    else
      says(values, rdm_agent_error(agent.get()), "values");
    // how unusual a row is does not hang on what came before
    std::vector<float> first(4), again(4);
    const auto novelty = [&](std::vector<float>& out) {
      return rdm_policy_novelty(policy.get(), b.obs, 4, out.data());
    };
    if (novelty(first) == RDM_OK) {
      ASSERT_EQ(rdm_policy_act_state(policy.get(), b.obs, state.data(), 4, nullptr, b.action, scratch.data(),
                                     scratch.size()),
                RDM_OK);
      EXPECT_EQ(novelty(again), RDM_OK);
      EXPECT_EQ(first, again);
    }
  }
}

}  // namespace

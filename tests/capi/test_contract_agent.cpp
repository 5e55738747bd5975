// The C ABI of agents and policies: what bad input gets, and that it loses nothing.
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <limits>

#include "contract.hpp"

namespace {

TEST(ContractAgent, NullIsAnArgumentError) {
  rdm_agent_config c = agent_config();
  rdm_agent* a = nullptr;
  rdm_policy* p = nullptr;
  float x[8] = {};
  size_t n;
  EXPECT_EQ(rdm_agent_config_init(nullptr, sizeof c), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_create(nullptr, &c), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_create(&a, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_config_memory(&c, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_act(nullptr, x, RDM_ACT_MEAN, x), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_record(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_update(nullptr, x, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_rollout(nullptr, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_set_option(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_setting_at(nullptr, 0, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_tensor_at(nullptr, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_get_tensor(nullptr, "x", x, 1), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_set_tensor(nullptr, "x", x, 1), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_write_policy(nullptr, nullptr, 0, &n), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_write_policy_file(nullptr, "x"), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_write_state(nullptr, nullptr, 0, &n), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_read_state(nullptr, x, 1), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_checkpoint_write("x", nullptr, nullptr, nullptr, 0), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_checkpoint_read("x", nullptr, nullptr, nullptr, 0, &n), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_read(nullptr, x, 4), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_read(&p, nullptr, 4), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_read_file(&p, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_act(nullptr, x, 1, nullptr, x, x, 0), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_check(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_get_info(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_policy_scratch(nullptr, 1), 0u);
  rdm_agent_cancel(nullptr);
  rdm_agent_destroy(nullptr);
  rdm_policy_destroy(nullptr);
}

TEST(ContractAgent, BadConfigsSayWhatIsWrong) {
  rdm_agent* a = nullptr;
  auto expect = [&](const rdm_agent_config& c, rdm_result code, const char* word) {
    EXPECT_EQ(rdm_agent_create(&a, &c), code) << word;
    EXPECT_NE(std::string(rdm_last_error()).find(word), std::string::npos) << rdm_last_error();
    size_t bytes;
    EXPECT_EQ(rdm_agent_config_memory(&c, &bytes), code) << word;
    EXPECT_EQ(a, nullptr);
  };
  rdm_agent_config c = agent_config();
  c.algo = "ppo_lagg";
  expect(c, RDM_ERROR_NOT_FOUND, "ppo_lag");
  c = agent_config();
  c.obs_dim = 0;
  expect(c, RDM_ERROR_RANGE, "obs_dim");
  c = agent_config();
  c.action_dim = 1 << 30;
  expect(c, RDM_ERROR_RANGE, "action_dim");
  c = agent_config();
  c.cost_dim = RDM_MAX_COSTS + 1;
  expect(c, RDM_ERROR_RANGE, "cost_dim");
  c = agent_config();
  c.num_envs = -3;
  expect(c, RDM_ERROR_RANGE, "num_envs");
  c = agent_config();
  const float bad_mean[2] = {0, std::numeric_limits<float>::quiet_NaN()};
  c.initial_mean = bad_mean;
  expect(c, RDM_ERROR_ARGUMENT, "initial_mean");
  rdm_option o{"hiden", "8", 0};
  c = agent_config();
  c.options = &o;
  c.num_options = 1;
  expect(c, RDM_ERROR_NOT_FOUND, "hidden");
  o = {"hidden", "8,potato", 0};
  EXPECT_LT(rdm_agent_create(&a, &c), 0);
  o = {"discount", nullptr, 1.5};
  expect(c, RDM_ERROR_RANGE, "discount");
}

TEST(ContractAgent, WrongOrderIsAStateErrorAndTheHandleStaysGood) {
  rdm_agent* a = make_agent(agent_config());
  const float reward[4] = {}, cost[4] = {}, obs[12] = {};
  float action[8];
  rdm_transition t{};
  t.struct_size = sizeof t;
  t.reward = reward;
  t.cost = cost;
  EXPECT_EQ(rdm_agent_record(a, &t), RDM_ERROR_STATE);
  EXPECT_EQ(rdm_agent_update(a, obs, nullptr), RDM_ERROR_STATE);
  EXPECT_EQ(rdm_agent_act(a, obs, 9, action), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_agent_act(a, obs, RDM_ACT_MEAN, action), RDM_OK);
  EXPECT_EQ(rdm_agent_record(a, &t), RDM_ERROR_STATE);  // a mean action is not remembered
  EXPECT_EQ(rdm_agent_act(a, obs, RDM_ACT_SAMPLE, action), RDM_OK);
  size_t n;
  EXPECT_EQ(rdm_agent_write_state(a, nullptr, 0, &n), RDM_ERROR_STATE);
  EXPECT_EQ(rdm_agent_record(a, &t), RDM_OK);
  EXPECT_STRNE(rdm_agent_error(a), "");
  EXPECT_EQ(feed_epoch(a, 7), RDM_OK) << rdm_agent_error(a);
  EXPECT_EQ(feed_epoch(a), RDM_OK) << rdm_agent_error(a);
  rdm_agent_destroy(a);
}

TEST(ContractAgent, ValuesThatAreNotFiniteAreRefused) {
  rdm_agent* a = make_agent(agent_config());
  float obs[12] = {}, action[8], reward[4] = {}, cost[4] = {};
  obs[7] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(rdm_agent_act(a, obs, RDM_ACT_SAMPLE, action), RDM_ERROR_ARGUMENT);
  obs[7] = 0;
  ASSERT_EQ(rdm_agent_act(a, obs, RDM_ACT_SAMPLE, action), RDM_OK);
  rdm_transition t{};
  t.struct_size = sizeof t;
  t.reward = reward;
  t.cost = cost;
  reward[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(rdm_agent_record(a, &t), RDM_ERROR_ARGUMENT);
  reward[2] = 0;
  EXPECT_EQ(rdm_agent_record(a, &t), RDM_OK) << rdm_agent_error(a);
  rdm_agent_destroy(a);
}

// A policy gives actions in [-1, 1] or refuses, with and without a normaliser in front of the network.
TEST(ContractAgent, APolicyNeverGivesWhatIsNotANumber) {
  for (const double normalize : {0.0, 1.0}) {
    rdm_option options[5];
    std::copy(kSmallAgentOptions, kSmallAgentOptions + 4, options);
    options[4] = {"normalize_obs", nullptr, normalize};
    rdm_agent_config c = agent_config();
    c.options = options;
    c.num_options = 5;
    rdm_agent* a = make_agent(c);
    const auto bytes = policy_bytes(a);
    rdm_agent_destroy(a);
    rdm_policy* p = nullptr;
    ASSERT_EQ(rdm_policy_read(&p, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
    const size_t size = rdm_policy_scratch(p, 2);
    std::vector<unsigned char> memory(size);
    void* scratch = memory.data();
    const float clean[6] = {};
    float action[4];
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), HUGE_VALF, -HUGE_VALF}) {
      for (int at = 0; at < 6; ++at) {
        float obs[6] = {};
        obs[at] = bad;
        std::fill_n(action, 4, 9.0f);
        EXPECT_EQ(rdm_policy_act(p, obs, 2, nullptr, action, scratch, size), RDM_ERROR_ARGUMENT) << at;
        EXPECT_NE(std::string(rdm_last_error()).find("obs: row " + std::to_string(at / 3)), std::string::npos)
            << rdm_last_error();
        EXPECT_EQ(action[0], 9);
      }
      for (int at = 0; at < 4; ++at) {
        float noise[4] = {};
        noise[at] = bad;
        EXPECT_EQ(rdm_policy_act(p, clean, 2, noise, action, scratch, size), RDM_ERROR_ARGUMENT) << at;
      }
    }
    for (const float large : {1e10f, 3e38f, -3e38f}) {
      const float obs[6] = {large, -large, large, 0, large, large}, noise[4] = {large, -large, 0, large};
      const rdm_result r = rdm_policy_act(p, obs, 2, noise, action, scratch, size);
      ASSERT_TRUE(r == RDM_OK || r == RDM_ERROR_ARGUMENT) << r;
      for (const float x : action) EXPECT_TRUE(r || std::abs(x) <= 1) << x;
    }
    EXPECT_EQ(rdm_policy_act(p, clean, 2, nullptr, action, scratch, size), RDM_OK);
    rdm_policy_destroy(p);
  }
}

TEST(ContractAgent, TensorsAreListedReadAndWritten) {
  rdm_agent* a = make_agent(agent_config());
  rdm_tensor t;
  int count = 0;
  while (rdm_agent_tensor_at(a, count, &t) == RDM_OK) ++count;
  EXPECT_GE(count, 13);  // three networks of three layers, and the log standard deviation
  ASSERT_EQ(rdm_agent_tensor_at(a, 0, &t), RDM_OK);
  std::vector<float> values(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols));
  ASSERT_EQ(rdm_agent_get_tensor(a, t.name, values.data(), values.size()), RDM_OK);
  EXPECT_EQ(rdm_agent_get_tensor(a, t.name, values.data(), values.size() + 1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_agent_get_tensor(a, "actor.0.weigth", values.data(), 1), RDM_ERROR_NOT_FOUND);
  EXPECT_NE(std::string(rdm_last_error()).find("actor.0.weight"), std::string::npos);
  for (float& v : values) v = 0.25f;
  ASSERT_EQ(rdm_agent_set_tensor(a, t.name, values.data(), values.size()), RDM_OK);
  std::vector<float> back(values.size());
  ASSERT_EQ(rdm_agent_get_tensor(a, t.name, back.data(), back.size()), RDM_OK);
  EXPECT_EQ(back, values);
  values[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(rdm_agent_set_tensor(a, t.name, values.data(), values.size()), RDM_ERROR_ARGUMENT);
  rdm_agent_destroy(a);
}

TEST(ContractAgent, CorruptSavesChangeNothing) {
  rdm_agent* a = make_agent(agent_config());
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  const auto good = saved(a);
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  const auto now = saved(a);
  ASSERT_NE(good, now);
  for (size_t cut = 0; cut < good.size(); cut += 101)
    EXPECT_LT(rdm_agent_read_state(a, good.data(), cut), 0) << cut;
  for (size_t at = 0; at < good.size(); at += 17) {
    auto bad = good;
    bad[at] ^= static_cast<unsigned char>(1u << (at % 8));
    EXPECT_LT(rdm_agent_read_state(a, bad.data(), bad.size()), 0) << at;
  }
  const auto policy = policy_bytes(a);
  EXPECT_EQ(rdm_agent_read_state(a, policy.data(), policy.size()), RDM_ERROR_FORMAT);  // a foreign file
  EXPECT_EQ(saved(a), now);
  EXPECT_EQ(rdm_agent_read_state(a, good.data(), good.size()), RDM_OK);
  EXPECT_EQ(saved(a), good);
  rdm_agent_destroy(a);
}

TEST(ContractAgent, CorruptPoliciesAreRefused) {
  rdm_agent* a = make_agent(agent_config());
  const auto good = policy_bytes(a);
  rdm_policy* p = nullptr;
  for (size_t cut = 0; cut < good.size(); cut += 7)
    EXPECT_EQ(rdm_policy_read(&p, good.data(), cut), RDM_ERROR_FORMAT);
  for (size_t at = 0; at < good.size(); ++at) {
    auto bad = good;
    bad[at] ^= static_cast<unsigned char>(1u << (at % 8));
    EXPECT_LT(rdm_policy_read(&p, bad.data(), bad.size()), 0) << at;
    EXPECT_EQ(p, nullptr);
  }
  const auto save = saved(a);
  EXPECT_EQ(rdm_policy_read(&p, save.data(), save.size()), RDM_ERROR_FORMAT);
  EXPECT_EQ(rdm_policy_read_file(&p, "no/such/file.rdm"), RDM_ERROR_NOT_FOUND);
  ASSERT_EQ(rdm_policy_read(&p, good.data(), good.size()), RDM_OK) << rdm_last_error();
  const size_t bytes = rdm_policy_scratch(p, 4);
  EXPECT_LT(rdm_policy_scratch(p, 1), 512u);  // a row's numbers, and no panel of weights
  std::vector<unsigned char> memory(bytes + 64);
  void* scratch = memory.data();
  const float obs[12] = {1, -2, 0.5f};
  float action[8], other[8];
  EXPECT_EQ(rdm_policy_act(p, obs, 0, nullptr, action, scratch, bytes), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_act(p, obs, 4, nullptr, action, scratch, bytes - 1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_policy_act(p, obs, 4, nullptr, action, scratch, bytes), RDM_OK);
  for (size_t shift = 1; shift < 64; ++shift) {  // at any address, within its bytes
    std::fill(memory.begin(), memory.end(), uint8_t{0x5a});
    EXPECT_EQ(rdm_policy_act(p, obs, 4, nullptr, other, memory.data() + shift, bytes), RDM_OK);
    EXPECT_EQ(std::memcmp(action, other, sizeof action), 0);
    for (size_t i = 0; i < shift; ++i) EXPECT_EQ(memory[i], 0x5a);
    for (size_t i = shift + bytes; i < memory.size(); ++i) EXPECT_EQ(memory[i], 0x5a);
  }
  rdm_policy_destroy(p);
  rdm_agent_destroy(a);
}

TEST(ContractAgent, AFullDiskKeepsTheOldFile) {
  rdm_agent* a = make_agent(agent_config());
  const std::string path = testing::TempDir() + "redman_contract_policy.rdm";
  ASSERT_EQ(rdm_agent_write_policy_file(a, path.c_str()), RDM_OK) << rdm_last_error();
  const auto before = policy_bytes(a);
  ASSERT_EQ(feed_epoch(a), RDM_OK);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tiny{512, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tiny);
  const rdm_result policy_result = rdm_agent_write_policy_file(a, path.c_str());
  const std::string text = rdm_last_error();
  const rdm_result checkpoint_result = rdm_checkpoint_write(path.c_str(), a, nullptr, nullptr, 0);
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(policy_result, RDM_ERROR_IO);
  EXPECT_EQ(checkpoint_result, RDM_ERROR_IO);
  EXPECT_NE(text.find(path), std::string::npos) << text;
  FILE* f = std::fopen(path.c_str(), "rb");
  ASSERT_NE(f, nullptr);
  std::vector<unsigned char> now(before.size() + 1);
  now.resize(std::fread(now.data(), 1, now.size(), f));
  std::fclose(f);
  EXPECT_EQ(now, before);
  EXPECT_EQ(rdm_agent_write_policy_file(a, path.c_str()), RDM_OK);
  EXPECT_EQ(rdm_agent_write_policy_file(a, "/proc/none/policy.rdm"), RDM_ERROR_IO);
  std::remove(path.c_str());
  rdm_agent_destroy(a);
}

}  // namespace

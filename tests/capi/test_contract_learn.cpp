// rdm_agent_learn through the C ABI: what it refuses and how it says so, memory that is told and met or refused, and a
// memory that a recording fills before worlds do.
#include <cmath>

#include "contract.hpp"

namespace {

constexpr int64_t kRows = 60;

struct Owned {
  rdm_recording* r = nullptr;
  ~Owned() { rdm_recording_destroy(r); }
};

// Episodes of six rows that end by themselves, of an agent_config()'s sizes unless given.
rdm_recording* recorded(int64_t rows = kRows, int32_t obs_dim = 3, int32_t action_dim = 2,
                        int32_t cost_dim = 1) {
  rdm_recording_config c;
  EXPECT_EQ(rdm_recording_config_init(&c, sizeof c), RDM_OK);
  c.obs_dim = obs_dim, c.action_dim = action_dim, c.cost_dim = cost_dim;
  rdm_recording* r = nullptr;
  EXPECT_EQ(rdm_recording_create(&r, &c), RDM_OK) << rdm_last_error();
  std::vector<float> obs, action, reward, cost;
  std::vector<uint8_t> terminated;
  for (int64_t i = 0; i < rows; ++i) {
    for (int32_t j = 0; j < obs_dim; ++j) obs.push_back(static_cast<float>((7 * i + 5 * j) % 13) * 0.1f);
    for (int32_t j = 0; j < action_dim; ++j)
      action.push_back(static_cast<float>((3 * i + 11 * j) % 9) * 0.2f - 0.8f);
    for (int32_t j = 0; j < cost_dim; ++j) cost.push_back(static_cast<float>(i % 3 == 0));
    reward.push_back(static_cast<float>(i % 5));
    terminated.push_back(i % 6 == 5);
  }
  rdm_recording_rows v{};
  v.struct_size = sizeof v;
  v.rows = rows, v.obs = obs.data(), v.action = action.data(), v.reward = reward.data();
  v.cost = cost_dim ? cost.data() : nullptr, v.terminated = terminated.data();
  EXPECT_EQ(rdm_recording_append(r, &v), RDM_OK) << rdm_recording_error(r);
  return r;
}

constexpr rdm_option kOptions[] = {{"hidden", "8,8", 0},
                                   {"horizon", nullptr, 8},
                                   {"replay_rows", nullptr, 200},
                                   {"batch_rows", nullptr, 16},
                                   {"learning_rate", nullptr, 3e-3}};

rdm_agent_config learner(const char* algo = "td3_bc_lag", const rdm_host* host = nullptr) {
  rdm_agent_config c = agent_config();
  c.algo = algo;
  c.options = kOptions;
  c.num_options = 5;
  c.host = host;
  return c;
}

struct Learner {
  rdm_agent* a;
  explicit Learner(const rdm_agent_config& c = learner()) : a(make_agent(c)) {}
  ~Learner() { rdm_agent_destroy(a); }
  // The code; text: what it says has this in it.
  void expect(rdm_result code, const char* text, const rdm_recording* r, int64_t steps = 1) const {
    EXPECT_EQ(rdm_agent_learn(a, r, steps, nullptr), code) << text;
    EXPECT_NE(std::string(rdm_last_error()).find(text), std::string::npos) << rdm_last_error();
  }
};

}  // namespace

TEST(ContractLearn, ReportsWhatItDid) {
  rdm_agent_config c = learner();
  const double limit = 0.25;
  c.cost_limits = &limit;
  Learner l(c);
  Owned o{recorded()};
  rdm_learn_report report{};
  report.struct_size = sizeof report;
  ASSERT_EQ(rdm_agent_learn(l.a, o.r, 1000, &report), RDM_OK) << rdm_last_error();
  EXPECT_EQ(report.struct_size, sizeof report);
  EXPECT_EQ(report.steps, 1000);
  EXPECT_EQ(report.rows, kRows);
  EXPECT_EQ(report.skipped_gradients, 0);
  EXPECT_GT(report.loss_policy * report.loss_policy, 0);
  EXPECT_GT(report.loss_reward_value, 0);
  EXPECT_GT(report.loss_cost_value, 0);
  EXPECT_GT(report.value_reward, 0.5);
  EXPECT_GT(report.cost[0], 0.5);  // two of six rows cost 1
  EXPECT_LT(report.cost[0], 5);
  EXPECT_GT(report.multiplier[0], 0);
  EXPECT_TRUE(std::isnan(report.cost[1]));
  ASSERT_EQ(rdm_agent_learn(l.a, o.r, 0, &report), RDM_OK);
  EXPECT_EQ(report.steps, 0);
  EXPECT_TRUE(std::isnan(report.loss_policy));
  report.struct_size = 8;
  EXPECT_EQ(rdm_agent_learn(l.a, o.r, 0, &report), RDM_ERROR_ARGUMENT);
}

TEST(ContractLearn, RefusalsSayWhatIsWrong) {
  Learner l;
  Owned good{recorded()}, empty{recorded(0)}, wide{recorded(6, 4)}, other{recorded(6, 3, 1)},
      costs{recorded(6, 3, 2, 2)}, large{recorded(600)};
  const std::vector<unsigned char> before = saved(l.a);
  l.expect(RDM_ERROR_ARGUMENT, "recording: it has no rows", empty.r);
  l.expect(RDM_ERROR_ARGUMENT, "4 observations", wide.r);
  l.expect(RDM_ERROR_ARGUMENT, "1 actions", other.r);
  l.expect(RDM_ERROR_ARGUMENT, "2 costs", costs.r);
  l.expect(RDM_ERROR_RANGE, "replay_rows: 200 has no place", large.r);
  l.expect(RDM_ERROR_RANGE, "steps: -1", good.r, -1);
  l.expect(RDM_ERROR_ARGUMENT, "recording", nullptr);
  EXPECT_EQ(rdm_agent_learn(nullptr, good.r, 1, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(saved(l.a), before);
  rdm_agent_config c = agent_config();
  c.algo = "cpo";
  Learner needs_worlds(c);
  needs_worlds.expect(RDM_ERROR_UNSUPPORTED, "cpo learns from its own decisions alone", good.r);
  float obs[12] = {}, action[8];
  ASSERT_EQ(rdm_agent_act(l.a, obs, RDM_ACT_SAMPLE, action), RDM_OK);
  rdm_transition t{};
  t.struct_size = sizeof t;
  const float zero[4] = {};
  t.reward = t.cost = zero;
  ASSERT_EQ(rdm_agent_record(l.a, &t), RDM_OK);
  l.expect(RDM_ERROR_STATE, "between epochs", good.r);
}

// The block is what was told; beside it a list of the rows, once.
TEST(ContractLearn, MemoryIsToldAndMet) {
  CountingHost host;
  const rdm_agent_config c = learner("td3_bc_lag", &host.hooks);
  size_t told = 0;
  ASSERT_EQ(rdm_agent_config_memory(&c, &told), RDM_OK);
  const size_t calls = host.calls;
  {
    Learner l(c);
    Owned o{recorded()};
    const size_t live = host.live;
    ASSERT_EQ(rdm_agent_learn(l.a, o.r, 10, nullptr), RDM_OK);
    EXPECT_LE(host.live, live + 8 * kRows + 64);
    EXPECT_LE(host.live, told + 8 * kRows + 64);
    const size_t made = host.calls;
    ASSERT_EQ(rdm_agent_learn(l.a, o.r, 150, nullptr), RDM_OK);
    EXPECT_EQ(host.calls, made);
  }
  EXPECT_GT(host.calls, calls);
  EXPECT_EQ(host.live, 0u);
}

TEST(ContractLearn, RefusedMemoryChangesNothing) {
  CountingHost host;
  Owned o{recorded()};
  const rdm_agent_config c = learner("td3_bc_lag", &host.hooks);
  size_t k = 0;
  for (;; ++k) {
    Learner l(c);
    const std::vector<unsigned char> before = saved(l.a);
    host.refuse_at = host.calls + k;
    const rdm_result r = rdm_agent_learn(l.a, o.r, 2, nullptr);
    host.refuse_at = SIZE_MAX;
    if (r == RDM_OK) break;
    EXPECT_EQ(r, RDM_ERROR_MEMORY) << rdm_last_error();
    EXPECT_EQ(saved(l.a), before) << k;
    EXPECT_EQ(rdm_agent_learn(l.a, o.r, 2, nullptr), RDM_OK);
    ASSERT_LT(k, 100u);
  }
  EXPECT_GE(k, 2u);
  EXPECT_EQ(host.live, 0u);
}

// No step: the memory alone. Worlds add to it, and more steps learn from both.
TEST(ContractLearn, ARecordingIsWhatALearnerStartsWith) {
  rdm_agent_config c = learner("td3_lag");
  const rdm_option options[] = {{"hidden", "8,8", 0},
                                {"horizon", nullptr, 8},
                                {"replay_rows", nullptr, 200},
                                {"batch_rows", nullptr, 16},
                                {"start_steps", nullptr, 50}};
  c.options = options, c.num_options = 5;
  Learner fed(c), unfed(c);
  Owned o{recorded()};
  ASSERT_EQ(rdm_agent_learn(fed.a, o.r, 0, nullptr), RDM_OK);
  EXPECT_EQ(feed_epoch(fed.a), RDM_OK);
  EXPECT_EQ(feed_epoch(unfed.a), RDM_OK);
  rdm_learn_report report{};
  report.struct_size = sizeof report;
  ASSERT_EQ(rdm_agent_learn(fed.a, o.r, 5, &report), RDM_OK);
  EXPECT_EQ(report.rows, kRows + 32);
}

// A pool that repeats actions does what a loop of masked steps around one that does not would do, and an
// agent learns the same from both.
#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "contract.hpp"

namespace {

struct Case {
  const char* task;
  const char* settings;
};
const Case kCases[] = {
    {"hand_over_safe_finger", "max_steps=23"},
    {"point_goal1", "max_steps=17"},
    {"two_state", "max_steps=9"},
    {"car_run", "max_steps=11"},
    {"grasp", "max_steps=13"},
};

// Copies of all rows of one world.
struct Row {
  std::vector<float> floats;
  std::vector<uint32_t> words;
  bool operator==(const Row&) const = default;
};

struct Worlds {
  rdm_pool* pool;
  rdm_spec spec{};
  rdm_buffers b;
  int32_t n;

  Worlds(const Case& test, int32_t envs, int32_t repeat, int32_t mode, int32_t threads) : n(envs) {
    rdm_pool_config c = pool_config(envs);
    c.task = test.task;
    c.seed = 5;
    c.autoreset = mode;
    c.num_threads = threads;
    const std::string settings = std::string(test.settings) + "\naction_repeat=" + std::to_string(repeat);
    c.settings = settings.c_str();
    pool = make_pool(c);
    spec.struct_size = sizeof spec;
    EXPECT_EQ(rdm_pool_get_spec(pool, &spec), RDM_OK);
    EXPECT_EQ(spec.action_repeat, repeat);
    b = buffers_of(pool);
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  }
  ~Worlds() { rdm_pool_destroy(pool); }

  size_t at(int32_t env, int32_t width) const {
    return static_cast<size_t>(env) * static_cast<size_t>(width);
  }
  Row row(int32_t env) const {
    Row r;
    const auto add = [&](const float* rows, int32_t width) {
      r.floats.insert(r.floats.end(), rows + at(env, width), rows + at(env, width) + width);
    };
    add(b.obs, spec.obs_dim);
    add(b.final_obs, spec.obs_dim);
    add(b.reward, 1);
    add(b.cost, spec.cost_dim);
    add(b.cost_raw, spec.cost_dim);
    add(b.episode_return, 1);
    add(b.episode_cost, spec.cost_dim);
    r.words = {static_cast<uint32_t>(b.episode_step[env]), b.status[env], b.terminated[env], b.truncated[env],
               b.success[env]};
    return r;
  }
  bool ended(int32_t env) const { return b.terminated[env] || b.truncated[env]; }
};

// What one step of `repeat` control steps in this mode leaves, done from outside with autoreset off.
class Loop {
 public:
  Loop(const Case& test, int32_t envs, int32_t repeat, int32_t mode)
      : worlds(test, envs, 1, RDM_AUTORESET_OFF, 0),
        repeat_(repeat),
        mode_(mode),
        waits_(static_cast<size_t>(envs)) {}

  std::vector<Row> step(const std::vector<uint8_t>& mask) {
    const auto n = static_cast<size_t>(worlds.n), costs = static_cast<size_t>(worlds.spec.cost_dim);
    const rdm_buffers& b = worlds.b;
    std::vector<uint8_t> go = mask, over(n), success(n), resets(n);
    std::vector<float> reward(n), cost(n * costs);
    std::vector<uint32_t> status(n);
    for (size_t i = 0; i < n; ++i)
      if (waits_[i] && go[i] && mode_ == RDM_AUTORESET_NEXT_STEP) go[i] = 0, waits_[i] = 0, resets[i] = 1;
    EXPECT_EQ(rdm_pool_reset(worlds.pool, nullptr, resets.data()), RDM_OK);
    const std::vector<uint8_t> stepped = go;
    for (int32_t r = 0; r < repeat_ && std::count(go.begin(), go.end(), 1) > 0; ++r) {
      EXPECT_EQ(rdm_pool_step_masked(worlds.pool, go.data()), RDM_OK) << rdm_last_error();
      for (size_t i = 0; i < n; ++i) {
        if (!go[i]) continue;
        reward[i] += b.reward[i];
        for (size_t k = 0; k < costs; ++k) cost[i * costs + k] += b.cost[i * costs + k];
        status[i] |= b.status[i];
        success[i] |= b.success[i];
        if (worlds.ended(static_cast<int32_t>(i))) go[i] = 0, over[i] = 1;
      }
    }
    for (size_t i = 0; i < n; ++i) {
      if (!stepped[i]) continue;
      b.reward[i] = reward[i];
      std::copy_n(&cost[i * costs], costs, b.cost + i * costs);
      b.status[i] = status[i];
      b.success[i] = success[i];
      waits_[i] = over[i];
    }
    std::vector<Row> rows;
    for (int32_t i = 0; i < worlds.n; ++i) rows.push_back(worlds.row(i));
    if (mode_ != RDM_AUTORESET_SAME_STEP) return rows;
    EXPECT_EQ(rdm_pool_reset(worlds.pool, nullptr, over.data()), RDM_OK);
    for (int32_t i = 0; i < worlds.n; ++i)  // the rows show the end, but for the observation
      if (over[static_cast<size_t>(i)])
        std::copy_n(b.obs + worlds.at(i, worlds.spec.obs_dim), worlds.spec.obs_dim,
                    rows[static_cast<size_t>(i)].floats.begin());
    return rows;
  }

  Worlds worlds;

 private:
  int32_t repeat_, mode_;
  std::vector<uint8_t> waits_;  // ended, and not reset yet
};

void expect_equal(const Case& test, int32_t repeat, int32_t mode, int32_t threads, bool masked) {
  SCOPED_TRACE(std::string(test.task) + " mode " + std::to_string(mode) + " repeat " +
               std::to_string(repeat));
  constexpr int32_t kEnvs = 6;
  Worlds whole(test, kEnvs, repeat, mode, threads);
  Loop loop(test, kEnvs, repeat, mode);
  std::vector<Row> expected;
  for (int32_t i = 0; i < kEnvs; ++i) expected.push_back(whole.row(i));
  int ends = 0;
  for (int t = 0; t < 20; ++t) {
    std::vector<uint8_t> mask(kEnvs, 1);
    for (int32_t i = 0; i < kEnvs; ++i)
      mask[static_cast<size_t>(i)] =
          !(masked && (i + t) % 3 == 0) && !(mode == RDM_AUTORESET_OFF && whole.ended(i));
    EXPECT_EQ(rdm_pool_baseline(whole.pool, RDM_BASELINE_RANDOM), RDM_OK);
    std::copy_n(whole.b.action, kEnvs * whole.spec.action_dim, loop.worlds.b.action);
    EXPECT_EQ(rdm_pool_baseline(loop.worlds.pool, RDM_BASELINE_RANDOM), RDM_OK);  // its streams keep step
    ASSERT_EQ(rdm_pool_step_masked(whole.pool, mask.data()), RDM_OK) << rdm_last_error();
    const std::vector<Row> rows = loop.step(mask);
    for (int32_t i = 0; i < kEnvs; ++i) {
      const auto e = static_cast<size_t>(i);
      if (mask[e]) expected[e] = rows[e];
      ASSERT_TRUE(whole.row(i) == expected[e]) << "step " << t << " world " << i;
      ends += mask[e] && whole.ended(i);
    }
    ASSERT_EQ(hash_of(whole.pool), hash_of(loop.worlds.pool)) << "step " << t;
  }
  EXPECT_GT(ends, 0);
}

TEST(ActionRepeat, IsALoopOfMaskedSteps) {
  for (const Case& test : kCases)
    for (const int32_t mode : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP, RDM_AUTORESET_OFF})
      expect_equal(test, 4, mode, mode == RDM_AUTORESET_NEXT_STEP ? 3 : 0, true);
  expect_equal(kCases[0], 3, RDM_AUTORESET_SAME_STEP, 2, false);
  expect_equal(kCases[0], 100, RDM_AUTORESET_SAME_STEP, 0, false);
}

TEST(ActionRepeat, StatesMoveBetweenPoolsThatRepeatAndThatDoNot) {
  Worlds four(kCases[0], 2, 4, RDM_AUTORESET_SAME_STEP, 0), one(kCases[0], 2, 1, RDM_AUTORESET_SAME_STEP, 0);
  for (int t = 0; t < 3; ++t) ASSERT_EQ(rdm_pool_step(four.pool), RDM_OK);
  size_t size = 0;
  ASSERT_EQ(rdm_pool_write_state(four.pool, -1, nullptr, 0, &size), RDM_OK);
  std::vector<unsigned char> state(size);
  ASSERT_EQ(rdm_pool_write_state(four.pool, -1, state.data(), size, &size), RDM_OK);
  ASSERT_EQ(rdm_pool_read_state(one.pool, -1, state.data(), size), RDM_OK) << rdm_last_error();
  ASSERT_EQ(rdm_pool_step(four.pool), RDM_OK);
  for (int t = 0; t < 4; ++t) ASSERT_EQ(rdm_pool_step(one.pool), RDM_OK);
  EXPECT_EQ(hash_of(one.pool), hash_of(four.pool));
}

TEST(ActionRepeat, ZeroIsTheTasksOwnRate) {
  for (const auto& [task, rate] :
       {std::pair<const char*, int32_t>{"hand_over_safe_finger", 4}, {"bandit", 1}}) {
    rdm_pool_config c = pool_config(1);
    c.task = task;
    c.settings = "action_repeat=0";
    rdm_spec spec{};
    spec.struct_size = sizeof spec;
    ASSERT_EQ(rdm_pool_config_spec(&c, &spec), RDM_OK);
    EXPECT_EQ(spec.action_repeat, rate);
  }
}

// The rate at which the agent that a task's defaults make decides, where no pool repeats.
double rate_of_agent(rdm_pool* pool) {
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
  c.settings = "hidden=8,8";
  rdm_agent* a = make_agent(c);
  const char* key = "";
  char text[RDM_TEXT_SIZE] = "";
  for (int32_t i = 0; std::strcmp(key, "action_repeat") != 0; ++i)
    if (rdm_agent_setting_at(a, i, &key, text) != RDM_OK) {
      ADD_FAILURE() << rdm_last_error();
      break;
    }
  rdm_agent_destroy(a);
  return std::atof(text);
}

TEST(ActionRepeat, ZeroIsTheRateOfEveryTasksAgent) {
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task task{};
    task.struct_size = sizeof task;
    ASSERT_EQ(rdm_task_at(i, &task), RDM_OK);
    rdm_pool_config c = pool_config(1);
    c.task = task.name;
    rdm_pool* pool = nullptr;
    ASSERT_EQ(rdm_pool_create(&pool, &c), RDM_OK) << task.name;
    c.settings = "action_repeat=0";
    rdm_spec spec{};
    spec.struct_size = sizeof spec;
    ASSERT_EQ(rdm_pool_config_spec(&c, &spec), RDM_OK) << task.name;
    EXPECT_EQ(spec.action_repeat, rate_of_agent(pool)) << task.name;
    rdm_pool_destroy(pool);
  }
}

// ---- learning

struct Trained {
  std::vector<rdm_epoch> epochs;
  std::vector<unsigned char> state, policy;
};

Trained train(const Case& test, int32_t repeat, int32_t mode) {
  Trained out;
  Worlds worlds(test, 4, repeat, mode, 0);
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, worlds.pool), RDM_OK);
  c.settings = "hidden=8,8\nhorizon=16\nminibatches=2\npasses=2\ncost_limit=5";
  rdm_agent* a = make_agent(c);
  for (int e = 0; e < 3; ++e) {
    rdm_epoch epoch{};
    epoch.struct_size = sizeof epoch;
    EXPECT_EQ(rdm_agent_rollout(a, worlds.pool, &epoch), RDM_OK) << rdm_last_error();
    out.epochs.push_back(epoch);
  }
  out.state = saved(a);
  out.policy = policy_bytes(a);
  rdm_agent_destroy(a);
  return out;
}

TEST(ActionRepeat, AnAgentLearnsTheSame) {
  for (const Case& test : {kCases[0], kCases[1]})
    for (const int32_t mode : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP}) {
      SCOPED_TRACE(test.task);
      const int32_t rate = test.task == kCases[0].task ? 4 : 5;  // the tasks' own
      const Trained inside = train(test, rate, mode), outside = train(test, 1, mode);
      ASSERT_EQ(inside.epochs.size(), outside.epochs.size());
      for (size_t e = 0; e < inside.epochs.size(); ++e)
        EXPECT_EQ(std::memcmp(&inside.epochs[e], &outside.epochs[e], sizeof(rdm_epoch)), 0) << "epoch " << e;
      EXPECT_GT(inside.epochs.back().episodes, 0);
      EXPECT_EQ(inside.state, outside.state);
      EXPECT_EQ(inside.policy, outside.policy);
      rdm_policy* policy = nullptr;
      ASSERT_EQ(rdm_policy_read(&policy, inside.policy.data(), inside.policy.size()), RDM_OK);
      rdm_policy_info info{};
      info.struct_size = sizeof info;
      ASSERT_EQ(rdm_policy_get_info(policy, &info), RDM_OK);
      EXPECT_EQ(info.action_repeat, rate);  // for a player whose pool does not repeat
      rdm_policy_destroy(policy);
    }
}

TEST(ActionRepeat, AnAgentsRateIsAMultipleOfThePools) {
  Worlds worlds(kCases[0], 4, 3, RDM_AUTORESET_SAME_STEP, 0);
  rdm_agent_config c;
  ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  ASSERT_EQ(rdm_agent_config_for_pool(&c, worlds.pool), RDM_OK);
  const auto rollout = [&](const char* settings) {
    c.settings = settings;
    rdm_agent* a = make_agent(c);
    const rdm_result r = rdm_agent_rollout(a, worlds.pool, nullptr);
    rdm_agent_destroy(a);
    return r;
  };
  EXPECT_EQ(rollout("hidden=8\nhorizon=8"), RDM_OK) << rdm_last_error();  // the lent default is 3
  EXPECT_EQ(rollout("hidden=8\nhorizon=8\naction_repeat=6"), RDM_OK);
  EXPECT_EQ(rollout("hidden=8\nhorizon=8\naction_repeat=4"), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_last_error(), "action_repeat: the agent's, 4, is not a multiple of the pool's, 3");
}

}  // namespace

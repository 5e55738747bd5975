// Handles that are called within their own calls, or from two threads at a time: STATE, and nothing is lost.
#include <atomic>
#include <chrono>
#include <thread>

#include "called_task.hpp"
#include "contract.hpp"

namespace rdm::test {
namespace {

constexpr const char* kBusy =
    " is in use by a call that has not returned yet: one of another thread, or the one whose callback this "
    "is";

struct Log {
  std::vector<std::string> lines;
  rdm_host hooks{sizeof(rdm_host), 0, this, nullptr, nullptr, write, nullptr};
  static void write(void* user, int32_t level, const char* line) {
    static_cast<Log*>(user)->lines.push_back(std::to_string(level) + " " + line);
  }
};

rdm_pool* pool_of(const char* task, int32_t envs, const rdm_host* host = nullptr) {
  rdm_pool_config c = pool_config(envs);
  c.task = task;
  c.host = host;
  return make_pool(c);
}

rdm_agent* agent_for(const rdm_pool* pool, const char* settings, const rdm_host* host = nullptr) {
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
  c.settings = settings;
  c.host = host;
  return make_agent(c);
}

TEST(InUse, APoolIsNotCalledWithinItsOwnCalls) {
  CalledTask task("in_use_pool");
  Log log;
  rdm_pool* const pool = pool_of("in_use_pool", 2, &log.hooks);
  rdm_pool* const other = pool_of("in_use_pool", 2);
  const std::vector<std::pair<const char*, std::function<rdm_result()>>> calls = {
      {"step", [&] { return rdm_pool_step(pool); }},
      {"reset", [&] { return rdm_pool_reset(pool, nullptr, nullptr); }},
      {"baseline", [&] { return rdm_pool_baseline(pool, RDM_BASELINE_RANDOM); }},
      {"set_state", [&] { return rdm_pool_read_state(pool, 0, "x", 1); }},
      {"copy to", [&] { return rdm_pool_copy(pool, 0, other, 0); }},
      {"copy from", [&] { return rdm_pool_copy(other, 0, pool, 0); }},
      {"hash",
       [&] {
         uint64_t hash;
         return rdm_pool_get_hash(pool, 0, &hash);
       }},
      {"render", [&] {
         float depth[4];
         return rdm_pool_render(pool, 0, "front", 2, 2, nullptr, depth, nullptr);
       }}};
  for (const auto& [name, call] : calls) {
    rdm_result inner = 99;
    std::string text;
    const auto once = [&, &call = call] {
      if (inner != 99) return rdm_result{RDM_OK};
      inner = call();
      text = rdm_last_error();
      return rdm_result{RDM_OK};
    };
    task.reset = [&](rdm_world*, rdm_random*) { return once(); };
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK) << name;
    EXPECT_EQ(inner, RDM_ERROR_STATE) << name << " in reset";
    EXPECT_EQ(text, std::string("pool") + kBusy);
    inner = 99;
    task.reset = nullptr;
    task.judge = [&](const rdm_world*, int64_t, rdm_verdict*) { return once(); };
    EXPECT_EQ(rdm_pool_step(pool), RDM_OK) << name;
    EXPECT_EQ(inner, RDM_ERROR_STATE) << name << " in judge";
    EXPECT_STREQ(rdm_pool_error(pool), "") << "that of a refused call is the thread's alone";
    task.judge = nullptr;
  }
  task.judge = [&](const rdm_world*, int64_t, rdm_verdict*) {
    rdm_pool_destroy(pool);
    return rdm_result{RDM_OK};
  };
  EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(rdm_pool_step(pool), RDM_OK);
  task.judge = nullptr;
  ASSERT_EQ(log.lines.size(), 2u);  // one for each world
  EXPECT_EQ(log.lines[0],
            "2 rdm_pool_destroy: nothing was freed, as a call on the pool has not returned yet");
  EXPECT_EQ(rdm_pool_step(pool), RDM_OK) << "it is whole";
  rdm_pool_destroy(pool);
  rdm_pool_destroy(other);
}

// A rollout is in the agent and in its pool; a cancel goes through.
TEST(InUse, AnAgentIsNotCalledWithinItsRollout) {
  CalledTask task("in_use_agent");
  Log log;
  rdm_pool* const pool = pool_of("in_use_agent", 2, &log.hooks);
  rdm_agent* const agent = agent_for(pool, "horizon=8", &log.hooks);
  EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  std::vector<rdm_result> inner;
  task.judge = [&](const rdm_world*, int64_t, rdm_verdict*) {
    if (!inner.empty()) return rdm_result{RDM_OK};
    size_t size;
    float obs[2] = {}, action[2];
    uint64_t hash;
    const rdm_option rate = {"learning_rate", nullptr, 1e-3};
    inner = {rdm_agent_rollout(agent, pool, nullptr),
             rdm_agent_act(agent, obs, RDM_ACT_MEAN, action),
             rdm_agent_update(agent, obs, nullptr),
             rdm_agent_set_option(agent, &rate),
             rdm_agent_write_state(agent, nullptr, 0, &size),
             rdm_pool_step(pool),
             rdm_pool_get_hash(pool, 0, &hash)};
    rdm_agent_destroy(agent);
    rdm_pool_destroy(pool);
    return rdm_result{RDM_OK};
  };
  rdm_epoch e{};
  e.struct_size = sizeof e;
  EXPECT_EQ(rdm_agent_rollout(agent, pool, &e), RDM_OK) << rdm_agent_error(agent);
  EXPECT_EQ(inner, std::vector<rdm_result>(7, RDM_ERROR_STATE));
  EXPECT_EQ(e.env_steps, 16);
  EXPECT_EQ(log.lines.size(), 2u);
  task.judge = [&](const rdm_world*, int64_t, rdm_verdict*) {
    rdm_agent_cancel(agent);
    return rdm_result{RDM_OK};
  };
  EXPECT_EQ(rdm_agent_rollout(agent, pool, &e), RDM_ERROR_CANCELLED);
  task.judge = nullptr;
  EXPECT_EQ(rdm_agent_rollout(agent, pool, &e), RDM_OK) << rdm_agent_error(agent);
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool);
}

// A planner, its pool and its critic, while its worlds are stepped.
TEST(InUse, APlannerIsNotCalledWithinItsPlan) {
  CalledTask task("in_use_planner");
  rdm_pool* const pool = pool_of("in_use_planner", 1);
  rdm_agent* const agent = agent_for(pool, "horizon=8");
  EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  rdm_planner_config c;
  EXPECT_EQ(rdm_planner_config_init(&c, sizeof c), RDM_OK);
  c.pool = pool;
  c.agent = agent;
  c.settings = "samples=2\nhorizon=2";
  rdm_planner* planner = nullptr;
  ASSERT_EQ(rdm_planner_create(&planner, &c), RDM_OK) << rdm_last_error();
  float action[1];
  std::vector<rdm_result> inner;
  task.judge = [&](const rdm_world*, int64_t, rdm_verdict*) {
    if (!inner.empty()) return rdm_result{RDM_OK};
    float row[1] = {}, value[1];
    uint64_t hash;
    inner = {rdm_planner_act(planner, pool, 0, row, nullptr), rdm_planner_reset(planner),
             rdm_planner_get_plan(planner, row), rdm_pool_step(pool),
             rdm_agent_get_values(agent, row, 1, value, nullptr)};
    EXPECT_EQ(rdm_pool_get_hash(pool, 0, &hash), RDM_OK) << "two that read";
    rdm_planner_destroy(planner);
    rdm_agent_destroy(agent);
    return rdm_result{RDM_OK};
  };
  EXPECT_EQ(rdm_planner_act(planner, pool, 0, action, nullptr), RDM_OK) << rdm_last_error();
  EXPECT_EQ(inner, std::vector<rdm_result>(5, RDM_ERROR_STATE));
  task.judge = nullptr;
  EXPECT_EQ(rdm_planner_act(planner, pool, 0, action, nullptr), RDM_OK);
  rdm_planner_destroy(planner);
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool);
}

// One thread is in a step until another one has tried everything.
TEST(InUse, OneThreadAtATime) {
  CalledTask task("in_use_threads");
  rdm_pool* const pool = pool_of("in_use_threads", 1);
  EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  std::atomic<bool> inside = false, tried = false;
  task.judge = [&](const rdm_world*, int64_t, rdm_verdict*) {
    inside = true;
    while (!tried) std::this_thread::yield();
    return rdm_result{RDM_OK};
  };
  std::thread steps([&] { EXPECT_EQ(rdm_pool_step(pool), RDM_OK); });
  while (!inside) std::this_thread::yield();
  uint64_t hash;
  EXPECT_EQ(rdm_pool_step(pool), RDM_ERROR_STATE);
  EXPECT_EQ(rdm_pool_get_hash(pool, 0, &hash), RDM_ERROR_STATE);
  EXPECT_EQ(std::string(rdm_last_error()), std::string("pool") + kBusy);
  rdm_pool_destroy(pool);
  tried = true;
  steps.join();
  task.judge = nullptr;
  EXPECT_EQ(rdm_pool_step(pool), RDM_OK);
  rdm_pool_destroy(pool);
}

// Two threads go for one pool: each call is either whole or refused, so the steps add up.
TEST(InUse, CallsThatRaceAreWholeOrRefused) {
  rdm_pool_config c = pool_config(2);
  rdm_pool* const pool = make_pool(c);
  EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  std::atomic<int64_t> steps = 0, refused = 0;
  const auto go = [&] {
    for (int i = 0; i < 300; ++i) {
      const rdm_result r = rdm_pool_step(pool);
      EXPECT_TRUE(r == RDM_OK || r == RDM_ERROR_STATE) << rdm_last_error();
      ++(r == RDM_OK ? steps : refused);
    }
  };
  std::thread a(go), b(go);
  a.join();
  b.join();
  EXPECT_EQ(steps + refused, 600);
  rdm_pool_stats s{};
  s.struct_size = sizeof s;
  EXPECT_EQ(rdm_pool_get_stats(pool, &s), RDM_OK);
  EXPECT_EQ(s.steps, 2 * steps);
  rdm_pool_destroy(pool);
}

// Any number may read at a time, and fail at it.
TEST(InUse, ManyMayRead) {
  rdm_pool_config c = pool_config(2);
  rdm_pool* const pool = make_pool(c);
  EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  rdm_recording_config rc;
  EXPECT_EQ(rdm_recording_config_init(&rc, sizeof rc), RDM_OK);
  EXPECT_EQ(rdm_recording_config_for_pool(&rc, pool), RDM_OK);
  rdm_recording* recording = nullptr;
  ASSERT_EQ(rdm_recording_create(&recording, &rc), RDM_OK);
  uint64_t wanted = 0;
  EXPECT_EQ(rdm_pool_get_hash(pool, -1, &wanted), RDM_OK);
  const auto read = [&] {
    for (int i = 0; i < 200; ++i) {
      uint64_t hash = 0;
      size_t size = 0;
      EXPECT_EQ(rdm_pool_get_hash(pool, -1, &hash), RDM_OK);
      EXPECT_EQ(hash, wanted);
      EXPECT_EQ(rdm_pool_write_state(pool, 9, nullptr, 0, &size), RDM_ERROR_RANGE);
      rdm_recording_info info{};
      info.struct_size = sizeof info;
      EXPECT_EQ(rdm_recording_get_info(recording, &info), RDM_OK);
    }
  };
  std::thread a(read), b(read);
  a.join();
  b.join();
  EXPECT_STREQ(rdm_pool_error(pool), "env: 9 is outside [0, 2)");
  rdm_recording_destroy(recording);
  rdm_pool_destroy(pool);
}

// ---- hooks that do not run what they should
// -----------------------------------------------------------------

struct Jobs {
  enum class Does { kAll, kNothing, kTwice, kLess };
  std::atomic<Does> does = Does::kAll;
  rdm_host hooks{sizeof(rdm_host), 0, this, nullptr, nullptr, nullptr, run};
  static void run(void* user, int32_t n, rdm_body body, void* context) {
    const Does does = static_cast<Jobs*>(user)->does;
    if (does == Does::kNothing) return;
    for (int32_t i = does == Does::kLess ? 1 : 0; i < n; ++i) body(context, i);
    if (does == Does::kTwice) body(context, 0);
  }
};

TEST(ParallelHook, ThatRunsTooLittleOrTooMuchIsTold) {
  const std::pair<Jobs::Does, const char*> rows[] = {
      {Jobs::Does::kNothing, "the parallel hook ran 0 of 2 pieces"},
      {Jobs::Does::kLess, "the parallel hook ran 1 of 2 pieces"},
      {Jobs::Does::kTwice, "the parallel hook ran index 0 twice"}};
  for (const auto& [does, text] : rows) {
    Jobs jobs;
    rdm_pool_config c = pool_config(4);
    c.num_threads = 2;
    c.host = &jobs.hooks;
    rdm_pool* const pool = make_pool(c);
    jobs.does = does;
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_ERROR_STATE);
    EXPECT_STREQ(rdm_pool_error(pool), text);
    jobs.does = Jobs::Does::kAll;
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
    jobs.does = does;
    EXPECT_EQ(rdm_pool_step(pool), RDM_ERROR_STATE);
    EXPECT_STREQ(rdm_pool_error(pool), text);

    // an agent over it learns nothing of rows that stand from before
    jobs.does = Jobs::Does::kAll;
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
    rdm_agent* const agent = agent_for(pool, "horizon=16\nminibatches=1");
    rdm_epoch e{};
    e.struct_size = sizeof e;
    jobs.does = does;
    EXPECT_EQ(rdm_agent_rollout(agent, pool, &e), RDM_ERROR_STATE);
    EXPECT_STREQ(rdm_agent_error(agent), text);
    EXPECT_EQ(e.epoch, 0);
    jobs.does = Jobs::Does::kAll;
    EXPECT_EQ(rdm_agent_rollout(agent, pool, &e), RDM_OK) << rdm_agent_error(agent);
    EXPECT_EQ(e.epoch, 1);
    rdm_agent_destroy(agent);

    // an agent's own hook, in its update
    rdm_agent_config a;
    EXPECT_EQ(rdm_agent_config_init(&a, sizeof a), RDM_OK);
    EXPECT_EQ(rdm_agent_config_for_pool(&a, pool), RDM_OK);
    a.settings = "horizon=256\nminibatches=1";
    a.num_threads = 2;
    a.host = &jobs.hooks;
    rdm_agent* const spread = make_agent(a);
    rdm_buffers b{};
    b.struct_size = sizeof b;
    EXPECT_EQ(rdm_pool_get_buffers(pool, &b), RDM_OK);
    rdm_transition t{};
    t.struct_size = sizeof t;
    t.reward = b.reward, t.cost = b.cost;
    for (int i = 0; i < 256; ++i) {
      EXPECT_EQ(rdm_agent_act(spread, b.obs, RDM_ACT_SAMPLE, b.action), RDM_OK);
      EXPECT_EQ(rdm_agent_record(spread, &t), RDM_OK);
    }
    jobs.does = does;
    EXPECT_EQ(rdm_agent_update(spread, b.obs, &e), RDM_ERROR_STATE);
    EXPECT_STREQ(rdm_agent_error(spread), text);
    jobs.does = Jobs::Does::kAll;
    rdm_agent_destroy(spread);

    // a planner's
    rdm_planner_config p;
    EXPECT_EQ(rdm_planner_config_init(&p, sizeof p), RDM_OK);
    p.pool = pool;
    p.settings = "samples=4\nhorizon=2";
    p.num_threads = 2;
    p.host = &jobs.hooks;
    rdm_planner* planner = nullptr;
    ASSERT_EQ(rdm_planner_create(&planner, &p), RDM_OK) << rdm_last_error();
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
    jobs.does = does;
    EXPECT_EQ(rdm_planner_act(planner, pool, 0, b.action, nullptr), RDM_ERROR_STATE);
    EXPECT_STREQ(rdm_planner_error(planner), text);
    jobs.does = Jobs::Does::kAll;
    EXPECT_EQ(rdm_planner_act(planner, pool, 0, b.action, nullptr), RDM_OK) << rdm_planner_error(planner);
    rdm_planner_destroy(planner);
    rdm_pool_destroy(pool);
  }
}

}  // namespace
}  // namespace rdm::test

// A world copied as memory goes on with the bytes of one that was saved and restored, for any task and
// engine.
#include <algorithm>
#include <cstring>

#include "base/rng.hpp"
#include "contract.hpp"
#include "heap_count.hpp"

namespace {

struct Case {
  std::string task;
  std::string settings;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.task << ' ' << c.settings;
}

std::vector<Case> cases() {
  std::vector<Case> out;
  for (const std::string& task : task_names()) out.push_back({task, ""});
  for (const char* task : {"hand_over_safe_finger", "grasp", "jenga"}) out.push_back({task, "engine=ode"});
  out.push_back(
      {"grasp",
       "object_mass=0.05..0.2\nobject_scale=0.8..1.2\nnoise.object.position=0.01\ndelay.*_tip_*=1..3\n"
       "action_delay=2\ndropout.*=0.1"});
  out.push_back({"hand_over_safe_finger", "action_repeat=4\nmax_steps=30"});
  return out;
}

struct Worlds {
  rdm_pool* pool;
  rdm_spec spec{};
  rdm_buffers b;
  int32_t n;

  Worlds(const Case& test, int32_t envs, int32_t threads, uint64_t seed,
         int32_t autoreset = RDM_AUTORESET_SAME_STEP)
      : n(envs) {
    rdm_pool_config c = pool_config(envs);
    c.task = test.task.c_str();
    c.seed = seed;
    c.num_threads = threads;
    c.autoreset = autoreset;
    c.settings = test.settings.c_str();
    pool = make_pool(c);
    if (!pool) return;
    spec.struct_size = sizeof spec;
    EXPECT_EQ(rdm_pool_get_spec(pool, &spec), RDM_OK);
    b = buffers_of(pool);
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  }
  ~Worlds() { rdm_pool_destroy(pool); }

  // World env takes the action that the stream has next.
  void step(int32_t env, rdm::Stream stream) {
    std::vector<uint8_t> mask(static_cast<size_t>(n));
    mask[static_cast<size_t>(env)] = 1;
    stream.signed_units(b.action + env * spec.action_dim, spec.action_dim);
    ASSERT_EQ(rdm_pool_step_masked(pool, mask.data()), RDM_OK) << rdm_pool_error(pool);
  }
  std::vector<float> rows(int32_t env) const {
    std::vector<float> out;
    const auto add = [&](const float* rows, int32_t width) {
      out.insert(out.end(), rows + env * width, rows + (env + 1) * width);
    };
    add(b.obs, spec.obs_dim);
    add(b.final_obs, spec.obs_dim);
    add(b.reward, 1);
    add(b.cost, spec.cost_dim);
    add(b.cost_raw, spec.cost_dim);
    add(b.episode_return, 1);
    add(b.episode_cost, spec.cost_dim);
    for (const int x : {static_cast<int>(b.episode_step[env]), static_cast<int>(b.status[env]),
                        static_cast<int>(b.terminated[env]), static_cast<int>(b.truncated[env]),
                        static_cast<int>(b.success[env])})
      out.push_back(static_cast<float>(x));
    return out;
  }
  uint64_t hash(int32_t env) const {
    uint64_t h = 0;
    EXPECT_EQ(rdm_pool_get_hash(pool, env, &h), RDM_OK);
    return h;
  }
  std::vector<unsigned char> state(int32_t env) const {
    size_t size = 0;
    EXPECT_EQ(rdm_pool_write_state(pool, env, nullptr, 0, &size), RDM_OK);
    std::vector<unsigned char> bytes(size);
    EXPECT_EQ(rdm_pool_write_state(pool, env, bytes.data(), size, &size), RDM_OK);
    return bytes;
  }
};

rdm::Stream actions(int step) {
  return {static_cast<uint64_t>(step), 3, rdm::Purpose::kTest};
}

class PoolCopy : public testing::TestWithParam<Case> {};

TEST_P(PoolCopy, GoesOnWithTheBytesOfASavedState) {
  Worlds from(GetParam(), 2, 0, 1), copied(GetParam(), 3, 2, 77), restored(GetParam(), 1, 0, 5);
  ASSERT_TRUE(from.pool && copied.pool && restored.pool);
  for (int i = 0; i < 9; ++i) from.step(1, actions(i));
  for (int i = 0; i < 4; ++i) copied.step(2, actions(100 + i));  // what was there before does not matter
  for (int i = 0; i < 6; ++i) restored.step(0, actions(200 + i));
  const uint64_t other = copied.hash(0);
  const std::vector<unsigned char> state = from.state(1);
  ASSERT_EQ(rdm_pool_read_state(restored.pool, 0, state.data(), state.size()), RDM_OK);
  ASSERT_EQ(rdm_pool_copy(copied.pool, 2, from.pool, 1), RDM_OK) << rdm_pool_error(copied.pool);
  EXPECT_EQ(copied.state(2), state);
  EXPECT_EQ(copied.rows(2), from.rows(1));
  EXPECT_EQ(copied.hash(0), other);
  for (int i = 0; i < 25; ++i) {
    from.step(1, actions(300 + i));
    copied.step(2, actions(300 + i));
    restored.step(0, actions(300 + i));
    ASSERT_EQ(copied.hash(2), restored.hash(0)) << "step " << i;
    ASSERT_EQ(copied.rows(2), restored.rows(0)) << "step " << i;
    ASSERT_EQ(copied.hash(2), from.hash(1)) << "step " << i;
    ASSERT_EQ(copied.rows(2), from.rows(1)) << "step " << i;
  }
}

TEST_P(PoolCopy, FillsAPoolFromOneOfItsOwnWorlds) {
  Worlds a(GetParam(), 20, 3, 4);
  ASSERT_TRUE(a.pool);
  for (int i = 0; i < 5; ++i) a.step(7, actions(i));
  const std::vector<unsigned char> state = a.state(7);
  const std::vector<float> rows = a.rows(7);
  ASSERT_EQ(rdm_pool_copy(a.pool, 7, a.pool, 7), RDM_OK);
  EXPECT_EQ(a.state(7), state);
  EXPECT_EQ(a.rows(7), rows);
  ASSERT_EQ(rdm_pool_copy(a.pool, -1, a.pool, 7), RDM_OK);
  for (int32_t env = 0; env < a.n; ++env) {
    EXPECT_EQ(a.state(env), state) << env;
    EXPECT_EQ(a.rows(env), rows) << env;
  }
}

// A tower that has fallen asleep, copied, sleeps and wakes as the restored one does.
TEST(PoolCopyOfSleepers, GoOnWithTheBytesOfASavedState) {
  const Case test{"jenga", ""};
  Worlds from(test, 1, 0, 1), copied(test, 1, 0, 2), restored(test, 1, 0, 3);
  ASSERT_TRUE(from.pool && copied.pool && restored.pool);
  const auto hold = [](const Worlds& w, int steps) {
    for (int i = 0; i < steps; ++i) {
      ASSERT_EQ(rdm_pool_baseline(w.pool, RDM_BASELINE_HOLD), RDM_OK);
      ASSERT_EQ(rdm_pool_step(w.pool), RDM_OK);
    }
  };
  hold(from, 120);
  hold(copied, 20);
  const std::vector<unsigned char> state = from.state(0);
  ASSERT_EQ(rdm_pool_read_state(restored.pool, 0, state.data(), state.size()), RDM_OK);
  ASSERT_EQ(rdm_pool_copy(copied.pool, 0, from.pool, 0), RDM_OK);
  EXPECT_EQ(copied.state(0), state);
  for (Worlds* w : {&from, &copied, &restored}) hold(*w, 20);
  EXPECT_EQ(copied.hash(0), from.hash(0));
  EXPECT_EQ(copied.hash(0), restored.hash(0));
  for (int i = 0; i < 60; ++i)
    for (Worlds* w : {&from, &copied, &restored}) w->step(0, actions(i));
  EXPECT_EQ(copied.hash(0), from.hash(0));
  EXPECT_EQ(copied.hash(0), restored.hash(0));
}

INSTANTIATE_TEST_SUITE_P(EveryTask, PoolCopy, testing::ValuesIn(cases()), [](const auto& info) {
  std::string name = info.param.task + "_" + std::to_string(info.index);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(PoolCopyErrors, PoolsThatDifferAndWorldsThatAreNotThereAreRefused) {
  Worlds a({"lqr_line", ""}, 2, 0, 1), options({"lqr_line", "noise=0.2"}, 2, 0, 1),
      task({"two_state", ""}, 2, 0, 1);
  const uint64_t before = a.hash(-1);
  const auto refused = [&](int32_t env, const rdm_pool* src, int32_t src_env, rdm_result code,
                           const char* text) {
    EXPECT_EQ(rdm_pool_copy(a.pool, env, src, src_env), code) << text;
    EXPECT_NE(std::string(rdm_pool_error(a.pool)).find(text), std::string::npos) << rdm_pool_error(a.pool);
    EXPECT_EQ(a.hash(-1), before);
  };
  refused(0, options.pool, 0, RDM_ERROR_ARGUMENT, "other options");
  refused(0, task.pool, 0, RDM_ERROR_ARGUMENT, "task two_state");
  refused(2, a.pool, 0, RDM_ERROR_RANGE, "dst_env: 2 is outside [-1, 2)");
  refused(-2, a.pool, 0, RDM_ERROR_RANGE, "dst_env: -2");
  refused(0, a.pool, -1, RDM_ERROR_RANGE, "src_env: -1 is outside [0, 2)");
  refused(0, a.pool, 2, RDM_ERROR_RANGE, "src_env: 2");
  refused(0, nullptr, 0, RDM_ERROR_ARGUMENT, "pool is NULL");
  EXPECT_EQ(rdm_pool_copy(nullptr, 0, a.pool, 0), RDM_ERROR_ARGUMENT);
}

TEST(PoolCopyErrors, AWorldThatWaitsForItsResetIsCopiedToo) {
  const Case test{"lqr_line", "max_steps=2"};
  Worlds a(test, 1, 0, 1, RDM_AUTORESET_OFF), b(test, 1, 0, 2, RDM_AUTORESET_OFF);
  a.step(0, actions(0));
  a.step(0, actions(1));
  ASSERT_EQ(a.b.truncated[0], 1);
  ASSERT_EQ(rdm_pool_copy(b.pool, 0, a.pool, 0), RDM_OK);
  EXPECT_EQ(b.b.truncated[0], 1);
  EXPECT_EQ(rdm_pool_step(b.pool), RDM_ERROR_STATE);
  rdm_pool_config c = pool_config(1);
  c.task = "lqr_line";
  c.settings = "max_steps=2";
  rdm_pool* fresh = make_pool(c);
  ASSERT_EQ(rdm_pool_copy(b.pool, 0, fresh, 0), RDM_OK);
  EXPECT_EQ(rdm_pool_step(b.pool), RDM_ERROR_STATE);  // never reset, as the other
  rdm_pool_destroy(fresh);
}

TEST(PoolCopyErrors, NoHeap) {
  if (!kHeapIsCounted) GTEST_SKIP();
  const Case test{"hand_over_safe_finger", ""};
  Worlds a(test, 1, 0, 1), b(test, 32, 2, 2);
  ASSERT_EQ(rdm_pool_copy(b.pool, -1, a.pool, 0), RDM_OK);
  const int64_t before = heap_count();
  ASSERT_EQ(rdm_pool_copy(b.pool, -1, a.pool, 0), RDM_OK);
  ASSERT_EQ(rdm_pool_copy(b.pool, 3, b.pool, 4), RDM_OK);
  EXPECT_EQ(heap_count(), before);
}

}  // namespace

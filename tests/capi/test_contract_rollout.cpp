// Agents on pools through the C ABI: rollouts, checkpoints, cancelling, threads, both kinds of autoreset.
#include <cstdio>

#include "contract.hpp"

namespace {

// A pool of 4 worlds and a small agent made for it.
struct Pair {
  rdm_pool* pool = nullptr;
  rdm_agent* agent = nullptr;

  explicit Pair(int32_t autoreset = RDM_AUTORESET_SAME_STEP, int32_t threads = 0) {
    rdm_pool_config pc = pool_config(4);
    pc.autoreset = autoreset;
    pc.num_threads = threads;
    pool = make_pool(pc);
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
    rdm_agent_config c;
    EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
    EXPECT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
    const rdm_option small[] = {{"hidden", "8", 0}, {"horizon", nullptr, 8}};
    c.options = small;
    c.num_options = 2;
    c.num_threads = threads;
    agent = make_agent(c);
  }
  ~Pair() {
    rdm_agent_destroy(agent);
    rdm_pool_destroy(pool);
  }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;

  void epochs(int count, rdm_epoch* io = nullptr) {
    for (int i = 0; i < count; ++i)
      ASSERT_EQ(rdm_agent_rollout(agent, pool, io), RDM_OK) << rdm_agent_error(agent);
  }
};

std::string checkpoint_path() {
  return testing::TempDir() + "redman_contract_checkpoint.rdm";
}

TEST(ContractRollout, CheckpointsCarryAgentPoolAndNote) {
  for (const int32_t mode : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP}) {
    const std::string path = checkpoint_path();
    Pair a(mode);
    a.epochs(3);
    ASSERT_EQ(rdm_checkpoint_write(path.c_str(), a.agent, a.pool, "hello", 5), RDM_OK) << rdm_last_error();
    a.epochs(3);
    Pair b(mode);
    char note[16] = {};
    size_t n = 0;
    ASSERT_EQ(rdm_checkpoint_read(path.c_str(), b.agent, b.pool, note, sizeof note, &n), RDM_OK)
        << rdm_last_error();
    EXPECT_EQ(std::string(note, n), "hello");
    b.epochs(3);
    EXPECT_EQ(saved(b.agent), saved(a.agent)) << mode;
    EXPECT_EQ(hash_of(b.pool), hash_of(a.pool)) << mode;
    rdm_agent* other = make_agent(agent_config());
    const uint64_t before = hash_of(b.pool);
    EXPECT_LT(rdm_checkpoint_read(path.c_str(), other, b.pool, note, sizeof note, &n), 0);
    EXPECT_EQ(hash_of(b.pool), before);  // the pool went back to what it was
    rdm_agent_destroy(other);
    std::remove(path.c_str());
  }
}

// All that a host sees of a pool: the rows and the state.
std::vector<unsigned char> seen(const rdm_pool* p) {
  const rdm_spec s = spec_of(p);
  const rdm_buffers b = buffers_of(p);
  std::vector<unsigned char> out;
  const auto add = [&](const void* data, size_t bytes) {
    const auto* d = static_cast<const unsigned char*>(data);
    out.insert(out.end(), d, d + bytes);
  };
  const size_t n = 4, row = sizeof(float) * n, costs = row * static_cast<size_t>(s.cost_dim),
               obs = row * static_cast<size_t>(s.obs_dim);
  add(b.obs, obs);
  add(b.final_obs, obs);
  add(b.action, row * static_cast<size_t>(s.action_dim));
  add(b.reward, row);
  add(b.cost, costs);
  add(b.cost_raw, costs);
  add(b.episode_return, row);
  add(b.episode_cost, costs);
  add(b.episode_step, row);
  add(b.status, row);
  add(b.terminated, n);
  add(b.truncated, n);
  add(b.success, n);
  const uint64_t hash = hash_of(p);
  add(&hash, sizeof hash);
  return out;
}

TEST(ContractRollout, ACheckpointThatIsRefusedChangesNothing) {
  const std::string path = checkpoint_path();
  Pair a;
  a.epochs(2);
  ASSERT_EQ(rdm_checkpoint_write(path.c_str(), a.agent, a.pool, "hello", 5), RDM_OK) << rdm_last_error();
  a.epochs(1);
  for (int i = 0; i < 3; ++i) ASSERT_EQ(rdm_pool_step(a.pool), RDM_OK);
  char note[16] = "before";
  size_t n = 77;
  const auto pool_before = seen(a.pool), agent_before = saved(a.agent);

  // the pool would take it, the agent does not
  rdm_agent_config c;
  ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  ASSERT_EQ(rdm_agent_config_for_pool(&c, a.pool), RDM_OK);
  const rdm_option other_net[] = {{"hidden", "16", 0}, {"horizon", nullptr, 8}};
  c.options = other_net;
  c.num_options = 2;
  rdm_agent* other = make_agent(c);
  EXPECT_EQ(rdm_checkpoint_read(path.c_str(), other, a.pool, note, sizeof note, &n), RDM_ERROR_FORMAT);
  EXPECT_EQ(seen(a.pool), pool_before);
  rdm_agent_destroy(other);

  // the agent would take it, the pool does not
  rdm_pool* small = make_pool(pool_config(3));
  EXPECT_EQ(rdm_checkpoint_read(path.c_str(), a.agent, small, note, sizeof note, &n), RDM_ERROR_FORMAT);
  EXPECT_EQ(saved(a.agent), agent_before);
  rdm_pool_destroy(small);

  // it has no pool
  ASSERT_EQ(rdm_checkpoint_write(path.c_str(), a.agent, nullptr, "hello", 5), RDM_OK);
  EXPECT_EQ(rdm_checkpoint_read(path.c_str(), a.agent, a.pool, note, sizeof note, &n), RDM_ERROR_FORMAT);
  EXPECT_EQ(seen(a.pool), pool_before);
  EXPECT_EQ(saved(a.agent), agent_before);
  EXPECT_STREQ(note, "before");
  EXPECT_EQ(n, 77u);
  std::remove(path.c_str());
}

TEST(ContractRollout, ACheckpointThatFindsNoMemoryChangesNothing) {
  const std::string path = checkpoint_path();
  CountingHost host;  // of the process: reading a file takes memory from it
  CountingHost handles;
  rdm_pool_config pc = pool_config(4);
  pc.host = &handles.hooks;
  rdm_pool* pool = make_pool(pc);
  ASSERT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  rdm_agent_config c;
  ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  ASSERT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
  const rdm_option small[] = {{"hidden", "8", 0}, {"horizon", nullptr, 8}};
  c.options = small;
  c.num_options = 2;
  c.host = &handles.hooks;
  rdm_agent* agent = make_agent(c);
  ASSERT_EQ(rdm_agent_rollout(agent, pool, nullptr), RDM_OK);
  ASSERT_EQ(rdm_checkpoint_write(path.c_str(), agent, pool, "hello", 5), RDM_OK) << rdm_last_error();
  ASSERT_EQ(rdm_init(&host.hooks), RDM_OK);
  char note[16];
  size_t n = 0;
  for (CountingHost* refusing : {&host, &handles}) {
    ASSERT_EQ(rdm_agent_rollout(agent, pool, nullptr), RDM_OK);
    const auto pool_before = seen(pool), agent_before = saved(agent);
    int refused = 0;
    for (rdm_result r = RDM_ERROR_MEMORY; r != RDM_OK; ++refused) {
      ASSERT_LT(refused, 1000);
      refusing->calls = 0;
      refusing->refuse_at = static_cast<size_t>(refused);
      r = rdm_checkpoint_read(path.c_str(), agent, pool, note, sizeof note, &n);
      refusing->refuse_at = SIZE_MAX;
      if (r == RDM_OK) break;
      ASSERT_EQ(r, RDM_ERROR_MEMORY) << rdm_last_error();
      ASSERT_EQ(seen(pool), pool_before) << refused;
      ASSERT_EQ(saved(agent), agent_before) << refused;
    }
    EXPECT_EQ(refused > 0, refusing == &host) << refused;  // the handles have all that they need
    EXPECT_NE(saved(agent), agent_before);
  }
  // an agent that refuses its part, while there is no memory to put the pool back
  const rdm_option wide[] = {{"hidden", "16", 0}, {"horizon", nullptr, 8}};
  c.options = wide;
  rdm_agent* other = make_agent(c);
  ASSERT_EQ(rdm_agent_rollout(agent, pool, nullptr), RDM_OK);
  const auto pool_before = seen(pool), other_before = saved(other);
  for (CountingHost* refusing : {&host, &handles})
    for (size_t k = 0; k < 12; ++k) {
      refusing->calls = 0;
      refusing->refuse_at = k;
      const rdm_result r = rdm_checkpoint_read(path.c_str(), other, pool, note, sizeof note, &n);
      refusing->refuse_at = SIZE_MAX;
      ASSERT_TRUE(r == RDM_ERROR_MEMORY || r == RDM_ERROR_FORMAT) << r;
      ASSERT_EQ(seen(pool), pool_before) << k;
      ASSERT_EQ(saved(other), other_before) << k;
    }
  rdm_agent_destroy(other);
  rdm_shutdown();
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool);
  EXPECT_EQ(handles.live, 0u);
  EXPECT_EQ(host.live, 0u);
  std::remove(path.c_str());
}

TEST(ContractRollout, AnyNumberOfThreadsGivesTheSameBytes) {
  Pair one;
  one.epochs(4);
  const auto expected = saved(one.agent);
  for (const int32_t threads : {1, 2, 4}) {
    Pair many(RDM_AUTORESET_SAME_STEP, threads);
    many.epochs(4);
    EXPECT_EQ(saved(many.agent), expected) << threads;
    EXPECT_EQ(hash_of(many.pool), hash_of(one.pool)) << threads;
  }
}

// In next-step mode the step after an end only resets: it is no experience, no reward and no control step.
TEST(ContractRollout, DeadStepsAreNotCounted) {
  Pair next(RDM_AUTORESET_NEXT_STEP);
  rdm_epoch e{};
  e.struct_size = sizeof e;
  next.epochs(20, &e);  // 160 decisions of 4 steps: every world ends several episodes
  EXPECT_GT(e.episodes, 4);
  EXPECT_LE(e.length, 75);
  rdm_pool_stats s{};
  s.struct_size = sizeof s;
  ASSERT_EQ(rdm_pool_get_stats(next.pool, &s), RDM_OK);
  EXPECT_LE(e.env_steps, s.steps);
}

TEST(ContractRollout, APoolThatWasNotResetChangesNothing) {
  Pair a;
  rdm_pool* fresh = make_pool(pool_config(4));
  const auto state = [&] {
    size_t size = 0;
    EXPECT_EQ(rdm_agent_write_state(a.agent, nullptr, 0, &size), RDM_OK);
    std::vector<unsigned char> bytes(size);
    EXPECT_EQ(rdm_agent_write_state(a.agent, bytes.data(), size, &size), RDM_OK);
    return bytes;
  };
  const auto before = state();
  EXPECT_EQ(rdm_agent_rollout(a.agent, fresh, nullptr), RDM_ERROR_STATE);
  EXPECT_NE(std::string(rdm_last_error()).find("world 0 was not reset"), std::string::npos)
      << rdm_last_error();
  EXPECT_EQ(state(), before);
  rdm_pool_destroy(fresh);
}

TEST(ContractRollout, CancelLeavesAGoodHandle) {
  Pair a;
  rdm_agent_cancel(a.agent);
  EXPECT_EQ(rdm_agent_rollout(a.agent, a.pool, nullptr), RDM_ERROR_CANCELLED);
  a.epochs(1);
  rdm_pool* small = make_pool(pool_config(2));
  EXPECT_EQ(rdm_agent_rollout(a.agent, small, nullptr), RDM_ERROR_ARGUMENT);  // another number of worlds
  rdm_pool_destroy(small);
  Pair off(RDM_AUTORESET_OFF);
  EXPECT_EQ(rdm_agent_rollout(off.agent, off.pool, nullptr), RDM_ERROR_STATE);
}

}  // namespace

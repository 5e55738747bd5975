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

TEST(ContractRollout, CancelLeavesAGoodHandle) {
  Pair a;
  rdm_agent_cancel(a.agent);
  EXPECT_EQ(rdm_agent_rollout(a.agent, a.pool, nullptr), RDM_CANCELLED);
  a.epochs(1);
  rdm_pool* small = make_pool(pool_config(2));
  EXPECT_EQ(rdm_agent_rollout(a.agent, small, nullptr), RDM_ARGUMENT);  // another number of worlds
  rdm_pool_destroy(small);
  Pair off(RDM_AUTORESET_OFF);
  EXPECT_EQ(rdm_agent_rollout(off.agent, off.pool, nullptr), RDM_STATE);
}

}  // namespace

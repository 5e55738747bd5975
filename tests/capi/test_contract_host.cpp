// What a host may rely on: exact memory, refusals that leak nothing, its own threads, its floating-point
// mode.
#include <sys/wait.h>

#include <cfenv>
#include <thread>

#include "contract.hpp"

namespace {

TEST(ContractHost, MemoryIsExactToTheByte) {
  CountingHost host;
  rdm_pool_config c = pool_config(3);
  c.host = &host.hooks;
  size_t ours = 0, engines = 0;
  ASSERT_EQ(rdm_pool_config_memory(&c, &ours, &engines), RDM_OK) << rdm_last_error();
  EXPECT_EQ(host.live, 0u);
  rdm_pool* p = make_pool(c);
  EXPECT_EQ(host.live, ours);
  EXPECT_GT(engines, 0u);
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  const size_t calls = host.calls;
  for (int i = 0; i < 200; ++i) ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  EXPECT_EQ(host.calls, calls);
  rdm_pool_destroy(p);
  EXPECT_EQ(host.live, 0u);

  for (const char* algo : {"ppo", "ppo_lag"}) {
    rdm_agent_config ac = agent_config();
    ac.host = &host.hooks;
    ac.algo = algo;
    ASSERT_EQ(rdm_agent_config_memory(&ac, &ours), RDM_OK) << rdm_last_error();
    EXPECT_EQ(host.live, 0u);
    rdm_agent* a = make_agent(ac);
    EXPECT_EQ(host.live, ours) << algo;
    const size_t agent_calls = host.calls;
    ASSERT_EQ(feed_epoch(a), RDM_OK);
    EXPECT_EQ(host.calls, agent_calls);
    rdm_agent_destroy(a);
    EXPECT_EQ(host.live, 0u);
  }
}

TEST(ContractHost, EveryRefusedAllocationIsSurvived) {
  bool made = false;
  for (size_t k = 0; !made; ++k) {
    CountingHost host;
    host.refuse_at = k;
    rdm_pool_config c = pool_config(2);
    c.host = &host.hooks;
    rdm_pool* p = nullptr;
    const rdm_result r = rdm_pool_create(&p, &c);
    made = r == RDM_OK;
    if (!made) {
      ASSERT_EQ(r, RDM_ERROR_MEMORY) << k << ' ' << rdm_last_error();
      ASSERT_EQ(p, nullptr);
    }
    rdm_pool_destroy(p);
    ASSERT_EQ(host.live, 0u) << k;
    ASSERT_LT(k, 20000u);
  }
  made = false;
  for (size_t k = 0; !made; ++k) {
    CountingHost host;
    host.refuse_at = k;
    rdm_agent_config c = agent_config();
    c.host = &host.hooks;
    rdm_agent* a = nullptr;
    const rdm_result r = rdm_agent_create(&a, &c);
    made = r == RDM_OK;
    if (!made) {
      ASSERT_EQ(r, RDM_ERROR_MEMORY) << k << ' ' << rdm_last_error();
    }
    rdm_agent_destroy(a);
    ASSERT_EQ(host.live, 0u) << k;
    ASSERT_LT(k, 20000u);
  }
}

TEST(ContractHost, HooksComeInPairs) {
  CountingHost host;
  host.hooks.release = nullptr;
  rdm_pool_config c = pool_config();
  c.host = &host.hooks;
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_init(&host.hooks), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_init(nullptr), RDM_OK);
  rdm_shutdown();
}

TEST(ContractHost, TheHostsThreadsGiveTheSameBytes) {
  struct Reversed {
    static void run(void*, int32_t n, rdm_body body, void* context) {
      for (int32_t i = n - 1; i >= 0; --i) body(context, i);
    }
  };
  rdm_host host{sizeof(rdm_host), 0, nullptr, nullptr, nullptr, nullptr, Reversed::run};
  uint64_t hashes[5];
  int k = 0;
  for (int threads : {0, 1, 2, 4, -4}) {
    rdm_pool_config c = pool_config(6);
    c.num_threads = threads < 0 ? -threads : threads;
    if (threads < 0) c.host = &host;
    rdm_pool* p = make_pool(c);
    ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    for (int i = 0; i < 60; ++i) {
      ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(p), RDM_OK);
    }
    hashes[k++] = hash_of(p);
    rdm_pool_destroy(p);
  }
  for (int i = 1; i < 5; ++i) EXPECT_EQ(hashes[i], hashes[0]) << i;
}

TEST(ContractHost, TheFloatingPointModeIsPutBack) {
  rdm_pool* p = make_pool(pool_config());
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  const uint64_t before = hash_of(p);
  ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  const uint64_t nearest = hash_of(p);
  const int mode = std::fegetround();
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);  // by the host
  rdm_pool* q = make_pool(pool_config());
  EXPECT_EQ(rdm_pool_reset(q, nullptr, nullptr), RDM_OK);
  const uint64_t reset_up = hash_of(q);
  EXPECT_EQ(rdm_pool_step(q), RDM_OK);
  const uint64_t upward = hash_of(q);
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  std::fesetround(mode);
  EXPECT_EQ(reset_up, before);
  EXPECT_EQ(upward, nearest);
  rdm_pool_destroy(p);
  rdm_pool_destroy(q);
}

TEST(ContractHost, ErrorTextsBelongToThreads) {
  int32_t index;
  ASSERT_EQ(rdm_task_find("one", &index), RDM_ERROR_NOT_FOUND);
  const std::string mine = rdm_last_error();
  std::string other;
  std::thread([&] {
    rdm_algo_find("two", &index);
    other = rdm_last_error();
  }).join();
  EXPECT_EQ(mine, rdm_last_error());
  EXPECT_NE(mine, other);
  for (int r = -1000; r <= 1; ++r) EXPECT_NE(rdm_result_string(r), nullptr);
}

// What `body` gives in a forked child; a crash or hang there is not 0.
template <class F>
int in_child(F&& body) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    _exit(body() ? 0 : 1);
  }
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return status;
}

TEST(ContractHost, AForkedChildIsToldThatThreadsDoNotSurvive) {
  rdm_pool_config c = pool_config(4);
  c.num_threads = 2;
  rdm_pool* p = make_pool(c);
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  rdm_agent_config ac = agent_config();
  ac.num_threads = 2;
  rdm_agent* a = make_agent(ac);
  const auto told = [](rdm_result r, const char* text) {
    return r == RDM_ERROR_STATE && std::strcmp(text, rdm_last_error()) == 0 && std::strstr(text, "fork");
  };
  EXPECT_EQ(in_child([&] {
              const bool pool = told(rdm_pool_step(p), rdm_pool_error(p)) &&
                                told(rdm_pool_reset(p, nullptr, nullptr), rdm_pool_error(p));
              const bool agent = told(feed_epoch(a), rdm_agent_error(a));
              rdm_pool_destroy(p);
              rdm_agent_destroy(a);
              return pool && agent;
            }),
            0);
  EXPECT_EQ(rdm_pool_step(p), RDM_OK);
  EXPECT_EQ(feed_epoch(a), RDM_OK);
  rdm_pool_destroy(p);
  rdm_agent_destroy(a);
}

TEST(ContractHost, AForkedChildGoesOnWithHandlesThatHaveNoThreads) {
  for (const int32_t threads : {0, 1}) {
    rdm_pool_config c = pool_config(3);
    c.num_threads = threads;
    rdm_pool* p = make_pool(c);
    ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    rdm_agent_config ac = agent_config();
    ac.num_threads = threads;
    rdm_agent* a = make_agent(ac);
    ASSERT_EQ(rdm_pool_step(p), RDM_OK);
    const auto run = [&] {
      bool good = feed_epoch(a) == RDM_OK;
      for (int i = 0; i < 20; ++i)
        good = good && rdm_pool_baseline(p, RDM_BASELINE_RANDOM) == RDM_OK && rdm_pool_step(p) == RDM_OK;
      return good;
    };
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    EXPECT_EQ(in_child([&] {
                const bool good = run();
                const uint64_t hash = hash_of(p);
                const bool sent = write(ends[1], &hash, sizeof hash) == sizeof hash;
                rdm_pool_destroy(p);
                rdm_agent_destroy(a);
                return good && sent;
              }),
              0);
    EXPECT_TRUE(run());
    uint64_t childs = 0;
    ASSERT_EQ(read(ends[0], &childs, sizeof childs), static_cast<ssize_t>(sizeof childs));
    EXPECT_EQ(childs, hash_of(p));
    close(ends[0]);
    close(ends[1]);
    rdm_pool_destroy(p);
    rdm_agent_destroy(a);
  }
}

TEST(ContractHost, HeaderAndLibraryAreCompared) {
  EXPECT_EQ(rdm_check_abi(RDM_ABI, RDM_VERSION), RDM_OK);
  EXPECT_EQ(rdm_check_abi(RDM_ABI + 1, RDM_VERSION), RDM_ERROR_VERSION_MISMATCH);
  EXPECT_EQ(rdm_check_abi(RDM_ABI, RDM_VERSION + 1), RDM_ERROR_VERSION_MISMATCH);
  rdm_build b{};
  EXPECT_EQ(rdm_build_info(&b), RDM_ERROR_ARGUMENT);
  b.struct_size = sizeof b;
  ASSERT_EQ(rdm_build_info(&b), RDM_OK);
  EXPECT_STRNE(b.ode, "");
  EXPECT_STRNE(b.compiler, "");
}

}  // namespace

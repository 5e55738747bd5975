// Many threads at work at once, best built with the thread sanitizer (preset tsan): pools and agents of their
// own in each, one policy in eight, a cancel from a signal handler, rdm_init and rdm_shutdown beside threads
// that make handles; and fork after a handle was made.
//
//   hard_threads [--rounds N] [--only PART]     PART: fork, many, policy, cancel, init
#include <sys/time.h>

#include <atomic>
#include <csignal>
#include <thread>

#include "isolate.hpp"
#include "worlds.hpp"

using namespace hard;

namespace {

#if defined(__SANITIZE_THREAD__)
constexpr bool kThreadSanitizer = true;
#elif defined(__has_feature)
constexpr bool kThreadSanitizer = __has_feature(thread_sanitizer);
#else
constexpr bool kThreadSanitizer = false;
#endif

void must(rdm_result r) {
  HARD_REQUIRE(r == RDM_OK, "code %d: %s", r, rdm_last_error());
}

template <class F>
void in_threads(int count, F&& body) {
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i) threads.emplace_back([&body, i] { body(i); });
  for (auto& t : threads) t.join();
}

// Each thread has a world and an agent of its own, with workers too; the bytes do not depend on the company.
void many(int rounds) {
  const std::vector<World> worlds = all_worlds();
  const std::vector<std::string> algos = all_algos();
  for (int round = 0; round < rounds; ++round) {
    std::vector<uint64_t> hashes(8);
    in_threads(8, [&](int i) {
      const World& w = worlds[static_cast<size_t>(round + i / 2) % worlds.size()];
      PoolOf pool;
      must(pool.make(w, 3, nullptr, i % 2 ? 2 : 0));
      must(rdm_pool_reset(pool.handle, nullptr, nullptr));
      for (uint32_t k = 0; k < 3; ++k) {
        pool.fill_actions(k);
        must(rdm_pool_step(pool.handle));
      }
      must(rdm_pool_get_hash(pool.handle, -1, &hashes[static_cast<size_t>(i)]));
      AgentOf agent;
      must(agent.make(algos[static_cast<size_t>(round + i) % algos.size()], nullptr, i % 2 ? 2 : 0));
      must(agent.epoch());
      rdm_field_info field = RDM_INIT(rdm_field_info);
      must(rdm_task_field_at(w.index, 0, &field));
      rdm_pool* none = nullptr;
      HARD_REQUIRE(rdm_pool_create(&none, nullptr) == RDM_ERROR_ARGUMENT && *rdm_last_error(), "no refusal");
    });
    for (size_t i = 0; i < 8; i += 2)
      HARD_REQUIRE(hashes[i] == hashes[i + 1], "with workers another state comes out");
  }
}

void one_policy(int rounds) {
  AgentOf agent;
  must(agent.make("ppo_lag"));
  must(agent.epoch());
  const Bytes bytes = agent.policy();
  rdm_policy* p = nullptr;
  must(rdm_policy_read(&p, bytes.data(), bytes.size()));
  const int32_t rows = 5;
  std::vector<float> obs(rows * AgentOf::kObs), expected(rows * AgentOf::kActions);
  for (size_t i = 0; i < obs.size(); ++i) obs[i] = static_cast<float>(i % 5) * 0.3f;
  const auto act = [&](float* action) {
    const size_t n = rdm_policy_scratch(p, rows);
    std::vector<unsigned char> scratch(n);
    must(rdm_policy_act(p, obs.data(), rows, nullptr, action, scratch.data(), n));
  };
  act(expected.data());
  in_threads(8, [&](int) {
    for (int k = 0; k < 50 * rounds; ++k) {
      std::vector<float> action(expected.size());
      act(action.data());
      HARD_REQUIRE(action == expected, "another thread's policy acts otherwise");
      rdm_policy_info info{};
      info.struct_size = sizeof info;
      must(rdm_policy_get_info(p, &info));
    }
  });
  rdm_policy_destroy(p);
}

rdm_agent* g_agent = nullptr;

void cancel(int rounds) {
  PoolOf pool;
  must(pool.make({"two_state", "", 0, 0}, 8));
  must(rdm_pool_reset(pool.handle, nullptr, nullptr));
  rdm_agent_config c;
  must(rdm_agent_config_init(&c, sizeof c));
  must(rdm_agent_config_for_pool(&c, pool.handle));
  const rdm_option options[] = {{"hidden", "16,16", 0}, {"horizon", nullptr, 64}};
  c.options = options;
  c.num_options = 2;
  must(rdm_agent_create(&g_agent, &c));
  std::signal(SIGALRM, [](int) { rdm_agent_cancel(g_agent); });
  const itimerval timer{{0, 3000}, {0, 1000}};
  setitimer(ITIMER_REAL, &timer, nullptr);
  int cancelled = 0;
  for (int k = 0; k < 1000 * rounds && cancelled < 20 * rounds; ++k) {
    const rdm_result r = rdm_agent_rollout(g_agent, pool.handle, nullptr);
    if (r != RDM_ERROR_CANCELLED) must(r);
    cancelled += r == RDM_ERROR_CANCELLED;
  }
  const itimerval never{};
  setitimer(ITIMER_REAL, &never, nullptr);
  HARD_REQUIRE(cancelled > 0, "nothing was cancelled");
  // a cancel that came after the last call is for the next one
  const rdm_result last = rdm_agent_rollout(g_agent, pool.handle, nullptr);
  if (last != RDM_ERROR_CANCELLED) must(last);
  must(rdm_agent_rollout(g_agent, pool.handle, nullptr));
  // and from another thread
  std::atomic<bool> end{false};
  std::thread other([&] {
    while (!end) rdm_agent_cancel(g_agent);
  });
  for (int k = 0; k < 20; ++k) {
    const rdm_result r = rdm_agent_rollout(g_agent, pool.handle, nullptr);
    if (r != RDM_ERROR_CANCELLED) must(r);
  }
  end = true;
  other.join();
  rdm_agent_destroy(g_agent);
}

std::atomic<long> g_live{0};
void* take(void*, size_t bytes, size_t align) {
  ++g_live;
  return std::aligned_alloc(align < 16 ? 16 : align, (bytes + 63) / 64 * 64);
}
void give(void*, void* p, size_t, size_t) {
  --g_live;
  std::free(p);
}

void init_and_shutdown(int rounds) {
  std::atomic<bool> end{false};
  std::vector<std::thread> owners;
  for (int i = 0; i < 3; ++i)
    owners.emplace_back([&] {
      const rdm_host host{sizeof(rdm_host), 0, nullptr, take, give, nullptr, nullptr};
      while (!end) {
        const rdm_result r = rdm_init(&host);
        if (r == RDM_OK) rdm_shutdown();
      }
    });
  in_threads(3, [&](int) {
    for (int k = 0; k < 2000 * rounds; ++k) {
      PoolOf pool;
      must(pool.make({"lqr_line", "", 0, 0}, 1));
      AgentOf agent;
      must(agent.make("ppo"));
    }
  });
  end = true;
  for (auto& t : owners) t.join();
  HARD_REQUIRE(g_live == 0, "%ld blocks of the hooks are left", g_live.load());
}

// In the child a handle without workers goes on with the same bytes; one with workers says why it cannot.
void after_fork(int) {
  for (const World& w : all_worlds()) {
    if (w.task != "grasp" && w.task != "point_goal1") continue;
    PoolOf alone, shared;
    must(alone.make(w, 2));
    must(shared.make(w, 2, nullptr, 2));
    AgentOf agent;
    must(agent.make("ppo_lag", nullptr, 2));
    for (PoolOf* p : {&alone, &shared}) {
      must(rdm_pool_reset(p->handle, nullptr, nullptr));
      p->fill_actions(1);
      must(rdm_pool_step(p->handle));
    }
    uint64_t expected = 0;
    const pid_t child = fork();
    if (child == 0) {
      alarm(60);
      must(rdm_pool_step(alone.handle));
      must(rdm_pool_get_hash(alone.handle, -1, &expected));
      const rdm_result r = rdm_pool_step(shared.handle);
      HARD_REQUIRE(r == RDM_ERROR_STATE && std::strstr(rdm_last_error(), "fork"), "code %d: %s", r,
                   rdm_last_error());
      const rdm_result e = agent.epoch();
      HARD_REQUIRE(e == RDM_OK || (e == RDM_ERROR_STATE && std::strstr(rdm_last_error(), "fork")),
                   "code %d: %s", e, rdm_last_error());
      shared.reset();
      agent.reset();
      PoolOf fresh;
      must(fresh.make(w, 2, nullptr, 2));
      must(rdm_pool_reset(fresh.handle, nullptr, nullptr));
      must(rdm_pool_step(fresh.handle));
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    HARD_REQUIRE(WIFEXITED(status) && WEXITSTATUS(status) == 0, "%s: the child ended with %d",
                 w.name().c_str(), status);
    for (PoolOf* p : {&alone, &shared}) must(rdm_pool_step(p->handle));
    must(agent.epoch());
    uint64_t a = 0, b = 0;
    must(rdm_pool_get_hash(alone.handle, -1, &a));
    must(rdm_pool_get_hash(shared.handle, -1, &b));
    HARD_REQUIRE(a == b, "workers change the bytes");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = std::max(1, std::atoi(argument(argc, argv, "--rounds", "1").c_str()));
  const std::string only = argument(argc, argv, "--only", "");
  struct Part {
    const char* name;
    void (*run)(int);
  };
  long passed = 0, failed = 0;
  for (const Part& part : {Part{"fork", after_fork}, Part{"many", many}, Part{"policy", one_policy},
                           Part{"cancel", cancel}, Part{"init", init_and_shutdown}}) {
    if (!only.empty() && only != part.name) continue;
    // the thread sanitizer does not follow a fork of many threads
    if (kThreadSanitizer && std::strcmp(part.name, "fork") == 0) continue;
    const double begin = now();
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      alarm(600);
      part.run(rounds);
      std::exit(0);  // not _exit: sanitizers report at the end
    }
    int status = 0;
    waitpid(child, &status, 0);
    const bool good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    std::printf("threads: %-8s %s, %.1f s\n", part.name, good ? "good" : "FAILED", now() - begin);
    std::fflush(stdout);
    (good ? passed : failed) += 1;
  }
  std::printf("%ld passed, %ld failed\n", passed, failed);
  return failed != 0;
}

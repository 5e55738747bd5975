// What the tests of the C ABI share: a counting, refusing allocator, small pools and agents, and the check
// that nothing was printed.
#pragma once
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <gtest/gtest.h>
#include <redman/redman.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "has_option.hpp"
#include "written.hpp"

// Hooks that count live bytes and calls, and refuse from the call number `refuse_at` on.
struct CountingHost {
  size_t live = 0, calls = 0, peak = 0;
  size_t refuse_at = SIZE_MAX;
  rdm_host hooks{sizeof(rdm_host), 0, this, alloc, release, nullptr, nullptr};

  static void* alloc(void* user, size_t bytes, size_t align) {
    auto* h = static_cast<CountingHost*>(user);
    if (h->calls++ >= h->refuse_at) return nullptr;
    void* p = nullptr;
    if (posix_memalign(&p, align, bytes) != 0) return nullptr;
    h->live += bytes;
    h->peak = std::max(h->peak, h->live);
    return p;
  }
  static void release(void* user, void* p, size_t bytes, size_t) {
    static_cast<CountingHost*>(user)->live -= bytes;
    std::free(p);
  }
};

// Everything that the process prints while it lives, read back at the end.
class Silence {
 public:
  Silence() {
    std::fflush(nullptr);
    file_ = std::tmpfile();
    for (int fd : {1, 2}) {
      saved_[fd - 1] = dup(fd);
      dup2(fileno(file_), fd);
    }
  }
  ~Silence() { restore(); }
  std::string restore() {
    if (!file_) return text_;
    std::fflush(nullptr);
    for (int fd : {1, 2}) {
      dup2(saved_[fd - 1], fd);
      close(saved_[fd - 1]);
    }
    std::rewind(file_);
    char buffer[4096];
    text_.assign(buffer, std::fread(buffer, 1, sizeof buffer, file_));
    std::fclose(file_);
    file_ = nullptr;
    return text_;
  }

 private:
  FILE* file_ = nullptr;
  int saved_[2] = {};
  std::string text_;
};

inline rdm_pool_config pool_config(int32_t envs = 2) {
  rdm_pool_config c;
  EXPECT_EQ(rdm_pool_config_init(&c, sizeof c), RDM_OK);
  c.task = "hand_over_safe_finger";
  c.num_envs = envs;
  return c;
}

// Names of all tasks, for tests of what each of them promises.
inline std::vector<std::string> task_names() {
  std::vector<std::string> out;
  rdm_task t{};
  t.struct_size = sizeof t;
  for (int32_t i = 0; i < rdm_task_count(); ++i)
    if (rdm_task_at(i, &t) == RDM_OK) out.push_back(t.name);
  return out;
}

inline rdm_pool* make_pool(const rdm_pool_config& c) {
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  return p;
}

inline rdm_buffers buffers_of(const rdm_pool* p) {
  rdm_buffers b{};
  b.struct_size = sizeof b;
  EXPECT_EQ(rdm_pool_get_buffers(p, &b), RDM_OK);
  return b;
}

inline rdm_spec spec_of(const rdm_pool* p) {
  rdm_spec s{};
  s.struct_size = sizeof s;
  EXPECT_EQ(rdm_pool_get_spec(p, &s), RDM_OK);
  return s;
}

inline uint64_t hash_of(const rdm_pool* p, int32_t env = -1) {
  uint64_t h = 0;
  EXPECT_EQ(rdm_pool_get_hash(p, env, &h), RDM_OK);
  return h;
}

// A small agent of a host's own environment: 3 observations, 2 actions, 1 cost, 4 rows, 8 decisions.
inline constexpr rdm_option kSmallAgentOptions[] = {
    {"hidden", "8,8", 0}, {"horizon", nullptr, 8}, {"passes", nullptr, 2}, {"minibatches", nullptr, 2}};

// Those of a learner from a replay memory, which learns in each of its epochs.
inline constexpr rdm_option kSmallReplayOptions[] = {{"hidden", "8,8", 0},
                                                     {"horizon", nullptr, 8},
                                                     {"replay_rows", nullptr, 64},
                                                     {"batch_rows", nullptr, 8},
                                                     {"start_steps", nullptr, 4}};

inline rdm_agent_config agent_config() {
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  c.obs_dim = 3;
  c.action_dim = 2;
  c.num_envs = 4;
  c.options = kSmallAgentOptions;
  c.num_options = 4;
  return c;
}

// The same of the algorithm with this place in the list.
inline rdm_agent_config agent_config(int32_t algo) {
  rdm_agent_config c = agent_config();
  rdm_algo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(rdm_algo_at(algo, &info), RDM_OK);
  c.algo = info.name;
  if (has_option(algo, "replay_rows")) {
    c.options = kSmallReplayOptions;
    c.num_options = 5;
  }
  return c;
}

inline rdm_agent* make_agent(const rdm_agent_config& c) {
  rdm_agent* a = nullptr;
  EXPECT_EQ(rdm_agent_create(&a, &c), RDM_OK) << rdm_last_error();
  return a;
}

// One epoch of made-up data, different in every decision; returns the last result.
inline rdm_result feed_epoch(rdm_agent* a, int horizon = 8) {
  float obs[12], action[8], reward[4], cost[4];
  uint8_t ended[4] = {};
  for (int h = 0; h < horizon; ++h) {
    for (int i = 0; i < 12; ++i) obs[i] = static_cast<float>((7 * i + 3 * h) % 11) * 0.1f;
    if (const rdm_result r = rdm_agent_act(a, obs, RDM_ACT_SAMPLE, action)) return r;
    for (int i = 0; i < 4; ++i) {
      reward[i] = -action[2 * i] * action[2 * i];
      cost[i] = action[2 * i + 1] > 0;
      ended[i] = h % 4 == 3;
    }
    rdm_transition t{};
    t.struct_size = sizeof t;
    t.reward = reward;
    t.cost = cost;
    t.terminated = ended;
    if (const rdm_result r = rdm_agent_record(a, &t)) return r;
  }
  return rdm_agent_update(a, obs, nullptr);
}

inline std::vector<unsigned char> policy_bytes(const rdm_agent* a) {
  return written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_agent_write_policy(a, out, n, size); });
}

inline std::vector<unsigned char> saved(const rdm_agent* a) {
  return written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_agent_write_state(a, out, n, size); });
}

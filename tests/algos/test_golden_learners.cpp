// One number per algorithm for the whole state of an agent that has learned for three epochs, and one for
// what a trained policy does in a world: the same on every machine and compiler, with the base kernels. With
// RDM_WRITE_GOLDEN set, tests/golden/learners.txt is written instead of compared.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/cpu.hpp"
#include "base/hash.hpp"
#include "has_option.hpp"
#include "nn/kernels.hpp"
#include "written.hpp"

namespace {

rdm_pool* make_pool(const char* task, int32_t envs) {
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = task;
  c.num_envs = envs;
  c.seed = 7;
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  return p;
}

uint64_t state_after_three_epochs(const char* algo, const char* task) {
  rdm_pool* p = make_pool(task, 16);
  rdm_agent_config c;
  rdm_agent_config_init(&c, sizeof c);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, p), RDM_OK);
  c.algo = algo;
  c.seed = 11;
  c.settings = has_option(algo, "replay_rows") ? "hidden=32,16\nhorizon=24\nreplay_rows=900\nbatch_rows="
                                                 "300\nstart_steps=100\nupdates_per_step=0.03"
                                               : "hidden=32,16\nhorizon=24\npasses=2\nminibatches=2";
  rdm_agent* a = nullptr;
  EXPECT_EQ(rdm_agent_create(&a, &c), RDM_OK) << rdm_last_error();
  for (int epoch = 0; epoch < 3; ++epoch)
    EXPECT_EQ(rdm_agent_rollout(a, p, nullptr), RDM_OK) << rdm_last_error();
  const auto bytes = written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_agent_write_state(a, out, n, size); });
  rdm_agent_destroy(a);
  rdm_pool_destroy(p);
  return rdm::hash_bytes(bytes.data(), bytes.size());
}

// Two episodes' worth of actions and rewards.
uint64_t acts(const char* task) {
  rdm_policy* policy = nullptr;
  const std::string path = std::string(RDM_TEST_DATA "/../examples/policies/") + task + ".rdm";
  EXPECT_EQ(rdm_policy_read_file(&policy, path.c_str()), RDM_OK) << rdm_last_error();
  rdm_pool* p = make_pool(task, 4);
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  rdm_buffers b{};
  b.struct_size = sizeof b;
  EXPECT_EQ(rdm_pool_get_spec(p, &spec), RDM_OK);
  EXPECT_EQ(rdm_pool_get_buffers(p, &b), RDM_OK);
  std::vector<unsigned char> scratch(rdm_policy_scratch(policy, 4));
  uint64_t h = rdm::kHashSeed;
  for (int step = 0; step < 150; ++step) {
    EXPECT_EQ(rdm_policy_act(policy, b.obs, 4, nullptr, b.action, scratch.data(), scratch.size()), RDM_OK)
        << rdm_last_error();
    h = rdm::hash_bytes(b.action, sizeof(float) * 4 * static_cast<size_t>(spec.action_dim), h);
    EXPECT_EQ(rdm_pool_step(p), RDM_OK);
    h = rdm::hash_bytes(b.reward, sizeof(float) * 4, h);
  }
  rdm_pool_destroy(p);
  rdm_policy_destroy(policy);
  return h;
}

TEST(GoldenLearners, EveryAlgorithmAndATrainedPolicyGiveTheRecordedBytes) {
  const std::string best = rdm::kernel_isa();
  ASSERT_TRUE(rdm::set_kernel_isa(rdm::kBaseIsa));
  std::string now = "# algorithm or policy, task, hash\n";
  const auto add = [&](const char* what, const char* task, uint64_t hash) {
    char text[20];
    std::snprintf(text, sizeof text, "%016" PRIx64, hash);
    now += std::string(what) + " " + task + " " + text + "\n";
  };
  for (int32_t i = 0; i < rdm_algo_count(); ++i) {
    rdm_algo algo{};
    algo.struct_size = sizeof algo;
    ASSERT_EQ(rdm_algo_at(i, &algo), RDM_OK);
    add(algo.name, "point_goal1", state_after_three_epochs(algo.name, "point_goal1"));
  }
  add("ppo_lag", "hand_over_safe_finger", state_after_three_epochs("ppo_lag", "hand_over_safe_finger"));
  for (const char* task : {"hand_over_safe_finger", "jenga"}) add("policy", task, acts(task));
  EXPECT_TRUE(rdm::set_kernel_isa(best.c_str()));
  const char* path = RDM_TEST_DATA "/golden/learners.txt";
  if (std::getenv("RDM_WRITE_GOLDEN")) {
    ASSERT_TRUE(std::ofstream(path) << now) << path;
    GTEST_SKIP() << path << " was written";
  }
  std::ostringstream recorded;
  recorded << std::ifstream(path).rdbuf();
  EXPECT_EQ(now, recorded.str()) << "if the change is meant, run this test once with RDM_WRITE_GOLDEN=1";
}

}  // namespace

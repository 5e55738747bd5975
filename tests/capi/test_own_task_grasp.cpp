// One of the library's own tasks, written with the public header alone, has the same bytes: rows, rewards,
// costs, hashes.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include "own_grasp.hpp"

namespace rdm::test {
namespace {

struct World {
  rdm_pool* pool = nullptr;
  rdm_buffers b{};
  rdm_spec spec{};
  World(const char* task, int32_t envs, int32_t threads, const std::string& settings = "") {
    rdm_pool_config c;
    rdm_pool_config_init(&c, sizeof c);
    c.task = task;
    c.num_envs = envs;
    c.num_threads = threads;
    c.settings = settings.c_str();
    c.seed = 7;
    EXPECT_EQ(rdm_pool_create(&pool, &c), RDM_OK) << rdm_last_error();
    b.struct_size = sizeof b;
    spec.struct_size = sizeof spec;
    EXPECT_EQ(rdm_pool_get_buffers(pool, &b), RDM_OK);
    EXPECT_EQ(rdm_pool_get_spec(pool, &spec), RDM_OK);
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK) << rdm_last_error();
  }
  ~World() { rdm_pool_destroy(pool); }
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  void step() {
    ASSERT_EQ(rdm_pool_baseline(pool, RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_pool_step(pool), RDM_OK) << rdm_last_error();
  }
  uint64_t hash() const {
    uint64_t h = 0;
    EXPECT_EQ(rdm_pool_get_hash(pool, -1, &h), RDM_OK);
    return h;
  }
};

// A scene of a host's own has room for the contacts of its shapes and sees contacts coming; the library's task says how
// many it takes, and waits for them.
std::string same_room_as(const char* task) {
  int32_t index = 0;
  rdm_option_spec o = RDM_INIT(rdm_option_spec);
  EXPECT_EQ(rdm_task_find(task, &index), RDM_OK);
  for (int32_t i = 0; rdm_task_option_at(index, i, &o) == RDM_OK; ++i)
    if (std::string(o.key) == "contacts_max")
      return "speculative_contacts=false\ncontacts_max=" + std::to_string(static_cast<int>(o.number));
  ADD_FAILURE() << task << " has no option contacts_max";
  return "";
}

TEST(OwnGrasp, HasTheBytesOfTheLibrarysOwn) {
  GraspTask t;
  const Registered made(t.def);
  for (const int32_t envs : {1, 8}) {
    World ours("grasp", envs, 0), own("own_grasp", envs, envs > 1 ? 2 : 0, same_room_as("grasp"));
    ASSERT_EQ(own.spec.obs_dim, ours.spec.obs_dim);
    ASSERT_EQ(own.spec.action_dim, ours.spec.action_dim);
    const auto n = static_cast<size_t>(envs);
    const auto obs = n * static_cast<size_t>(ours.spec.obs_dim), costs = 3 * n;
    ASSERT_EQ(std::memcmp(own.b.obs, ours.b.obs, obs * sizeof(float)), 0);
    ASSERT_EQ(own.hash(), ours.hash());
    double effort = 0;
    for (int step = 1; step <= 1000; ++step) {
      ours.step();
      own.step();
      ASSERT_EQ(std::memcmp(own.b.obs, ours.b.obs, obs * sizeof(float)), 0) << step;
      ASSERT_EQ(std::memcmp(own.b.final_obs, ours.b.final_obs, obs * sizeof(float)), 0) << step;
      ASSERT_EQ(std::memcmp(own.b.reward, ours.b.reward, n * sizeof(float)), 0) << step;
      ASSERT_EQ(std::memcmp(own.b.cost, ours.b.cost, costs * sizeof(float)), 0) << step;
      ASSERT_EQ(std::memcmp(own.b.cost_raw, ours.b.cost_raw, costs * sizeof(float)), 0) << step;
      ASSERT_EQ(own.hash(), ours.hash()) << step;
      effort += static_cast<double>(own.b.cost[0]);
    }
    EXPECT_GT(effort, 0);
    std::printf("%d worlds, 1000 steps: hash %016llx of both\n", envs,
                static_cast<unsigned long long>(own.hash()));
  }
}

TEST(OwnGrasp, KeepsItsPromises) {
  GraspTask t;
  const Registered made(t.def);
  EXPECT_EQ(rdm_task_check("own_grasp", nullptr, nullptr, nullptr, nullptr, 0), RDM_OK) << rdm_last_error();
}

}  // namespace
}  // namespace rdm::test

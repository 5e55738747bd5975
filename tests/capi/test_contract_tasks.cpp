// What every registered task promises through the C ABI, whoever wrote it.
#include <cmath>
#include <limits>
#include <set>

#include "contract.hpp"
#include "heap_count.hpp"
#include "written.hpp"

namespace {

constexpr int kSteps = 60;

class ContractTasks : public testing::TestWithParam<std::string> {
 protected:
  rdm_pool_config config(int32_t envs = 3) const {
    rdm_pool_config c = pool_config(envs);
    c.task = GetParam().c_str();
    c.seed = 11;
    return c;
  }
  static void play(rdm_pool* p, int steps) {
    for (int i = 0; i < steps; ++i) {
      ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(p), RDM_OK) << rdm_pool_error(p);
    }
  }
  static rdm_pool* started(const rdm_pool_config& c) {
    rdm_pool* p = make_pool(c);
    EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    return p;
  }
};

TEST_P(ContractTasks, AResetLeavesNoRewardAndNoCost) {
  rdm_pool* p = started(config());
  const rdm_spec s = spec_of(p);
  play(p, kSteps);
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  const rdm_buffers b = buffers_of(p);
  for (int i = 0; i < 3 * s.cost_dim; ++i) {
    EXPECT_EQ(b.cost[i], 0);
    EXPECT_EQ(b.cost_raw[i], 0);
    EXPECT_EQ(b.episode_cost[i], 0);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(b.reward[i], 0);
    EXPECT_EQ(b.episode_return[i], 0);
    EXPECT_EQ(b.terminated[i] + b.truncated[i] + b.success[i], 0);
  }
  rdm_pool_destroy(p);
}

TEST_P(ContractTasks, ValuesAreFiniteAndEpisodesEnd) {
  rdm_pool* p = started(config());
  const rdm_spec s = spec_of(p);
  const rdm_buffers b = buffers_of(p);
  bool ended = false;
  for (int step = 0; step < s.max_steps + 1 && step < 3000; ++step) {
    play(p, 1);
    for (int i = 0; i < 3 * s.obs_dim; ++i) ASSERT_TRUE(std::isfinite(b.obs[i])) << i;
    for (int i = 0; i < 3 * s.cost_dim; ++i) ASSERT_TRUE(std::isfinite(b.cost[i])) << i;
    ASSERT_TRUE(std::isfinite(b.reward[0]));
    ASSERT_EQ(b.status[0] & RDM_STATUS_DIVERGED, 0u);
    ended |= b.terminated[0] || b.truncated[0];
  }
  EXPECT_TRUE(ended);
  rdm_pool_destroy(p);
}

TEST_P(ContractTasks, TheOrderOfTheActionNamesEveryEntryOrGroupsOfJoints) {
  int32_t index = -1;
  ASSERT_EQ(rdm_task_find(GetParam().c_str(), &index), RDM_OK);
  rdm_task t = RDM_INIT(rdm_task);
  ASSERT_EQ(rdm_task_at(index, &t), RDM_OK);
  const std::string order = t.action_order;
  int32_t words = 1;
  for (size_t at = order.find(", "); at != std::string::npos; at = order.find(", ", at + 1)) ++words;
  EXPECT_FALSE(order.empty());
  EXPECT_TRUE(words == t.action_dim || order.find("joints") != std::string::npos) << order;
}

TEST_P(ContractTasks, ABadActionEndsItsEpisodeAlone) {
  rdm_pool *p = started(config()), *clean = started(config());
  const rdm_spec s = spec_of(p);
  const rdm_buffers b = buffers_of(p);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), HUGE_VALF, -HUGE_VALF}) {
    b.action[s.action_dim] = bad;  // world 1
    ASSERT_EQ(rdm_pool_step(p), RDM_OK);
    ASSERT_EQ(rdm_pool_step(clean), RDM_OK);
    EXPECT_NE(b.status[1] & RDM_STATUS_BAD_ACTION, 0u);
    EXPECT_EQ(b.truncated[1], 1);
    EXPECT_EQ(b.reward[1], 0);
    for (int i = 0; i < 3 * s.obs_dim; ++i) ASSERT_TRUE(std::isfinite(b.obs[i]));
    b.action[s.action_dim] = 0;
    EXPECT_EQ(hash_of(p, 0), hash_of(clean, 0));
    EXPECT_EQ(hash_of(p, 2), hash_of(clean, 2));
  }
  ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  EXPECT_EQ(b.status[1], 0u);
  rdm_pool_destroy(p);
  rdm_pool_destroy(clean);
}

TEST_P(ContractTasks, ASavedStateGoesOnWithTheSameBytes) {
  rdm_pool *p = started(config()), *other = started(config());
  play(p, kSteps);
  const auto state = written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_pool_write_state(p, -1, out, n, size); });
  play(other, 7);
  ASSERT_EQ(rdm_pool_read_state(other, -1, state.data(), state.size()), RDM_OK) << rdm_pool_error(other);
  const rdm_spec s = spec_of(p);
  const rdm_buffers a = buffers_of(p), b = buffers_of(other);
  EXPECT_EQ(std::memcmp(a.obs, b.obs, sizeof(float) * 3 * static_cast<size_t>(s.obs_dim)), 0);
  for (int i = 0; i < kSteps; ++i) {
    play(p, 1);
    play(other, 1);
    ASSERT_EQ(hash_of(p), hash_of(other)) << i;
    ASSERT_EQ(std::memcmp(a.reward, b.reward, 3 * sizeof(float)), 0) << i;
    ASSERT_EQ(std::memcmp(a.cost, b.cost, sizeof(float) * 3 * static_cast<size_t>(s.cost_dim)), 0) << i;
  }
  rdm_pool_destroy(p);
  rdm_pool_destroy(other);
}

TEST_P(ContractTasks, AnyNumberOfThreadsGivesTheSameBytes) {
  std::set<uint64_t> hashes;
  for (const int32_t threads : {0, 1, 2, 4}) {
    rdm_pool_config c = config(5);
    c.num_threads = threads;
    rdm_pool* p = started(c);
    play(p, kSteps);
    hashes.insert(hash_of(p));
    rdm_pool_destroy(p);
  }
  EXPECT_EQ(hashes.size(), 1u);
}

TEST_P(ContractTasks, SeedsAndWorldsDiffer) {
  rdm_pool_config c = config();
  rdm_pool* p = started(c);
  c.seed = 12;
  rdm_pool* other = started(c);
  play(p, 3);
  play(other, 3);
  EXPECT_NE(hash_of(p, 0), hash_of(p, 1));
  EXPECT_NE(hash_of(p, 0), hash_of(other, 0));
  rdm_pool_destroy(p);
  rdm_pool_destroy(other);
}

TEST_P(ContractTasks, MemoryIsExactAndStepsAndStatesTakeNone) {
  CountingHost host;
  rdm_pool_config c = config();
  c.host = &host.hooks;
  size_t ours = 0, engines = 0;
  ASSERT_EQ(rdm_pool_config_memory(&c, &ours, &engines), RDM_OK) << rdm_last_error();
  EXPECT_EQ(host.live, 0u);
  rdm_pool* p = started(c);
  EXPECT_EQ(host.live, ours);
  play(p, 2);
  size_t size = 0;
  ASSERT_EQ(rdm_pool_write_state(p, -1, nullptr, 0, &size), RDM_OK);
  std::vector<unsigned char> state(size);
  const int64_t before = heap_count();
  const size_t calls = host.calls;
  for (int i = 0; i < 300; ++i) {
    rdm_pool_baseline(p, RDM_BASELINE_RANDOM);
    rdm_pool_step(p);
  }
  ASSERT_EQ(rdm_pool_write_state(p, -1, state.data(), size, &size), RDM_OK);
  const uint64_t hash = hash_of(p);
  rdm_pool_step(p);
  ASSERT_EQ(rdm_pool_read_state(p, -1, state.data(), size), RDM_OK) << rdm_pool_error(p);
  EXPECT_EQ(hash_of(p), hash);
  EXPECT_EQ(host.calls, calls);
  EXPECT_EQ(heap_count(), before);  // always 0 where the heap is not counted
  rdm_pool_destroy(p);
  EXPECT_EQ(host.live, 0u);
}

// The first body is seen from every camera but those for point clouds, and pictures change nothing.
TEST_P(ContractTasks, EveryCameraShowsSomethingThatMoves) {
  rdm_pool* p = started(config(1));
  int32_t index = -1;
  ASSERT_EQ(rdm_task_find(GetParam().c_str(), &index), RDM_OK);
  rdm_task task{};
  task.struct_size = sizeof task;
  ASSERT_EQ(rdm_task_at(index, &task), RDM_OK);
  constexpr int32_t kWidth = 96, kHeight = 72;
  std::vector<int32_t> seen(kWidth * kHeight);
  const uint64_t before = hash_of(p);
  for (int32_t i = 0; i < task.num_cameras; ++i) {
    rdm_camera_info camera = RDM_INIT(rdm_camera_info);
    ASSERT_EQ(rdm_task_camera_at(index, i, &camera), RDM_OK);
    ASSERT_EQ(rdm_pool_render(p, 0, camera.name, kWidth, kHeight, nullptr, nullptr, seen.data()), RDM_OK);
    int moving = 0;
    for (const int32_t shape : seen) {
      rdm_shape_info s = RDM_INIT(rdm_shape_info);
      if (shape >= 0 && rdm_pool_shape_at(p, shape, &s) == RDM_OK) moving += !s.fixed;
    }
    EXPECT_GT(moving, 0) << camera.name;
  }
  EXPECT_EQ(hash_of(p), before);
  rdm_pool_destroy(p);
}

INSTANTIATE_TEST_SUITE_P(Every, ContractTasks, testing::ValuesIn(task_names()),
                         [](const auto& info) { return info.param; });

}  // namespace

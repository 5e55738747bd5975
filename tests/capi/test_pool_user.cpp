// What a host's own functions are told of the pool that they serve: its pointer, and which world.
#include <atomic>
#include <mutex>
#include <set>

#include "called_task.hpp"
#include "contract.hpp"

namespace rdm::test {
namespace {

// What the functions were told.
struct Told {
  std::mutex mutex;
  std::set<std::pair<const void*, int32_t>> worlds;
  std::vector<const void*> scenes;

  CalledTask task;
  explicit Told(const char* name) : task(name) {
    task.build = [this](rdm_scene* s) { return scenes.push_back(rdm_scene_user(s)), RDM_OK; };
    task.reset = [this](rdm_world* w, rdm_random*) { return add(w); };
    task.control = [this](rdm_world* w, int64_t*) { return add(w); };
    task.judge = [this](const rdm_world* w, int64_t, rdm_verdict*) { return add(w); };
    task.observe = [this](const rdm_world* w) { return add(w); };
  }
  rdm_result add(const rdm_world* w) {
    const std::lock_guard lock(mutex);
    worlds.insert({rdm_world_user(w), rdm_world_number(w)});
    return RDM_OK;
  }
};

using Worlds = std::set<std::pair<const void*, int32_t>>;

rdm_pool* pool_of(const char* task, void* user, int32_t envs, int32_t threads = 0) {
  rdm_pool_config c = pool_config(envs);
  c.task = task;
  c.num_threads = threads;
  c.user = user;
  return make_pool(c);
}

TEST(PoolUser, AndNumberReachEveryFunction) {
  Told told("user_told");
  int first = 0, second = 0;
  rdm_pool* p = pool_of("user_told", &first, 5, 2);
  EXPECT_TRUE(told.worlds.empty());
  for (const void* user : told.scenes) EXPECT_EQ(user, &first);
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  const Worlds all = {{&first, 0}, {&first, 1}, {&first, 2}, {&first, 3}, {&first, 4}};
  EXPECT_EQ(told.worlds, all);
  told.worlds.clear();
  ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  EXPECT_EQ(told.worlds, all);

  // one world alone
  told.worlds.clear();
  const uint8_t mask[] = {0, 0, 0, 1, 0};
  ASSERT_EQ(rdm_pool_step_masked(p, mask), RDM_OK);
  EXPECT_EQ(told.worlds, (Worlds{{&first, 3}}));

  // another pool has its own, whatever it takes of the first
  rdm_pool* other = pool_of("user_told", &second, 2);
  ASSERT_EQ(rdm_pool_reset(other, nullptr, nullptr), RDM_OK);
  size_t size = 0;
  std::vector<unsigned char> state(10000);
  ASSERT_EQ(rdm_pool_write_state(p, 4, state.data(), state.size(), &size), RDM_OK);
  ASSERT_EQ(rdm_pool_read_state(other, 0, state.data(), size), RDM_OK) << rdm_pool_error(other);
  ASSERT_EQ(rdm_pool_copy(other, 1, p, 3), RDM_OK) << rdm_pool_error(other);
  told.worlds.clear();
  ASSERT_EQ(rdm_pool_step(other), RDM_OK);
  EXPECT_EQ(told.worlds, (Worlds{{&second, 0}, {&second, 1}}));

  // without one, and where nobody has made a pool
  told.worlds.clear();
  told.scenes.clear();
  rdm_pool* plain = pool_of("user_told", nullptr, 1);
  ASSERT_EQ(rdm_pool_reset(plain, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(told.worlds, (Worlds{{nullptr, 0}}));
  rdm_task task{};
  task.struct_size = sizeof task;
  ASSERT_EQ(rdm_task_at(told.task.number, &task), RDM_OK);
  for (const void* user : told.scenes) EXPECT_EQ(user, nullptr);
  told.worlds.clear();
  EXPECT_EQ(rdm_task_check("user_told", nullptr, nullptr, nullptr, nullptr, 0), RDM_OK) << rdm_last_error();
  EXPECT_TRUE(told.worlds.count({nullptr, -1}));
  for (rdm_pool* each : {p, other, plain}) rdm_pool_destroy(each);
}

// A config that is asked about shows it to build, too, and an old one has none.
TEST(PoolUser, IsTheConfigs) {
  Told told("user_config");
  int own = 0;
  rdm_pool_config c = pool_config(1);
  c.task = "user_config";
  c.user = &own;
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  ASSERT_EQ(rdm_pool_config_spec(&c, &spec), RDM_OK);
  ASSERT_FALSE(told.scenes.empty());
  EXPECT_EQ(told.scenes.back(), &own);
  size_t ours = 0;
  ASSERT_EQ(rdm_pool_config_memory(&c, &ours, nullptr), RDM_OK);
  EXPECT_EQ(told.scenes.back(), &own);
  c.struct_size = offsetof(rdm_pool_config, user);
  ASSERT_EQ(rdm_pool_config_spec(&c, &spec), RDM_OK);
  EXPECT_EQ(told.scenes.back(), nullptr);
  EXPECT_TRUE(told.worlds.empty());
  EXPECT_EQ(rdm_world_number(nullptr), -1);
  EXPECT_EQ(rdm_world_user(nullptr), nullptr);
  EXPECT_EQ(rdm_scene_user(nullptr), nullptr);
}

}  // namespace
}  // namespace rdm::test

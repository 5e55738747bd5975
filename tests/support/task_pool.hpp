// A pool of a task by name, and the rows that it shows.
#pragma once
#include <string>

#include "contract.hpp"

namespace rdm::test {

struct TaskPool {
  rdm_pool* pool = nullptr;
  rdm_buffers b{};
  explicit TaskPool(const char* task, int32_t envs, int32_t threads = 0, int32_t autoreset = 0,
                    const char* settings = nullptr) {
    rdm_pool_config c = pool_config(envs);
    c.task = task;
    c.num_threads = threads;
    c.autoreset = autoreset;
    c.settings = settings;
    pool = make_pool(c);
    b.struct_size = sizeof b;
    EXPECT_EQ(rdm_pool_get_buffers(pool, &b), RDM_OK);
  }
  ~TaskPool() { rdm_pool_destroy(pool); }
  TaskPool(const TaskPool&) = delete;
  TaskPool& operator=(const TaskPool&) = delete;
  std::string text(int32_t env) const { return rdm_pool_world_error(pool, env); }
};

}  // namespace rdm::test

// One world of a built-in task that a test steps by hand.
#pragma once
#include <initializer_list>
#include <vector>

#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {

class SmallWorld {
 public:
  explicit SmallWorld(const char* task, std::vector<OptionInput> options = {}, int32_t envs = 1,
                      uint64_t seed = 0)
      : pool_((register_builtin_tasks(), task), envs, std::move(options), config(seed)) {
    pool_->reset(nullptr, nullptr);
  }
  // The same action in every world.
  void step(std::initializer_list<float> action) {
    for (int32_t e = 0; e < pool_->config().num_envs; ++e)
      std::copy(action.begin(), action.end(), pool_.action(e));
    pool_->step(nullptr);
  }
  float obs(int32_t i) const { return pool_.obs(0)[i]; }
  float reward(int32_t env = 0) const { return pool_.rows().reward[env]; }
  float cost(int32_t column = 0) const { return pool_.rows().cost[column]; }
  double ret() const { return static_cast<double>(pool_.rows().episode_return[0]); }
  double episode_cost() const { return static_cast<double>(pool_.rows().episode_cost[0]); }
  bool terminated() const { return pool_.rows().terminated[0] != 0; }
  bool truncated() const { return pool_.rows().truncated[0] != 0; }
  bool success() const { return pool_.rows().success[0] != 0; }
  TestPool& pool() { return pool_; }
  Vec3 body(int32_t i) { return pool_->world(0).body(i).X.p; }

 private:
  static PoolConfig config(uint64_t seed) {
    PoolConfig c;
    c.seed = seed;
    return c;
  }
  TestPool pool_;
};

}  // namespace rdm::test

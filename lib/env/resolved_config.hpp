// A pool's config made concrete: its task made, its options laid in, its sizes known. What a spec, a measure
// and a pool have in common, so that none of them accepts what another refuses.
#pragma once
#include "env/budget.hpp"
#include "env/dynamics_shown.hpp"
#include "env/option_table.hpp"
#include "env/options/disturb.hpp"
#include "env/options/repeat.hpp"
#include "env/options/sense.hpp"
#include "env/pool.hpp"
#include "env/task.hpp"

namespace rdm {

struct ResolvedPoolConfig {
  // All that can be wrong with a config is found here, and all but the engine's limits and names of fields
  // before the task is made.
  explicit ResolvedPoolConfig(const PoolConfig& c);
  ~ResolvedPoolConfig();
  ResolvedPoolConfig(const ResolvedPoolConfig&) = delete;
  ResolvedPoolConfig& operator=(const ResolvedPoolConfig&) = delete;

  PoolConfig config;  // its options are laid in: list and lines are gone
  Options options;
  ChosenOptionTable* table =
      nullptr;            // rows of the task, where the host's choices made others than the static ones
  int32_t task_rows = 0;  // that the task has of `options`
  int32_t task_index = -1;
  TaskRef ref;  // keeps a task that a host may remove
  const TaskInfo* info = nullptr;
  SenseConfig sense;
  int32_t repeat = 1;                // control steps of one step
  uint64_t options_hash = 0;         // task name and every option's value
  TaskHandle own_task;               // as the registry's row makes it
  DynamicsTask* dynamics = nullptr;  // around it, where what it draws is observed
  BudgetTask* budget = nullptr;      // around that, where a budget is observed
  const Task* task = nullptr;        // the outermost
  Disturbance disturbance;
  int32_t obs_dim = 0, action_dim = 0, cost_dim = 0;
  float obs_limit = 0;

  size_t num() const { return static_cast<size_t>(config.num_envs); }
  int32_t num_blocks() const;
  int32_t block_worlds() const { return (config.num_envs + num_blocks() - 1) / num_blocks(); }  // at most
  int32_t block_begin(int32_t block) const;  // first world of a block; of num_blocks(): num_envs

 private:
  void read_options(const PoolConfig& c);
  uint64_t hash_options() const;
};

}  // namespace rdm

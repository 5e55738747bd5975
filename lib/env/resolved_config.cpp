#include "env/resolved_config.hpp"

#include <cstring>

#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {
namespace {

constexpr int32_t kMaxEnvs = 65536, kMaxThreads = 256;

}  // namespace

// Of what decides a world's course: not of what is seen of it.
uint64_t ResolvedPoolConfig::hash_options() const {
  uint64_t hash = hash_bytes(info->name, std::strlen(info->name) + 1);
  for (int32_t i = 0; i < task_rows; ++i) {
    const OptionSpec& spec = options.spec(i);
    hash = hash_bytes(spec.key, std::strlen(spec.key) + 1, hash);
    if (spec.kind == OptionKind::kText) {
      const char* text = options.text(spec.key);
      hash = hash_bytes(text, std::strlen(text) + 1, hash);
    } else {
      const OptionRange value = options.range(i);
      hash = hash_bytes(&value.low, sizeof value.low, hash);
      if (spec.if_given && options.given(i)) hash = hash_bytes(spec.key, 1, hash);  // not the default
      if (value.drawn()) hash = hash_bytes(&value.high, sizeof value.high, hash);
    }
  }
  return hash_dynamics(options, hash_budget(options, hash_disturbance(options, hash)));
}

// A first look finds what chooses other rows (the robots); with those in place all keys must be known.
void ResolvedPoolConfig::read_options(const PoolConfig& c) {
  if (c.num_options < 0 || (c.num_options > 0 && !c.options))
    fail(Code::kArgument, "options is NULL with num_options %d", c.num_options);
  const OptionSpec* specs = task_options(*info, &task_rows);
  Options first;
  first.add_table(specs, task_rows);
  first.set_known(c.options, c.num_options, c.settings, info->name);
  if (first.chosen()) {
    table = host_new<ChosenOptionTable>(c.hooks, &first);
    specs = task_options(*info, &task_rows, table);
  }
  options.add_table(specs, task_rows);
  int32_t count = 0;
  specs = sense_options(&count);
  options.add_table(specs, count);
  specs = repeat_options(&count);
  options.add_table(specs, count);
  specs = disturb_options(&count);
  options.add_table(specs, count);
  specs = budget_options(&count);
  options.add_table(specs, count);
  specs = dynamics_options(&count);
  options.add_table(specs, count);
  options.set_all(c.options, c.num_options, c.settings, info->name);
}

TaskHandle make_task(const TaskInfo& info, const Options& options, const HostHooks& hooks, void* user) {
  const HostScope scope(hooks);
  return {info.source ? info.source->make(options, hooks, user) : info.make(options, hooks), {&info, hooks}};
}

void EndTask::operator()(Task* task) const {
  info->source ? info->source->destroy(task, hooks) : info->destroy(task, hooks);
}

const OptionSpec* task_options(const TaskInfo& info, int32_t* count, OptionTable* chosen) {
  return info.source ? info.source->options(count) : info.options(count, chosen);
}

ResolvedPoolConfig::ResolvedPoolConfig(const PoolConfig& c) : config(c) {
  if (c.num_envs < 1 || c.num_envs > kMaxEnvs)
    fail(Code::kRange, "num_envs: %d is outside [1, %d]", c.num_envs, kMaxEnvs);
  if (c.num_threads < 0 || c.num_threads > kMaxThreads)
    fail(Code::kRange, "num_threads: %d is outside [0, %d]", c.num_threads, kMaxThreads);
  task_index = task_find(c.task);
  ref = TaskRef(task_index);
  info = &*ref;
  config.task = info->name;
  config.options = nullptr;
  config.settings = nullptr;
  const HostScope scope(config.hooks);
  struct Undo {  // what a constructor that fails leaves
    ResolvedPoolConfig* made;
    ~Undo() {
      if (!made) return;
      host_delete(made->config.hooks, made->budget);
      host_delete(made->config.hooks, made->dynamics);
      host_delete(made->config.hooks, made->table);
    }
  } undo{this};
  read_options(c);
  repeat = repeat_from(options, *info);
  options_hash = hash_options();
  const Budget limits = budget_from(options, *info);
  own_task = make_task(*info, options, config.hooks, config.user);
  task = own_task.get();
  sense = sense_from(options, *info, *task);
  if (info->source) {  // another task may have its name by now
    const size_t bytes = own_task->state_bytes();
    options_hash = hash_bytes(&bytes, sizeof bytes, options_hash);
  }
  disturbance = disturbance_from(options, *task, info->name);
  if (shows_dynamics(options))
    task = dynamics = host_new<DynamicsTask>(config.hooks, *task, disturbance, info->name);
  if (limits.any()) task = budget = host_new<BudgetTask>(config.hooks, *task, limits);
  obs_dim = rdm::obs_dim(*task);
  action_dim = task->action_dim();
  cost_dim = info->num_costs;
  obs_limit = task->obs_limit();
  Arena measure;  // the engine refuses here what it cannot do
  World::measure(task->engine(), task->scene(), measure);
  undo.made = nullptr;
}

ResolvedPoolConfig::~ResolvedPoolConfig() {
  host_delete(config.hooks, budget);
  host_delete(config.hooks, dynamics);
  host_delete(config.hooks, table);
}

int32_t ResolvedPoolConfig::num_blocks() const {
  const int32_t threads = config.num_threads > 1 ? config.num_threads : 1;
  return threads < config.num_envs ? threads : config.num_envs;
}

int32_t ResolvedPoolConfig::block_begin(int32_t block) const {
  return Workers::part_begin(config.num_envs, num_blocks(), block);
}

}  // namespace rdm

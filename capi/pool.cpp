// rdm_pool_*: config to pool and back. Pictures and poses are in cameras.cpp.

#include "capi/handles.hpp"
#if RDM_WITH_SIM
#include "env/resolved_config.hpp"
#include "sense/drawn_shapes.hpp"
#include "tasks/catalog.hpp"
#endif

using namespace rdm;
using namespace rdm::capi;

namespace {
constexpr size_t kFirstConfigSize = offsetof(rdm_pool_config, settings);
constexpr size_t kFirstStatsSize = offsetof(rdm_pool_stats, bad_actions);
}  // namespace

rdm_result rdm_pool_config_init(rdm_pool_config* c, size_t size) {
  return call([&] {
    rdm_pool_config d{};
    d.num_envs = 1;
    init_struct(c, size, kFirstConfigSize, d, "c");
  });
}

#if RDM_WITH_SIM
namespace {

struct Config {
  PoolConfig pool;
  Vector<OptionInput> options;
};

// All but the hooks.
void read_config(const rdm_pool_config* c, Config* out) {
  register_builtin_tasks();
  const auto in = read_struct(c, kFirstConfigSize, rdm_pool_config{}, "config");
  check_error(in);
  need(in.task, "config.task");
  PoolConfig& p = out->pool;
  p.user = in.user;
  p.num_envs = in.num_envs;
  p.num_threads = in.num_threads;
  p.task = in.task;
  p.seed = in.seed;
  if (in.autoreset < RDM_AUTORESET_SAME_STEP || in.autoreset > RDM_AUTORESET_OFF)
    fail(Code::kRange, "config.autoreset: %d is outside [0, 2]", in.autoreset);
  p.autoreset = static_cast<Autoreset>(in.autoreset);
  out->options = read_options(in.options, in.num_options, "options");
  p.options = out->options.data();
  p.num_options = in.num_options;
  p.settings = in.settings;
}

rdm_spec spec_of(const Task& task, int32_t index, int32_t repeat) {
  rdm_spec s{};
  s.control_dt = static_cast<float>(task.scene().control_dt());
  s.obs_dim = obs_dim(task);
  s.action_dim = task.action_dim();
  s.cost_dim = task_at(index).num_costs;
  s.max_steps = task.max_steps();
  s.layout_hash = layout_hash(task);
  s.num_fields = static_cast<int32_t>(task.fields().size());
  s.num_shapes = static_cast<int32_t>(task.scene().shapes.size());
  s.num_joints = task.scene().num_links;
  s.task = index;
  s.action_repeat = repeat;
  return s;
}

int32_t group_sets(const Task& task) {
  int32_t n = 0;
  for (const char *key, *list; task.group_set_at(n, &key, &list);) ++n;
  return n;
}

// The arrays that rdm_agent_config_for_pool lends out, and what pictures are made in.
void carve(Arena& arena, const Task& task, const TaskInfo& info, rdm_pool* p) {
  p->defaults = arena.make<rdm_option>(static_cast<size_t>(info.num_defaults + group_sets(task)) + 1);
  p->initial_mean = arena.make<float>(static_cast<size_t>(task.action_dim()));
  p->cost_limits = arena.make<double>(static_cast<size_t>(info.num_costs));
  p->fields = arena.make<rdm_field>(task.fields().size());
  const int32_t shapes = most_drawn_shapes(task.scene());
  p->shapes = arena.make<RenderShape>(static_cast<size_t>(shapes));
  p->raycast = carve_raycast_scratch(arena, shapes);
}

size_t side_bytes(const Task& task, const TaskInfo& info) {
  Arena measure;
  rdm_pool none;
  carve(measure, task, info, &none);
  return measure.used();
}

// The task's, with a decision rate that a pool can keep which does `repeat` control steps at a time, and its teams.
int32_t fill_defaults(const Task& task, const TaskInfo& info, int32_t repeat, rdm_option* out) {
  int32_t n = 0;
  for (int32_t i = 0; i < info.num_defaults; ++i)
    if (repeat == 1 || !same_name(info.defaults[i].key, "action_repeat"))
      out[n++] = {info.defaults[i].key, info.defaults[i].value, 0};
  const int32_t own = decision_steps(info);
  if (repeat > 1)
    out[n++] = {"action_repeat", nullptr, static_cast<double>(own % repeat == 0 ? own : repeat)};
  for (int32_t i = 0; task.group_set_at(i, &out[n].key, &out[n].text); ++i) ++n;
  return n;
}

void fill_side(rdm_pool* p) {
  const Task& task = p->pool->task();
  const TaskInfo& info = task_at(p->pool->task_index());
  p->arena = Arena(p->hooks, side_bytes(task, info));
  carve(p->arena, task, info, p);
  p->num_defaults = fill_defaults(task, info, p->pool->repeat(), p->defaults);
  task.initial_mean(p->initial_mean);
  for (size_t i = 0; i < task.fields().size(); ++i) {
    const rdm_field_info f = field_of(task, static_cast<int32_t>(i));
    p->fields[i] = {f.name, f.unit, f.offset, f.count};
  }
  for (int32_t i = 0; i < info.num_costs; ++i) p->cost_limits[i] = info.costs[i].limit;
  if (task.limit(nullptr) >= 0) p->cost_limits[0] = task.limit(nullptr);
}

HostHooks hooks_of(const rdm_pool_config* c) {
  return hooks_from(read_struct(c, kFirstConfigSize, rdm_pool_config{}, "config").host);
}

// What a block must have for a pool of this config: *engines may be null. What is made to know it is made in
// memory of the C library, and is not kept.
size_t block_bytes(const rdm_pool_config* c, size_t* engines) {
  MemoryCount count;
  HostHooks hooks = count.hooks();
  const HostScope scope(hooks);
  Config config;
  read_config(c, &config);
  if (hooks_of(c).parallel) hooks.parallel = [](void*, int32_t, ParallelBody, void*) {};  // it counts
  config.pool.hooks = hooks;
  count.take(sizeof(rdm_pool));
  Pool::measure(config.pool, &count, engines, side_bytes);
  return count.bytes();
}

[[noreturn]] void too_small(const rdm_pool_config* c, size_t bytes) {
  fail(Code::kRange, "bytes: %zu are too few, %zu are needed", bytes, block_bytes(c, nullptr));
}

void end_pool(rdm_pool* p) {
  p->layout.end();
  if (p->pool) Pool::destroy(p->pool);
  retire(p);
  host_delete(p->hooks, p);
}

// In the order of block_bytes, so that both take the same. block: whose memory `hooks` gives out, or null.
rdm_pool* make_pool(const HostHooks& hooks, MemoryBlock* block, const rdm_pool_config* c) {
  const HostScope scope(hooks);
  Config config;
  read_config(c, &config);
  config.pool.hooks = hooks;
  rdm_pool* p = host_new<rdm_pool>(hooks);
  p->hooks = hooks;
  p->block = block;
  try {
    p->pool = Pool::create(config.pool);
    fill_side(p);
    p->layout.list(layout_hash(p->pool->task()), p->fields,
                   static_cast<int32_t>(p->pool->task().fields().size()));
  } catch (...) {
    end_pool(p);
    throw;
  }
  return p;
}

}  // namespace

rdm_result rdm_pool_config_spec(const rdm_pool_config* c, rdm_spec* io) {
  return call_with(c, [&] {
    check_out(io, kFirstSpecSize, "io");
    const HostHooks hooks = hooks_of(c);
    const HostScope scope(hooks);
    Config config;
    read_config(c, &config);
    config.pool.hooks = hooks;
    const ResolvedPoolConfig plan(config.pool);
    write_struct(io, spec_of(*plan.task, plan.task_index, plan.repeat), kFirstSpecSize, "io");
  });
}

rdm_result rdm_pool_config_memory(const rdm_pool_config* c, size_t* ours, size_t* engines) {
  return call_with(c, [&] {
    size_t theirs = 0;
    const size_t bytes = block_bytes(c, &theirs);
    if (ours) *ours = bytes;
    if (engines) *engines = theirs;
  });
}

rdm_result rdm_pool_create(rdm_pool** out, const rdm_pool_config* c) {
  return call_with(c, [&] {
    need(out, "out");
    const HostHooks hooks = hooks_of(c);
    if (!hooks.alloc) {  // nobody sees how often the C library is asked: the pool need not be made twice
      *out = make_pool(hooks, nullptr, c);
      return;
    }
    const size_t bytes = block_bytes(c, nullptr);
    void* const memory = host_alloc(hooks, bytes, Arena::kAlign);
    MemoryBlock* const block = MemoryBlock::make(memory, bytes, hooks, true);
    try {
      rdm_pool* const p = make_pool(block->hooks(), block, c);
      p->memory = memory;
      p->bytes = bytes;
      *out = p;
    } catch (...) {
      MemoryBlock::end(block);
      host_release(hooks, memory, bytes, Arena::kAlign);
      throw;
    }
  });
}

rdm_result rdm_pool_create_in(rdm_pool** out, const rdm_pool_config* c, void* memory, size_t bytes) {
  return call_with(c, [&] {
    need(out, "out");
    need(memory, "memory");
    MemoryBlock* const block = MemoryBlock::make(memory, bytes, hooks_of(c), false);
    try {
      if (!block) too_small(c, bytes);
      *out = make_pool(block->hooks(), block, c);
    } catch (...) {
      const bool refused = block && block->refused();
      if (block) MemoryBlock::end(block);
      if (refused) too_small(c, bytes);
      throw;
    }
  });
}

void rdm_pool_destroy(rdm_pool* p) {
  if (!may_end(p)) return;
  const FpMode mode;
  MemoryBlock* const block = p->block;
  void* const memory = p->memory;
  const size_t bytes = p->bytes;
  end_pool(p);
  if (!block) return;
  const HostHooks host = block->host();
  MemoryBlock::end(block);
  if (memory) host_release(host, memory, bytes, Arena::kAlign);
}

const char* rdm_pool_error(const rdm_pool* p) {
  return is_handle(p) ? p->error : "pool: NULL, not a pool, or destroyed";
}

const char* rdm_pool_world_error(const rdm_pool* p, int32_t env) {
  if (!is_handle(p)) return rdm_pool_error(p);
  if (env < 0 || env >= p->pool->config().num_envs) return "env: no such world";
  return p->pool->task_error(env);
}

rdm_result rdm_pool_get_spec(const rdm_pool* p, rdm_spec* io) {
  return call_on(p, [&] {
    write_struct(io, spec_of(p->pool->task(), p->pool->task_index(), p->pool->repeat()), kFirstSpecSize,
                 "io");
  });
}

rdm_field_info rdm::capi::field_of(const Task& task, int32_t i) {
  const auto& fields = task.fields();
  need_index(i, static_cast<int64_t>(fields.size()), "i");
  const FieldSpec f = bounded_field(task, i);
  rdm_field_info o{};
  for (int32_t k = 0; k < i; ++k) o.offset += fields[static_cast<size_t>(k)].count;
  o.count = f.count;
  o.name = fields[static_cast<size_t>(i)].name.text;
  o.unit = f.unit;
  o.low = f.low;
  o.high = f.high;
  return o;
}

rdm_result rdm_pool_field_at(const rdm_pool* p, int32_t i, rdm_field_info* io) {
  return call_on(p, [&] {
    check_out(io, sizeof(rdm_field_info), "io");
    write_struct(io, field_of(p->pool->task(), i), sizeof(rdm_field_info), "io");
  });
}

rdm_result rdm_pool_setting_at(const rdm_pool* p, int32_t i, const char** key, char* text) {
  return call_on(p, [&] { give_option(p->pool->options(), i, key, text, "rdm_pool_get_settings"); });
}

rdm_result rdm_pool_get_settings(const rdm_pool* p, char* text, size_t capacity, size_t* size) {
  return call_on(p, [&] { give_settings(p->pool->options(), text, capacity, size); });
}

rdm_result rdm_pool_get_initial_mean(const rdm_pool* p, float* action) {
  return call_on(p, [&] {
    need(action, "action");
    std::copy_n(p->initial_mean, p->pool->task().action_dim(), action);
  });
}

rdm_result rdm_pool_get_buffers(const rdm_pool* p, rdm_buffers* io) {
  return call_on(p, [&] {
    const Buffers& b = p->pool->buffers();
    rdm_buffers out{};
#define RDM_GIVE(type, name, width) out.name = b.name;
    RDM_POOL_BUFFERS(RDM_GIVE)
#undef RDM_GIVE
    write_struct(io, out, sizeof(rdm_buffers), "io");
  });
}

rdm_result rdm_pool_set_buffers(rdm_pool* p, const rdm_buffers* b) {
  return call_on(p, [&] {
    const auto in = read_struct(b, sizeof(rdm_buffers), rdm_buffers{}, "b");
    Buffers h;
    const auto lend = [](auto*& to, auto* array, const char* name) {
      if (reinterpret_cast<uintptr_t>(array) % alignof(decltype(*array)))
        fail(Code::kArgument, "b.%s is not %zu-byte aligned", name, alignof(decltype(*array)));
      to = array;
    };
#define RDM_LEND(type, name, width) lend(h.name, in.name, #name);
    RDM_POOL_BUFFERS(RDM_LEND)
#undef RDM_LEND
    p->pool->bind(h);
  });
}

rdm_result rdm_pool_reset(rdm_pool* p, const uint64_t* seeds, const uint8_t* mask) {
  return call_on(p, [&] { p->pool->reset(seeds, mask); });
}

rdm_result rdm_pool_step(rdm_pool* p) {
  return call_on(p, [&] { p->pool->step(nullptr); });
}

rdm_result rdm_pool_step_masked(rdm_pool* p, const uint8_t* mask) {
  return call_on(p, [&] {
    need(mask, "mask");
    p->pool->step(mask);
  });
}

rdm_result rdm_pool_set_limit(rdm_pool* p, int32_t env, double limit) {
  return call_on(p, [&] {
    if (env != -1) need_index(env, p->pool->config().num_envs, "env");
    p->pool->set_limit(env, limit);
  });
}

rdm_result rdm_pool_baseline(rdm_pool* p, int32_t kind) {
  return call_on(p, [&] {
    if (kind < RDM_BASELINE_ZERO || kind > RDM_BASELINE_RANDOM)
      fail(Code::kRange, "kind: %d is outside [0, 2]", kind);
    p->pool->baseline(static_cast<Baseline>(kind));
  });
}

namespace {
void check_env(const rdm_pool* p, int32_t env, bool all_allowed) {
  if (env == -1 && all_allowed) return;
  need_index(env, p->pool->config().num_envs, "env");
}
}  // namespace

rdm_result rdm_pool_write_state(const rdm_pool* p, int32_t env, void* bytes, size_t capacity, size_t* size) {
  return call_on(p, [&] {
    check_env(p, env, true);
    need(size, "size");
    const size_t n = p->pool->state_size(env);
    if (bytes) {
      if (capacity < n) fail(Code::kRange, "capacity: %zu bytes are too few, %zu are needed", capacity, n);
      Writer out(bytes, capacity);
      p->pool->get_state(env, out);
    }
    *size = n;
  });
}

rdm_result rdm_pool_set_rank(rdm_pool* p, int32_t rank, int32_t ranks) {
  return call_on(p, [&] { p->pool->set_rank(rank, ranks); });
}

rdm_result rdm_pool_read_state(rdm_pool* p, int32_t env, const void* bytes, size_t size) {
  return call_on(p, [&] {
    check_env(p, env, true);
    need(bytes, "bytes");
    p->pool->set_state(env, bytes, size);
  });
}

rdm_result rdm_pool_get_hash(const rdm_pool* p, int32_t env, uint64_t* hash) {
  return call_on(p, [&] {
    check_env(p, env, true);
    need(hash, "hash");
    *hash = p->pool->hash(env);
  });
}

rdm_result rdm_pool_copy(rdm_pool* dst, int32_t dst_env, const rdm_pool* src, int32_t src_env) {
  return call_on(dst, [&] {
    need_handle(src);
    const UseIfAny<const rdm_pool> use(src == dst ? nullptr : src);
    const int32_t worlds = dst->pool->config().num_envs;
    if (dst_env < -1 || dst_env >= worlds)
      fail(Code::kRange, "dst_env: %d is outside [-1, %d)", dst_env, worlds);
    dst->pool->copy(dst_env, *src->pool, src_env);
  });
}

rdm_result rdm_pool_get_stats(const rdm_pool* p, rdm_pool_stats* io) {
  return call_on(p, [&] {
    check_out(io, kFirstStatsSize, "io");
    const PoolStats s = p->pool->stats();
    rdm_pool_stats out{};
    out.contacts_max = s.contacts_max;
    out.contacts_mean = s.contacts_mean;
    out.joint_drift = s.joint_drift;
    out.steps = s.steps;
    out.diverged = s.diverged;
    out.overflowed = s.overflowed;
    out.bad_actions = s.bad_actions;
    out.task_failed = s.task_failed;
    out.unconverged = s.unconverged;
    out.slowed = s.slowed;
    out.violations = s.violations;
    out.solver_residual = s.solver_residual;
    write_struct(io, out, kFirstStatsSize, "io");
  });
}
#endif

// Making, ending and describing pools.
#include "env/pool.hpp"

#include <algorithm>
#include <cstring>
#include <new>

#include "base/hash.hpp"
#include "env/pool_internal.hpp"

namespace rdm {
namespace {

constexpr int32_t kMaxEnvs = 65536, kMaxThreads = 256;

// Of what decides a world's course: not of what is seen of it.
uint64_t hash_options(const TaskInfo& info, const Options& options) {
  uint64_t hash = hash_bytes(info.name, std::strlen(info.name) + 1);
  int32_t count = 0;
  info.options(&count);
  for (int32_t i = 0; i < count; ++i) {
    const OptionSpec& spec = options.spec(i);
    hash = hash_bytes(spec.key, std::strlen(spec.key) + 1, hash);
    if (spec.kind == OptionKind::kText) {
      const char* text = options.text(spec.key);
      hash = hash_bytes(text, std::strlen(text) + 1, hash);
    } else {
      double value = 0;
      if (spec.kind == OptionKind::kNumber) value = options.number(spec.key);
      if (spec.kind == OptionKind::kInteger) value = options.integer(spec.key);
      if (spec.kind == OptionKind::kFlag) value = options.flag(spec.key);
      hash = hash_bytes(&value, sizeof value, hash);
    }
  }
  return hash;
}

void read_options(const PoolConfig& config, const TaskInfo& info, Options* out) {
  if (config.num_options < 0 || (config.num_options > 0 && !config.options))
    fail(Code::kArgument, "options: %d given, but no list", config.num_options);
  int32_t count = 0;
  const OptionSpec* specs = info.options(&count);
  out->add_table(specs, count);
  specs = sense_options(&count);
  out->add_table(specs, count);
  for (int32_t i = 0; i < config.num_options; ++i) out->set(config.options[i], info.name);
}

}  // namespace

Task* make_task(const PoolConfig& config) {
  const HostScope scope(config.hooks);
  const TaskInfo& info = task_at(task_find(config.task));
  Options options;
  read_options(config, info, &options);
  return info.make(options, config.hooks);
}

ResolvedPoolConfig::ResolvedPoolConfig(const PoolConfig& c) : config(c) {
  if (c.num_envs < 1 || c.num_envs > kMaxEnvs)
    fail(Code::kRange, "num_envs: %d is outside [1, %d]", c.num_envs, kMaxEnvs);
  if (c.num_threads < 0 || c.num_threads > kMaxThreads)
    fail(Code::kRange, "num_threads: %d is outside [0, %d]", c.num_threads, kMaxThreads);
  task_index = task_find(c.task);
  info = &task_at(task_index);
  config.task = info->name;
  config.options = nullptr;
  read_options(c, *info, &options);
  options_hash = hash_options(*info, options);
  task = info->make(options, config.hooks);
  obs_dim = rdm::obs_dim(*task);
  action_dim = task->action_dim();
  cost_dim = info->num_costs;
  obs_limit = task->obs_limit();
  sense = sense_from(options, *info);
}

ResolvedPoolConfig::~ResolvedPoolConfig() {
  if (task) info->destroy(task, config.hooks);
}

int32_t ResolvedPoolConfig::num_blocks() const {
  const int32_t threads = config.num_threads > 1 ? config.num_threads : 1;
  return threads < config.num_envs ? threads : config.num_envs;
}

int32_t ResolvedPoolConfig::block_begin(int32_t block) const {
  return static_cast<int32_t>(int64_t{config.num_envs} * block / num_blocks());
}

Pool::Impl::Carved Pool::Impl::carve_rows(const ResolvedPoolConfig& plan, Arena& arena) {
  const size_t n = plan.num(), blocks = static_cast<size_t>(plan.num_blocks());
  const auto obs = static_cast<size_t>(plan.obs_dim), actions = static_cast<size_t>(plan.action_dim),
             costs = static_cast<size_t>(plan.cost_dim);
  Carved c;
  Buffers& b = c.buffers;
  b.obs = arena.make<float>(n * obs);
  b.final_obs = arena.make<float>(n * obs);
  b.action = arena.make<float>(n * actions);
  b.reward = arena.make<float>(n);
  b.cost = arena.make<float>(n * costs);
  b.cost_raw = arena.make<float>(n * costs);
  b.episode_return = arena.make<float>(n);
  b.episode_cost = arena.make<float>(n * costs);
  b.episode_step = arena.make<int32_t>(n);
  b.status = arena.make<uint32_t>(n);
  b.terminated = arena.make<uint8_t>(n);
  b.truncated = arena.make<uint8_t>(n);
  b.success = arena.make<uint8_t>(n);
  c.sensed = carve_sense_buffers(arena, plan.sense, n);
  c.slots = arena.make<Slot>(n);
  c.blocks = arena.make<Block>(blocks);
  for (size_t i = 0; i < blocks; ++i) {
    float* action = arena.make<float>(actions);
    const SenseScratch sense =
        carve_sense_scratch(arena, plan.sense, static_cast<int32_t>(plan.task->scene().shapes.size()));
    if (!c.blocks) continue;
    c.blocks[i].action = action;
    c.blocks[i].sense = sense;
  }
  return c;
}

size_t Pool::Impl::arena_bytes(const ResolvedPoolConfig& plan) {
  Arena rows, world[2];  // the first world of a block and the others
  carve_rows(plan, rows);
  for (const bool partnered : {false, true}) {
    world[partnered].make<unsigned char>(plan.task->state_bytes());
    World::measure(plan.task->engine(), plan.task->scene(), world[partnered], partnered);
  }
  const auto blocks = static_cast<size_t>(plan.num_blocks());
  return rows.used() + blocks * world[0].used() + (plan.num() - blocks) * world[1].used();
}

void Pool::Impl::build() {
  arena = Arena(config.hooks, arena_bytes(*this));
  const Carved carved = carve_rows(*this, arena);
  buffers = carved.buffers;
  sensed = carved.sensed;
  slots = carved.slots;
  blocks = carved.blocks;
  for (int32_t b = 0; b < num_blocks(); ++b) {
    World* partner = nullptr;  // the worlds of a block step one after the other
    for (int32_t i = block_begin(b); i < block_begin(b + 1); ++i) {
      Slot& s = slots[i];
      s.task_state = arena.make<unsigned char>(task->state_bytes());
      s.world = World::create(task->engine(), task->scene(), arena, config.hooks, partner);
      if (!partner) partner = s.world;
      name_streams(i, config.seed);
    }
  }
  group_size =
      std::clamp(config.group_size > 0 ? config.group_size : slots[0].world->group_size(), 1, kMaxGroup);
  Writer count(nullptr, 0);
  slots[0].world->save(count);
  pristine_size = count.size();
  pristine = static_cast<unsigned char*>(host_alloc(config.hooks, pristine_size, Arena::kAlign));
  Writer out(pristine, pristine_size);
  slots[0].world->save(out);
  workers = host_new<Workers>(config.hooks, config.hooks, config.num_threads);
}

void Pool::Impl::name_streams(int32_t env, uint64_t seed) {
  Episode& e = slots[env].episode;
  e.seed = seed;
  e.reset = Stream(seed, static_cast<uint32_t>(env), Purpose::kReset);
  e.policy = Stream(seed, static_cast<uint32_t>(env), Purpose::kRandomPolicy);
}

Pool::Impl::~Impl() {
  if (slots)
    for (size_t i = 0; i < num(); ++i)
      if (slots[i].world) World::destroy(slots[i].world, config.hooks);
  host_release(config.hooks, pristine, pristine_size, Arena::kAlign);
  host_delete(config.hooks, workers);
}

Pool::Pool() : impl_(nullptr) {}
Pool::~Pool() = default;

Pool* Pool::create(const PoolConfig& config) {
  const FpMode mode;
  const HostScope scope(config.hooks);
  Pool* p = new (host_alloc(config.hooks, sizeof(Pool), alignof(Pool))) Pool;
  try {
    p->impl_ = host_new<Impl>(config.hooks, config);
    p->impl_->build();
  } catch (...) {
    end(p, config.hooks);
    throw;
  }
  return p;
}

void Pool::destroy(Pool* p) {
  if (!p) return;
  const FpMode mode;
  end(p, HostHooks(p->impl_->config.hooks));
}

void Pool::end(Pool* p, const HostHooks& hooks) {
  const HostScope scope(hooks);
  host_delete(hooks, p->impl_);
  p->~Pool();
  host_release(hooks, p, sizeof(Pool), alignof(Pool));
}

const Task& Pool::task() const {
  return *impl_->task;
}
int32_t Pool::task_index() const {
  return impl_->task_index;
}
const Options& Pool::options() const {
  return impl_->options;
}
const PoolConfig& Pool::config() const {
  return impl_->config;
}
int32_t Pool::obs_dim() const {
  return impl_->obs_dim;
}
int32_t Pool::cost_dim() const {
  return impl_->cost_dim;
}
const Buffers& Pool::buffers() const {
  return impl_->buffers;
}
const SenseConfig& Pool::sense() const {
  return impl_->sense;
}
const SenseBuffers& Pool::sensed() const {
  return impl_->sensed;
}
World& Pool::world(int32_t env) {
  return *impl_->slots[env].world;
}
const World& Pool::world(int32_t env) const {
  return *impl_->slots[env].world;
}
Workers& Pool::workers() {
  return *impl_->workers;
}

void Pool::bind(const Buffers& host) {
  Impl& m = *impl_;
  const auto take = [](auto*& mine, auto* theirs, size_t count) {
    if (!theirs || theirs == mine) return;
    std::memmove(theirs, mine, count * sizeof *mine);
    mine = theirs;
  };
  const size_t n = m.num(), obs = n * static_cast<size_t>(m.obs_dim),
               costs = n * static_cast<size_t>(m.cost_dim);
  Buffers& b = m.buffers;
  take(b.obs, host.obs, obs);
  take(b.final_obs, host.final_obs, obs);
  take(b.action, host.action, n * static_cast<size_t>(m.action_dim));
  take(b.reward, host.reward, n);
  take(b.cost, host.cost, costs);
  take(b.cost_raw, host.cost_raw, costs);
  take(b.episode_return, host.episode_return, n);
  take(b.episode_cost, host.episode_cost, costs);
  take(b.episode_step, host.episode_step, n);
  take(b.status, host.status, n);
  take(b.terminated, host.terminated, n);
  take(b.truncated, host.truncated, n);
  take(b.success, host.success, n);
}

PoolStats Pool::stats() const {
  PoolStats s;
  int64_t contacts = 0;
  for (size_t i = 0; i < impl_->num(); ++i) {
    const Slot& slot = impl_->slots[i];
    if (slot.counters.contacts_max > s.contacts_max) s.contacts_max = slot.counters.contacts_max;
    contacts += slot.counters.contacts_sum;
    s.steps += slot.counters.steps;
    s.diverged += slot.counters.diverged;
    s.overflowed += slot.counters.overflowed;
    const double drift = slot.world->joint_drift();
    if (drift > s.joint_drift) s.joint_drift = drift;
  }
  if (s.steps > 0) s.contacts_mean = static_cast<double>(contacts) / static_cast<double>(s.steps);
  return s;
}

}  // namespace rdm

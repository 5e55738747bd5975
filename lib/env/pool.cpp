// Making, ending and describing pools, and what one would take.
#include "env/pool.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

#include "base/hash.hpp"
#include "env/pool_internal.hpp"

namespace rdm {
namespace {

// What a pool takes for its worlds, from `block` on, and then last(bytes of a world's state). The first world
// of each block is made, as nobody knows otherwise what it takes beside its arrays.
template <class F>
void count_worlds(const ResolvedPoolConfig& plan, int32_t block, size_t state_bytes, MemoryCount* count,
                  const F& last) {
  if (block == plan.num_blocks()) return last(state_bytes);
  const EngineKind engine = plan.task->engine();
  const Scene& scene = plan.task->scene();
  const HostHooks uncounted;
  Arena measure;
  {
    const HostScope scope(uncounted);
    World::measure(engine, scene, measure, false, plan.block_worlds());
  }
  Arena arena(uncounted, measure.used());
  const auto end = [&](World* world) { World::destroy(world, plan.config.hooks); };
  const std::unique_ptr<World, decltype(end)> first(
      World::create(engine, scene, arena, plan.config.hooks, nullptr, plan.block_worlds()), end);
  for (int32_t i = plan.block_begin(block) + 1; i < plan.block_begin(block + 1); ++i)
    count->take(World::object_bytes(engine));
  Writer state(nullptr, 0);
  first->save(state);
  count_worlds(plan, block + 1, state.size(), count, last);
}

}  // namespace

Pool::Impl::Carved Pool::Impl::carve_rows(const ResolvedPoolConfig& plan, Arena& arena) {
  const size_t n = plan.num(), blocks = static_cast<size_t>(plan.num_blocks());
  const auto width_obs = static_cast<size_t>(plan.obs_dim),
             width_action = static_cast<size_t>(plan.action_dim),
             width_cost = static_cast<size_t>(plan.cost_dim);
  Carved c;
  Buffers& b = c.buffers;
#define RDM_CARVE(type, name, width) b.name = arena.make<type>(n * (width));
  RDM_POOL_BUFFERS(RDM_CARVE)
#undef RDM_CARVE
  c.sensed = carve_sense_buffers(arena, plan.sense, n);
  c.slots = arena.make<Slot>(n);
  c.blocks = arena.make<Block>(blocks);
  if (plan.info->source) c.task_errors = arena.make<char>(n * kErrorTextSize);
  c.tried_state = arena.make<unsigned char>(plan.task->state_bytes());
  c.tried.carve(arena, plan.disturbance, *plan.task);
  if (plan.task->takes_rows()) c.work.carve(arena, plan);
  for (size_t i = 0; i < blocks; ++i) {
    float* action = arena.make<float>(width_action);
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
    WorldDisturbance().carve(world[partnered], plan.disturbance, *plan.task);
    World::measure(plan.task->engine(), plan.task->scene(), world[partnered], partnered, plan.block_worlds());
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
  task_errors = carved.task_errors;
  tried_state = carved.tried_state;
  tried = carved.tried;
  work = carved.work;
  for (int32_t b = 0; b < num_blocks(); ++b) {
    World* partner = nullptr;  // the worlds of a block step one after the other
    for (int32_t i = block_begin(b); i < block_begin(b + 1); ++i) {
      Slot& s = slots[i];
      s.task_state = arena.make<unsigned char>(task->state_bytes());
      s.disturbance.carve(arena, disturbance, *task);
      s.world = World::create(task->engine(), task->scene(), arena, config.hooks, partner, block_worlds());
      s.world->set_number(i);
      if (!partner) partner = s.world;
      name_streams(i, config.seed, static_cast<uint32_t>(i));
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
  layout = layout_hash(*task);
  workers = host_new<Workers>(config.hooks, config.hooks, config.num_threads);
}

void Pool::Impl::name_streams(int32_t env, uint64_t seed, uint32_t number) {
  Episode& e = slots[env].episode;
  e.seed = seed;
  e.reset = Stream(seed, number, Purpose::kReset);
  e.policy = Stream(seed, number, Purpose::kRandomPolicy);
  slots[env].disturbance.name(seed, number);
  slots[env].start = Stream(seed, number, Purpose::kStart);
}

void Pool::set_rank(int32_t rank, int32_t ranks) {
  Impl& m = *impl_;
  if (ranks < 1 || ranks > kMaxRanks) fail(Code::kRange, "ranks: %d is outside [1, %d]", ranks, kMaxRanks);
  if (rank < 0 || rank >= ranks) fail(Code::kRange, "rank: %d is outside [0, %d]", rank, ranks - 1);
  const int32_t n = m.config.num_envs;
  for (int32_t i = 0; i < n; ++i)
    if (m.slots[i].episode.phase != Phase::kNew)
      fail(Code::kState, "set_rank is allowed before the first reset only, and world %d has begun", i);
  for (int32_t i = 0; i < n; ++i)
    m.name_streams(i, m.config.seed,
                   static_cast<uint32_t>(rank) * static_cast<uint32_t>(n) + static_cast<uint32_t>(i));
  m.rank = rank, m.ranks = ranks;
}

int32_t Pool::rank() const {
  return impl_->rank;
}

int32_t Pool::ranks() const {
  return impl_->ranks;
}

Pool::Impl::~Impl() {
  if (slots)
    for (size_t i = 0; i < num(); ++i)
      if (slots[i].world) World::destroy(slots[i].world, config.hooks);
  host_release(config.hooks, pristine, pristine_size, Arena::kAlign);
  host_delete(config.hooks, workers);
}

void Pool::measure(const PoolConfig& config, MemoryCount* count, size_t* engines, SideBytes* side) {
  const FpMode mode;
  const HostScope scope(config.hooks);
  count->take(sizeof(Pool));
  count->take(sizeof(Impl));
  const ResolvedPoolConfig plan(config);
  const auto blocks = static_cast<size_t>(plan.num_blocks());
  const EngineKind engine = plan.task->engine();
  const Scene& scene = plan.task->scene();
  count->take(Impl::arena_bytes(plan));
  count_worlds(plan, 0, 0, count, [&](size_t state_bytes) {
    count->take(state_bytes);
    count->take(sizeof(Workers));
    const Workers::Taken taken = Workers::takes(config.hooks, config.num_threads);
    for (int32_t i = 0; i < taken.count; ++i) count->take(taken.bytes[i]);
    if (side) count->take(side(*plan.task, *plan.info));
  });
  if (engines)
    *engines = blocks * World::engine_bytes(engine, scene) +
               (plan.num() - blocks) * World::engine_bytes(engine, scene, true);
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
uint64_t Pool::options_hash() const {
  return impl_->options_hash;
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
bool Pool::guard_at(int32_t i, Guard* guard, float* normal) const {
  return !impl_->disturbance.delays_actions() && impl_->task->guard_at(i, guard, normal);
}
int32_t Pool::repeat() const {
  return impl_->repeat;
}
double Pool::limit(int32_t env) const {
  return impl_->task->limit(impl_->slots[env].task_state);
}
int32_t Pool::taken(int32_t env) const {
  return impl_->slots[env].taken;
}
double Pool::magnitude(int32_t env, int32_t cost) const {
  if (impl_->repeat > 1) return impl_->slots[env].magnitude[cost];
  return std::max(static_cast<double>(impl_->cost_row(impl_->buffers.cost_raw, env)[cost]), 0.0);
}
bool Pool::begun(int32_t env) const {
  return impl_->slots[env].episode.phase != Phase::kNew;
}

bool Pool::running(int32_t env) const {
  return impl_->slots[env].episode.phase == Phase::kRunning;
}
int32_t Pool::episode_step(int32_t env) const {
  return impl_->slots[env].episode.step;
}
double Pool::gained(int32_t env) const {
  return impl_->slots[env].episode.sum_reward;
}
double Pool::spent(int32_t env, int32_t cost) const {
  return impl_->slots[env].episode.sum_cost[cost];
}
uint64_t Pool::episode_mark(int32_t env) const {
  const Episode& e = impl_->slots[env].episode;
  const uint64_t name[] = {e.seed, e.reset.world(), e.reset.counter()};
  return hash_bytes(name, sizeof name);
}
uint32_t Pool::course(int32_t env) const {
  return impl_->slots[env].course;
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
  const size_t n = m.num();
  const auto width_obs = static_cast<size_t>(m.obs_dim), width_action = static_cast<size_t>(m.action_dim),
             width_cost = static_cast<size_t>(m.cost_dim);
#define RDM_TAKE(type, name, width) take(m.buffers.name, host.name, n*(width));
  RDM_POOL_BUFFERS(RDM_TAKE)
#undef RDM_TAKE
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
    s.bad_actions += slot.counters.bad_actions;
    s.task_failed += slot.counters.task_failed;
    s.unconverged += slot.counters.unconverged;
    s.slowed += slot.counters.slowed;
    const double drift = slot.world->joint_drift();
    if (drift > s.joint_drift) s.joint_drift = drift;
    const double residual = slot.world->solver_residual();
    if (!(residual <= s.solver_residual)) s.solver_residual = residual;
  }
  s.violations = violations();
  if (s.steps > 0) s.contacts_mean = static_cast<double>(contacts) / static_cast<double>(s.steps);
  return s;
}

int64_t Pool::violations() const {
  int64_t sum = 0;
  for (size_t i = 0; i < impl_->num(); ++i) sum += impl_->slots[i].counters.violations;
  return sum;
}

int64_t Pool::violations(int32_t env) const {
  return impl_->slots[env].counters.violations;
}

}  // namespace rdm

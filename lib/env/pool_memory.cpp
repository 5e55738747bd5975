// What a pool would take, found by making its parts with hooks that count.
#include "base/fpmode.hpp"
#include "env/pool_internal.hpp"

namespace rdm {
namespace {

struct Counter {
  HostHooks inner;
  size_t live = 0;
};

HostHooks counting(Counter* counter) {
  HostHooks hooks = counter->inner;
  hooks.user = counter;
  hooks.log = nullptr;
  hooks.parallel = nullptr;
  hooks.alloc = [](void* user, size_t bytes, size_t align) {
    auto* c = static_cast<Counter*>(user);
    void* p = host_alloc(c->inner, bytes, align);
    c->live += bytes;
    return p;
  };
  hooks.release = [](void* user, void* p, size_t bytes, size_t align) {
    auto* c = static_cast<Counter*>(user);
    host_release(c->inner, p, bytes, align);
    c->live -= bytes;
  };
  return hooks;
}

}  // namespace

void Pool::memory(const PoolConfig& config, size_t* ours, size_t* engines) {
  const FpMode mode;
  Counter counter{config.hooks};
  const HostHooks hooks = counting(&counter);
  const HostScope scope(hooks);
  PoolConfig counted = config;
  counted.hooks = hooks;
  const ResolvedPoolConfig plan(counted);
  size_t total = counter.live + sizeof(Pool) + sizeof(Impl) + Impl::arena_bytes(plan) + sizeof(Workers) +
                 Workers::memory(config.hooks, config.num_threads);

  // two worlds tell what each takes beside its arrays, and how long its saved state is
  const EngineKind engine = plan.task->engine();
  const Scene& scene = plan.task->scene();
  const size_t blocks = static_cast<size_t>(plan.num_blocks()), others = plan.num() - blocks;
  Arena measure;
  World::measure(engine, scene, measure);
  World::measure(engine, scene, measure, true);
  Arena arena(config.hooks, measure.used());
  const size_t before = counter.live;
  World* first = World::create(engine, scene, arena, hooks);
  const size_t between = counter.live;
  World* other = World::create(engine, scene, arena, hooks, first);
  total += blocks * (between - before) + others * (counter.live - between);
  Writer state(nullptr, 0);
  first->save(state);
  total += state.size();
  World::destroy(other, hooks);
  World::destroy(first, hooks);

  if (ours) *ours = total;
  if (engines)
    *engines =
        blocks * World::engine_bytes(engine, scene) + others * World::engine_bytes(engine, scene, true);
}

}  // namespace rdm

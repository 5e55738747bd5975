// rdm_shield_*: a shield over a pool's worlds, with policies as backups; guards and the nearest action that keeps them.

#include "capi/handles.hpp"

#if RDM_WITH_SIM
#include <cmath>
#include <cstdio>
#include <limits>

#include "capi/shield.hpp"

using namespace rdm;
using namespace rdm::capi;

namespace {

constexpr int32_t kMostHeld = 1000, kBackupRows = 64;

static_assert(RDM_MAX_GUARDS == kMostGuards);
static_assert(static_cast<int>(RDM_SHIELD_PROJECTED) == static_cast<int>(ShieldKind::kProjected));

#if RDM_WITH_POLICY
// Steps of the pool that a policy holds an action for.
int32_t held_steps(const rdm_policy* policy, int32_t repeat) {
  need_handle(policy);
  const int32_t held = policy->policy->view().action_repeat;
  if (held % repeat != 0)
    fail(Code::kArgument,
         "policy: it holds an action for %d control steps, which is not a multiple of the pool's %d", held,
         repeat);
  return held / repeat;
}

void add_policy(rdm_shield* s, const rdm_policy* policy) {
  const int32_t steps = s->shield->steps(), held = held_steps(policy, s->spec.action_repeat);
  check_policy(policy->policy->view(), s->spec);
  if (policy->policy->view().eyes.points)
    fail(Code::kUnsupported, "policy: it reads points, which copies do not have");
  if (held != steps)
    fail(Code::kArgument,
         "policy: it holds an action for %d steps of the pool, but a decision of the shield lasts %d", held,
         steps);
  if (s->num_backups == Shield::kMostPolicies)
    fail(Code::kRange, "shield: it already has %d policies, the most that are allowed", s->num_backups);
  FrozenMean& backup = s->backups[s->num_backups];
  backup.open(s->hooks, policy->policy, kBackupRows);
  s->shield->add_policy(&backup);
  ++s->num_backups;
}
#else
int32_t held_steps(const rdm_policy*, int32_t) {
  left_out("learning");
}
void add_policy(rdm_shield*, const rdm_policy*) {
  left_out("learning");
}
#endif

}  // namespace

rdm_result rdm_project(const float* normals, const float* bounds, size_t count, size_t dim,
                       const float* action, float* nearest) {
  return call([&] {
    if (count > kMostGuards) fail(Code::kRange, "count: %zu is outside [0, %d]", count, kMostGuards);
    if (dim < 1 || dim > kMostEntries) fail(Code::kRange, "dim: %zu is outside [1, %d]", dim, kMostEntries);
    if (count > 0) need(normals, "normals");
    if (count > 0) need(bounds, "bounds");
    need(action, "action");
    need(nearest, "nearest");
    const auto n = static_cast<int32_t>(count), width = static_cast<int32_t>(dim);
    HalfSpace rows[kMostGuards];
    for (size_t i = 0; i < count; ++i) {
      char name[40];
      std::snprintf(name, sizeof name, "normals: row %zu", i);
      rows[i] = {normals + i * dim, bounds[i]};
      check_half_space(rows[i], width, name);
    }
    for (size_t j = 0; j < dim; ++j)
      if (!std::isfinite(action[j])) fail(Code::kArgument, "action: entry %zu is not finite", j);
    if (!nearest_action(rows, n, width, action, nearest))
      fail(Code::kArgument, "normals: no action in [-1, 1] keeps all %d rows", n);
  });
}

rdm_result rdm_pool_guard_at(const rdm_pool* p, int32_t i, rdm_guard* io, float* normal) {
  return call_on(p, [&] {
    check_out(io, sizeof(rdm_guard), "io");
    const int32_t dim = p->pool->task().action_dim();
    Vector<float> row(static_cast<size_t>(dim));
    Guard g;
    if (!p->pool->guard_at(i, &g, row.data())) fail(Code::kRange, "i: the pool has no guard number %d", i);
    rdm_guard out{};
    out.column = g.column;
    out.entry = single_entry({row.data(), g.bound}, dim);
    out.bound = g.bound;
    if (normal) std::copy(row.begin(), row.end(), normal);
    write_struct(io, out, sizeof(rdm_guard), "io");
  });
}

rdm_result rdm_shield_config_init(rdm_shield_config* c, size_t size) {
  return call([&] { init_struct(c, size, sizeof(rdm_shield_config), rdm_shield_config{}, "c"); });
}

rdm_result rdm_shield_create(rdm_shield** out, const rdm_shield_config* c) {
  return call_with(c, [&] {
    need(out, "out");
    const auto in = read_struct(c, sizeof(rdm_shield_config), rdm_shield_config{}, "config");
    check_error(in);
    need(in.pool, "config.pool");
    const Use use(in.pool);
    if (in.num_threads < 0 || in.num_threads > 256)
      fail(Code::kRange, "config.num_threads: %d is outside [0, 256]", in.num_threads);
    if (in.steps < 0 || in.steps > kMostHeld)
      fail(Code::kRange, "config.steps: %d is outside [0, %d]", in.steps, kMostHeld);
    const HostHooks hooks = hooks_from(in.host);
    const HostScope scope(hooks);
    const Vector<OptionInput> options = read_options(in.options, in.num_options, "options");
    rdm_shield* s = host_new<rdm_shield>(hooks);
    s->hooks = hooks;
    try {
      s->spec.struct_size = sizeof s->spec;
      if (const rdm_result r = rdm_pool_get_spec(in.pool, &s->spec))
        fail(static_cast<Code>(r), "%s", last_error());
      ShieldConfig config;
      config.pool = in.pool->pool;
      config.num_threads = in.num_threads;
      config.seed = in.seed;
      config.steps = in.steps > 0 ? in.steps : in.policy ? held_steps(in.policy, s->spec.action_repeat) : 1;
      config.budgets = in.budgets;
      config.options = options.data();
      config.num_options = in.num_options;
      config.settings = in.settings;
      config.hooks = hooks;
      s->shield = Shield::create(config);
      if (in.policy) add_policy(s, in.policy);
    } catch (...) {
      rdm_shield_destroy(s);
      throw;
    }
    *out = s;
  });
}

rdm_result rdm_shield_add_policy(rdm_shield* s, const rdm_policy* policy) {
  return call_on(s, [&] { add_policy(s, policy); });
}

rdm_result rdm_shield_add_guard(rdm_shield* s, const float* normal, float bound) {
  return call_on(s, [&] {
    need(normal, "normal");
    s->shield->add_guard(normal, bound);
  });
}

rdm_result rdm_shield_set_guard(rdm_shield* s, int32_t env, int32_t i, const float* normal, float bound) {
  return call_on(s, [&] {
    need(normal, "normal");
    s->shield->set_guard(env, i, normal, bound);
  });
}

void rdm_shield_destroy(rdm_shield* s) {
  if (!may_end(s)) return;
  const FpMode mode;
  Shield::destroy(s->shield);
  retire(s);
  host_delete(s->hooks, s);
}

const char* rdm_shield_error(const rdm_shield* s) {
  return is_handle(s) ? s->error : "shield: NULL, not a shield, or destroyed";
}

rdm_result rdm_shield_option_at(int32_t i, rdm_option_spec* io) {
  return call([&] {
    check_out(io, sizeof(rdm_option_spec), "io");
    int32_t count = 0;
    const OptionSpec* rows = shield_options(&count);
    need_index(i, count, "i");
    write_struct(io, describe(rows[i]), sizeof(rdm_option_spec), "io");
  });
}

rdm_result rdm_shield_get_settings(const rdm_shield* s, char* text, size_t capacity, size_t* size) {
  return call_on(s, [&] { give_settings(s->shield->options(), text, capacity, size); });
}

rdm_result rdm_shield_act(rdm_shield* s, const rdm_pool* pool, const uint8_t* mask, const float* proposed,
                          float* action) {
  return call_on(s, [&] {
    const Use use(pool);
    need(proposed, "proposed");
    need(action, "action");
    s->shield->act(*pool->pool, mask, proposed, nullptr, action);
  });
}

rdm_result rdm_shield_get_row(const rdm_shield* s, const rdm_pool* pool, int32_t env, rdm_shield_row* io) {
  return call_on(s, [&] {
    const Use use(pool);
    s->shield->check_pool(*pool->pool);
    need_index(env, s->shield->num_envs(), "env");
    const ShieldRow& r = s->shield->row(env);
    rdm_shield_row out{};
    out.kind = static_cast<int32_t>(r.kind);
    out.column = r.column;
    out.ahead = r.ahead;
    out.backup = r.backup;
    s->shield->plan(*pool->pool, env, &out.planned);
    write_struct(io, out, sizeof out, "io");
  });
}

rdm_result rdm_shield_get_kinds(const rdm_shield* s, int32_t* kind) {
  return call_on(s, [&] {
    need(kind, "kind");
    for (int32_t env = 0; env < s->shield->num_envs(); ++env)
      kind[env] = static_cast<int32_t>(s->shield->row(env).kind);
  });
}

rdm_result rdm_shield_set_plan(rdm_shield* s, const rdm_pool* pool, int32_t env, const float* plan,
                               size_t decisions) {
  return call_on(s, [&] {
    const Use use(pool);
    need(plan, "plan");
    need_index(env, s->shield->num_envs(), "env");
    const size_t most = std::numeric_limits<int32_t>::max();
    s->shield->set_plan(*pool->pool, env, plan, static_cast<int32_t>(std::min(decisions, most)));
  });
}

rdm_result rdm_shield_get_plan(const rdm_shield* s, const rdm_pool* pool, int32_t env, float* plan,
                               size_t capacity, size_t* size) {
  return call_on(s, [&] {
    const Use use(pool);
    need(size, "size");
    s->shield->check_pool(*pool->pool);
    need_index(env, s->shield->num_envs(), "env");
    int32_t decisions = 0;
    const float* rows = s->shield->plan(*pool->pool, env, &decisions);
    const size_t count = static_cast<size_t>(decisions) * static_cast<size_t>(s->shield->action_dim());
    if (plan) {
      if (capacity < count)
        fail(Code::kRange, "capacity: %zu numbers are too few, %zu are needed", capacity, count);
      std::copy_n(rows, count, plan);
    }
    *size = count;
  });
}

rdm_result rdm_shield_get_stats(const rdm_shield* s, rdm_shield_stats* io) {
  return call_on(s, [&] {
    const ShieldCounts& c = s->shield->counts();
    rdm_shield_stats out{};
    out.decisions = c.decisions;
    out.inquiries = c.inquiries;
    out.failed = c.failed;
    out.changed = c.changed;
    out.planned = c.planned;
    out.unproven = c.unproven;
    out.copied = c.copied;
    out.projected = c.projected;
    write_struct(io, out, sizeof out, "io");
  });
}

rdm_result rdm_shield_reset(rdm_shield* s, const uint8_t* mask) {
  return call_on(s, [&] { s->shield->forget(mask); });
}

rdm_result rdm_shield_write_state(const rdm_shield* s, void* bytes, size_t capacity, size_t* size) {
  return call_on(s, [&] { emit(bytes, capacity, size, [&](Writer& out) { s->shield->write_state(out); }); });
}

rdm_result rdm_shield_read_state(rdm_shield* s, const void* bytes, size_t size) {
  return call_on(s, [&] {
    need(bytes, "bytes");
    s->shield->read_state(bytes, size);
  });
}
#endif

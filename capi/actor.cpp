// rdm_actor_*: a policy that plays, its actions held as long as it decides.
#include "capi/handles.hpp"

#if RDM_WITH_POLICY
using namespace rdm;
using namespace rdm::capi;

struct rdm_actor {
  static constexpr Tag kTag = Tag::kActor;
  static constexpr bool kOneAtATime = false;
  Tag tag = kTag;
  mutable InUse in_use;
  HostHooks hooks;
  mutable char error[kErrorTextSize] = "";  // also of calls that only read
  Actor* actor = nullptr;
};

namespace {

constexpr size_t kFirstSize = sizeof(rdm_actor_config);

ActorConfig read_actor_config(const rdm_actor_config* c) {
  const auto in = read_struct(c, kFirstSize, rdm_actor_config{}, "config");
  check_error(in);
  need(in.policy, "config.policy");
  need_handle(in.policy);
  ActorConfig out;
  out.policy = in.policy->policy;
  out.num_envs = in.num_envs;
  out.stochastic = in.stochastic != 0;
  out.seed = in.seed;
  out.center = in.center;
  out.hooks = hooks_from(in.host);
  if (!in.spec) return out;
  const auto spec = read_struct(in.spec, kFirstSpecSize, rdm_spec{}, "config.spec");
  check_policy(out.policy->view(), spec);
  out.repeat = std::max(1, spec.action_repeat);  // of a program that knew no such field: 0
  return out;
}

PointRows read_clouds(const rdm_points* points, const PointNetShape& eyes) {
  if (!eyes.points) {
    if (points) fail(Code::kState, "policy: it does not read points");
    return {};
  }
  if (!points) fail(Code::kState, "points is NULL, but the policy reads clouds of %d points", eyes.points);
  const PointRows clouds = read_points(points, eyes);
  need_channels(eyes, clouds, 0);  // that they are there
  return clouds;
}

}  // namespace

rdm_result rdm_actor_config_init(rdm_actor_config* c, size_t size) {
  return call([&] { init_struct(c, size, kFirstSize, rdm_actor_config{}, "c"); });
}

rdm_result rdm_actor_config_memory(const rdm_actor_config* c, size_t* bytes) {
  return call_with(c, [&] {
    need(bytes, "bytes");
    *bytes = Actor::memory(read_actor_config(c)) + sizeof(rdm_actor);
  });
}

rdm_result rdm_actor_create(rdm_actor** out, const rdm_actor_config* c) {
  return call_with(c, [&] {
    need(out, "out");
    const ActorConfig config = read_actor_config(c);
    rdm_actor* a = host_new<rdm_actor>(config.hooks);
    a->hooks = config.hooks;
    try {
      a->actor = Actor::create(config);
    } catch (...) {
      host_delete(a->hooks, a);
      throw;
    }
    *out = a;
  });
}

void rdm_actor_destroy(rdm_actor* a) {
  if (!may_end(a)) return;
  Actor::destroy(a->actor);
  retire(a);
  host_delete(a->hooks, a);
}

const char* rdm_actor_error(const rdm_actor* a) {
  return is_handle(a) ? a->error : "actor: NULL, not an actor, or destroyed";
}

rdm_result rdm_actor_act(rdm_actor* a, const float* obs, const rdm_points* points, const uint8_t* mask,
                         float* action) {
  return call_on(a, [&] {
    need(obs, "obs");
    need(action, "action");
    a->actor->act(obs, read_clouds(points, a->actor->policy().view().eyes), mask, action);
  });
}

rdm_result rdm_actor_reset(rdm_actor* a, const uint8_t* terminated, const uint8_t* truncated) {
  return call_on(a, [&] { a->actor->reset(terminated, truncated); });
}

rdm_result rdm_actor_write_state(const rdm_actor* a, void* bytes, size_t capacity, size_t* size) {
  return call_on(a, [&] { emit(bytes, capacity, size, [&](Writer& out) { a->actor->write_state(out); }); });
}

rdm_result rdm_actor_read_state(rdm_actor* a, const void* bytes, size_t size) {
  return call_on(a, [&] {
    need(bytes, "bytes");
    a->actor->read_state(bytes, size);
  });
}
#endif

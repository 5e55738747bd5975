// rdm_policy_*: the frozen network.
#include "base/file.hpp"
#include "capi/handles.hpp"

#if RDM_WITH_LEARN
using namespace rdm;
using namespace rdm::capi;

struct rdm_policy {
  HostHooks hooks;
  Policy* policy = nullptr;
};

namespace {
void make(rdm_policy** out, const void* bytes, size_t size) {
  const HostHooks hooks = host();
  rdm_policy* p = host_new<rdm_policy>(hooks);
  p->hooks = hooks;
  try {
    p->policy = Policy::read(bytes, size, hooks);
  } catch (...) {
    host_delete(hooks, p);
    throw;
  }
  *out = p;
}
}  // namespace

rdm_result rdm_policy_load(rdm_policy** out, const void* bytes, size_t size) {
  return call(nullptr, [&] {
    need(out, "out");
    need(bytes, "bytes");
    make(out, bytes, size);
  });
}

rdm_result rdm_policy_load_file(rdm_policy** out, const char* path) {
  return call(nullptr, [&] {
    need(out, "out");
    need(path, "path");
    const auto bytes = read_file(path);
    make(out, bytes.data(), bytes.size());
  });
}

void rdm_policy_destroy(rdm_policy* p) {
  if (!p) return;
  Policy::destroy(p->policy);
  host_delete(p->hooks, p);
}

rdm_result rdm_policy_get_info(const rdm_policy* p, rdm_policy_info* io) {
  return call(nullptr, [&] {
    need(p, "policy");
    const PolicyView& v = p->policy->view();
    rdm_policy_info info{};
    info.obs_dim = v.actor.in;
    info.action_dim = v.actor.out;
    info.action_repeat = v.action_repeat;
    info.control_dt = v.control_dt;
    info.noise_correlation = v.noise_correlation;
    info.layout_hash = v.layout_hash;
    info.num_params = v.actor.num_params();
    info.task = v.task;
    write_struct(io, info, sizeof(rdm_policy_info), "io");
  });
}

size_t rdm_policy_scratch(const rdm_policy* p, int32_t rows) {
  return p && rows > 0 ? p->policy->scratch_bytes(rows) : 0;
}

rdm_result rdm_policy_act(const rdm_policy* p, const float* obs, int32_t rows, const float* noise,
                          float* action, void* scratch, size_t scratch_bytes) {
  return call(nullptr, [&] {
    need(p, "policy");
    need(obs, "obs");
    need(action, "action");
    need(scratch, "scratch");
    if (rows < 1) fail(Code::kRange, "rows: %d is less than 1", rows);
    const size_t bytes = p->policy->scratch_bytes(rows);
    if (scratch_bytes < bytes) fail(Code::kRange, "scratch_bytes: %zu, %zu are needed", scratch_bytes, bytes);
    if (reinterpret_cast<uintptr_t>(scratch) % Arena::kAlign)
      fail(Code::kArgument, "scratch is not %zu-byte aligned", Arena::kAlign);
    p->policy->act(obs, rows, noise, action, scratch);
  });
}

rdm_result rdm_policy_check(const rdm_policy* p, const rdm_spec* spec) {
  return call(nullptr, [&] {
    need(p, "policy");
    const auto s = read_struct(spec, sizeof(rdm_spec), rdm_spec{}, "spec");
    const PolicyView& v = p->policy->view();
    if (v.actor.in != s.obs_dim)
      fail(Code::kVersion, "obs_dim: the policy has %d, the task %d", v.actor.in, s.obs_dim);
    if (v.actor.out != s.action_dim)
      fail(Code::kVersion, "action_dim: the policy has %d, the task %d", v.actor.out, s.action_dim);
    if (v.layout_hash && s.layout_hash && v.layout_hash != s.layout_hash)
      fail(Code::kVersion, "layout_hash: the policy learned another layout of observations or actions");
    if (v.control_dt > 0 && s.control_dt > 0 && std::abs(v.control_dt - s.control_dt) > 1e-6f)
      fail(Code::kVersion, "control_dt: the policy has %g s, the task %g s",
           static_cast<double>(v.control_dt), static_cast<double>(s.control_dt));
  });
}
#endif

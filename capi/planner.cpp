// rdm_planner_*: planning in a pool's worlds, with a policy's proposals and an agent's critic.

#include "capi/frozen_mean.hpp"

#if RDM_WITH_SIM
#include "plan/planner.hpp"

using namespace rdm;
using namespace rdm::capi;

namespace {

constexpr size_t kFirstSize = offsetof(rdm_planner_config, stop);
constexpr size_t kFirstInfoSize = offsetof(rdm_plan_info, iterations);

#if RDM_WITH_LEARN
class Critics final : public PlanCritic {
 public:
  void open(const Agent* agent) { agent_ = agent; }
  void values(const float* obs, const float* state, int32_t rows, float* value, float* cost) override {
    agent_->values(obs, state, rows, value, cost);
  }
  void see(const float* obs, int32_t rows, float* state) override { agent_->see(obs, rows, state); }
  int32_t state_dim() const override { return agent_->history_dim(); }
  int32_t repeat() const override { return agent_->action_repeat(); }
  int32_t num_costs() const override { return agent_->num_limited(); }
  int32_t column(int32_t i) const override { return agent_->limited_column(i); }

 private:
  const Agent* agent_ = nullptr;
};
#endif

}  // namespace

struct rdm_planner {
  static constexpr Tag kTag = Tag::kPlanner;
  static constexpr bool kOneAtATime = false;
  Tag tag = kTag;
  mutable InUse in_use;
  HostHooks hooks;
  mutable char error[kErrorTextSize] = "";  // also of calls that only read
  Planner* planner = nullptr;
#if RDM_WITH_POLICY
  FrozenMean proposals;
#endif
#if RDM_WITH_LEARN
  Critics critics;
  const rdm_agent* agent = nullptr;  // theirs
#endif
};

namespace {

#if RDM_WITH_POLICY
void use_policy(const rdm_policy* policy, const rdm_pool* pool, rdm_planner* p, PlannerConfig* config) {
  if (!policy) return;
  need_handle(policy);
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  if (const rdm_result r = rdm_pool_get_spec(pool, &spec)) fail(static_cast<Code>(r), "%s", last_error());
  check_policy(policy->policy->view(), spec);
  if (policy->policy->view().eyes.points)
    fail(Code::kUnsupported, "config.policy: it reads points, which simulated plans do not have");
  p->proposals.open(p->hooks, policy->policy, 1);
  config->policy = &p->proposals;
}
#else
void use_policy(const rdm_policy* policy, const rdm_pool*, rdm_planner*, PlannerConfig*) {
  if (policy) left_out("learning");
}
#endif

#if RDM_WITH_LEARN
void use_critic(const rdm_agent* agent, const Pool& pool, rdm_planner* p, PlannerConfig* config) {
  if (!agent) return;
  const Use use(agent);
  const AgentConfig& a = agent->agent->config();
  if (a.obs_dim != pool.obs_dim())
    fail(Code::kArgument, "obs_dim: the agent has %d, but the pool has %d", a.obs_dim, pool.obs_dim());
  if (a.cost_dim != pool.cost_dim())
    fail(Code::kArgument, "cost_dim: the agent has %d, but the pool has %d", a.cost_dim, pool.cost_dim());
  agent->agent->values(nullptr, nullptr, 0, nullptr, nullptr);  // refuses critics without a unit
  p->critics.open(agent->agent);
  p->agent = agent;
  config->critic = &p->critics;
}
#else
void use_critic(const rdm_agent* agent, const Pool&, rdm_planner*, PlannerConfig*) {
  if (agent) left_out("learning");
}
#endif

}  // namespace

rdm_result rdm_planner_config_init(rdm_planner_config* c, size_t size) {
  return call([&] { init_struct(c, size, kFirstSize, rdm_planner_config{}, "c"); });
}

rdm_result rdm_planner_create(rdm_planner** out, const rdm_planner_config* c) {
  return call_with(c, [&] {
    need(out, "out");
    const auto in = read_struct(c, kFirstSize, rdm_planner_config{}, "config");
    check_error(in);
    need(in.pool, "config.pool");
    const Use use(in.pool);
    if (in.num_threads < 0 || in.num_threads > 256)
      fail(Code::kRange, "config.num_threads: %d is outside [0, 256]", in.num_threads);
    const HostHooks hooks = hooks_from(in.host);
    const HostScope scope(hooks);
    const Vector<OptionInput> options = read_options(in.options, in.num_options, "options");
    PlannerConfig config;
    config.pool = in.pool->pool;
    config.num_threads = in.num_threads;
    config.seed = in.seed;
    config.noise = in.noise;
    config.cost_limits = in.cost_limits;
    config.options = options.data();
    config.num_options = in.num_options;
    config.settings = in.settings;
    config.stop = in.stop;
    config.user = in.user;
    config.hooks = hooks;
    rdm_planner* p = host_new<rdm_planner>(hooks);
    p->hooks = hooks;
    try {
      use_policy(in.policy, in.pool, p, &config);
      use_critic(in.agent, *in.pool->pool, p, &config);
      p->planner = Planner::create(config);
    } catch (...) {
      rdm_planner_destroy(p);
      throw;
    }
    *out = p;
  });
}

void rdm_planner_destroy(rdm_planner* p) {
  if (!may_end(p)) return;
  const FpMode mode;
  Planner::destroy(p->planner);
  retire(p);
  host_delete(p->hooks, p);
}

const char* rdm_planner_error(const rdm_planner* p) {
  return is_handle(p) ? p->error : "planner: NULL, not a planner, or destroyed";
}

rdm_result rdm_planner_get_spec(const rdm_planner* p, rdm_planner_spec* io) {
  return call_on(p, [&] {
    rdm_planner_spec s{};
    s.samples = p->planner->samples();
    s.horizon = p->planner->horizon();
    s.knots = p->planner->knots();
    s.action_dim = p->planner->action_dim();
    s.cost_dim = p->planner->cost_dim();
    write_struct(io, s, sizeof s, "io");
  });
}

rdm_result rdm_planner_option_at(int32_t i, rdm_option_spec* io) {
  return call([&] {
    check_out(io, sizeof(rdm_option_spec), "io");
    int32_t count = 0;
    const OptionSpec* rows = planner_options(&count);
    need_index(i, count, "i");
    write_struct(io, describe(rows[i]), sizeof(rdm_option_spec), "io");
  });
}

rdm_result rdm_planner_get_settings(const rdm_planner* p, char* text, size_t capacity, size_t* size) {
  return call_on(p, [&] { give_settings(p->planner->options(), text, capacity, size); });
}

rdm_result rdm_planner_act(rdm_planner* p, const rdm_pool* pool, int32_t env, float* action,
                           rdm_plan_info* io) {
  return call_on(p, [&] {
    const Use use(pool);
#if RDM_WITH_LEARN
    const UseIfAny<const rdm_agent> critic(p->agent);
#endif
    need_index(env, pool->pool->config().num_envs, "env");
    need(action, "action");
    if (io) check_out(io, kFirstInfoSize, "io");
    PlanInfo info;
    p->planner->act(*pool->pool, env, action, &info);
    if (!io) return;
    rdm_plan_info out{};
    out.planned = info.iterations > 0;
    out.best = info.best_sample;
    out.ret = info.best.ret;
    std::copy(info.best.cost, info.best.cost + kMaxTaskCosts, out.cost);
    out.feasible_share = info.feasible_share;
    out.steps = info.steps;
    out.cut = info.cut;
    out.iterations = info.iterations;
    write_struct(io, out, kFirstInfoSize, "io");
  });
}

void rdm_planner_cancel(rdm_planner* p) {
  if (is_handle(p)) p->planner->cancel();
}

rdm_result rdm_planner_reset(rdm_planner* p) {
  return call_on(p, [&] { p->planner->forget(); });
}

rdm_result rdm_planner_get_plan(const rdm_planner* p, float* plan) {
  return call_on(p, [&] {
    need(plan, "plan");
    std::copy_n(p->planner->plan(), p->planner->horizon() * p->planner->action_dim(), plan);
  });
}

rdm_result rdm_planner_set_plan(rdm_planner* p, const float* plan) {
  return call_on(p, [&] {
    need(plan, "plan");
    p->planner->set_plan(plan);
  });
}

rdm_result rdm_planner_write_state(const rdm_planner* p, void* bytes, size_t capacity, size_t* size) {
  return call_on(p, [&] { emit(bytes, capacity, size, [&](Writer& out) { p->planner->write_state(out); }); });
}

rdm_result rdm_planner_read_state(rdm_planner* p, const void* bytes, size_t size) {
  return call_on(p, [&] {
    need(bytes, "bytes");
    p->planner->read_state(bytes, size);
  });
}
#endif

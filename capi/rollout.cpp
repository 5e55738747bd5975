// Agents that learn from pools: what needs both halves.
#include "capi/handles.hpp"
#include "capi/shield.hpp"

#if RDM_WITH_SIM && RDM_WITH_LEARN
using namespace rdm;
using namespace rdm::capi;

namespace {

void check_match(const AgentConfig& a, int32_t repeat, const Pool& p) {
  const auto same = [](int32_t agent, int32_t pool, const char* what) {
    if (agent != pool) fail(Code::kArgument, "%s: the agent has %d, but the pool has %d", what, agent, pool);
  };
  same(a.num_envs, p.config().num_envs, "num_envs");
  same(a.obs_dim, p.obs_dim(), "obs_dim");
  same(a.action_dim, p.task().action_dim(), "action_dim");
  same(a.cost_dim, p.cost_dim(), "cost_dim");
  same(a.ranks.rank, p.rank(), "rank");
  same(a.ranks.count, p.ranks(), "ranks");
  if (p.config().autoreset == Autoreset::kOff)
    fail(Code::kState, "pool: its autoreset is off, so a rollout would stop at the first end of an episode");
  for (int32_t i = 0; i < p.config().num_envs; ++i)
    if (!p.begun(i)) fail(Code::kState, "pool: world %d was not reset yet", i);
  if (repeat % p.repeat() != 0)
    fail(Code::kArgument, "action_repeat: the agent's, %d, is not a multiple of the pool's, %d", repeat,
         p.repeat());
}

// One decision: the action in the pool's buffer is held for `repeat` steps of the pool by the worlds in d.mask,
// others have ended; a world whose episode
// ends sits out the rest, so that every world has the same number of decisions.
void hold_action(Pool& pool, DecisionBuffers& d, int32_t repeat, bool raw_costs) {
  const Buffers& b = pool.buffers();
  const auto n = static_cast<size_t>(pool.config().num_envs);
  const auto costs = static_cast<size_t>(pool.cost_dim());
  std::fill_n(d.reward, n, 0.0f);
  std::fill_n(d.cost, n * costs, 0.0f);
  std::fill_n(d.steps, n, 0);
  std::fill_n(d.success, n, uint8_t{0});
  std::fill_n(d.status, n, uint32_t{0});
  for (size_t i = 0; i < n; ++i) {
    d.valid[i] = 1;
    d.terminated[i] = !d.mask[i];
    d.truncated[i] = 0;
  }
  for (int32_t r = 0; r < repeat; ++r) {
    pool.step(d.mask);
    bool any = false;
    for (size_t i = 0; i < n; ++i) {
      if (!d.mask[i]) continue;
      const bool only_reset = pool.taken(static_cast<int32_t>(i)) == 0;
      if (only_reset) d.valid[i] = 0;  // next-step mode, or a reset that had failed before
      d.terminated[i] = b.terminated[i] && !only_reset;
      d.truncated[i] = b.truncated[i] && !only_reset;
      d.status[i] |= b.status[i];
      if (d.valid[i]) {
        d.reward[i] += b.reward[i];
        for (size_t k = 0; k < costs; ++k)
          d.cost[i * costs + k] +=
              raw_costs ? static_cast<float>(pool.magnitude(static_cast<int32_t>(i), static_cast<int32_t>(k)))
                        : b.cost[i * costs + k];
        d.steps[i] += pool.taken(static_cast<int32_t>(i));
        d.success[i] |= b.success[i];
      }
      if (b.terminated[i] || b.truncated[i] || !d.valid[i]) d.mask[i] = 0;
      any |= d.mask[i] != 0;
    }
    if (!any) break;
  }
}

// What an agent will do in the decisions to come.
class AgentForesight final : public Foresight {
 public:
  explicit AgentForesight(const Agent& agent) : agent_(agent) {}
  int32_t state_dim() const override { return agent_.state_dim(); }
  void begin(int32_t env, Stream* noise, float* offset, float* state) override {
    agent_.peek(env, noise, offset, state);
  }
  void act(const int32_t* env, const float* obs, int32_t rows, float* state, Stream* noise, float* offset,
           float* action) override {
    agent_.foresee(env, obs, rows, state, noise, offset, action);
  }

 private:
  const Agent& agent_;
};

// A shield between an agent that samples and the pool, for a rollout.
class Shielded {
 public:
  Shielded(Agent& agent, Pool& pool, Shield* shield)
      : agent_(agent), pool_(pool), shield_(shield), foresight_(agent) {
    violations_ = pool.violations();
    if (!shield) return;
    if (agent.eyes().points && shield->predicts())
      fail(Code::kUnsupported, "shield: the agent's encoder needs points, which copies do not have");
    if (shield->steps() * pool.repeat() != agent.action_repeat())
      fail(Code::kArgument, "shield: its decisions last %d control steps, but the agent's last %d",
           shield->steps() * pool.repeat(), agent.action_repeat());
    how_ = agent.shield_learn();
    penalty_ = static_cast<float>(agent.shield_penalty());
    if (how_ == ShieldLearn::kCost && agent.config().cost_dim < 1)
      fail(Code::kArgument, "shield_learn: cost needs an agent with costs, and cost_dim is 0");
    counts_ = shield->counts();
    shield->expect(foresight_.state_dim());
    shield->forget_blocks();  // options, tensors or a policy may have been set
  }

  // The pool's action buffer holds the agent's samples, then what is to run in the worlds of d.mask.
  void look(DecisionBuffers& d) {
    std::fill_n(d.mask, pool_.config().num_envs, uint8_t{1});
    if (!shield_) return;
    for (int32_t i = 0; i < shield_->num_envs(); ++i) {
      d.mask[i] = pool_.running(i);
      if (!d.mask[i]) shield_->skip(i);  // its step only resets
    }
    float* action = pool_.buffers().action;
    shield_->act(pool_, d.mask, action, &foresight_, action, how_ == ShieldLearn::kEnd);
    const auto dim = static_cast<size_t>(shield_->action_dim());
    for (int32_t i = 0; i < shield_->num_envs(); ++i) {
      const bool ran = how_ == ShieldLearn::kApplied && refused(i);
      if (ran || shield_->own_moved(i))
        agent_.replace(i, ran ? action + static_cast<size_t>(i) * dim : shield_->own(i));
      d.mask[i] = !ends(i);
    }
    inevitable_ -= unproven_violations();
  }

  // After the step: what of it is learned from.
  void charge(DecisionBuffers& d) {
    if (!shield_) return;
    inevitable_ += unproven_violations();
    const auto costs = static_cast<size_t>(pool_.cost_dim());
    for (int32_t i = 0; i < shield_->num_envs(); ++i) {
      const auto e = static_cast<size_t>(i);
      if (refused(i)) d.reward[e] -= penalty_;
      if (how_ == ShieldLearn::kCost) d.cost[e * costs] = refused(i);
      d.mask[e] = ends(i);
    }
    if (how_ == ShieldLearn::kEnd) pool_.reset(nullptr, d.mask);
  }

  void count(Epoch* out) const {
    Ranks& ranks = agent_.ranks();
    out->violations = ranks.total(pool_.violations() - violations_);
    if (!shield_) return;
    const ShieldCounts& now = shield_->counts();
    const int64_t unproven = now.unproven - counts_.unproven;
    out->refused = ranks.total(now.changed - counts_.changed + now.planned - counts_.planned + now.projected -
                               counts_.projected + unproven);
    out->unproven = ranks.total(unproven);
    out->copied = ranks.total(now.copied - counts_.copied);
    out->inevitable = ranks.total(inevitable_);
    shield_->forget_blocks();
  }

 private:
  bool refused(int32_t env) const { return shield_->row(env).kind != ShieldKind::kOwn; }
  // What no plan avoids runs also where a refusal ends the episode: there is nothing to learn from it. So does a projected
  // action: guards hold for entries of the action, and noise seldom keeps within all of them for a whole episode.
  bool ends(int32_t env) const {
    if (how_ != ShieldLearn::kEnd) return false;
    switch (shield_->row(env).kind) {
      case ShieldKind::kOwn:
      case ShieldKind::kProjected:
        return false;
      case ShieldKind::kUnproven:
        return shield_->without_plan(env);
      default:
        return true;
    }
  }
  // So far, of worlds whose decision at hand is unproven.
  int64_t unproven_violations() const {
    int64_t sum = 0;
    for (int32_t i = 0; i < shield_->num_envs(); ++i)
      if (shield_->row(i).kind == ShieldKind::kUnproven) sum += pool_.violations(i);
    return sum;
  }

  Agent& agent_;
  Pool& pool_;
  Shield* shield_;
  AgentForesight foresight_;
  ShieldLearn how_ = ShieldLearn::kOwn;
  float penalty_ = 0;
  // Before the rollout.
  ShieldCounts counts_;
  int64_t violations_ = 0;
  int64_t inevitable_ = 0;  // since, control steps of unproven decisions that violated
};

// What the pool's worlds show to an agent with eyes.
PointRows clouds_of(const Agent& agent, const Pool& pool) {
  const PointNetShape& eyes = agent.eyes();
  PointRows clouds;
  if (!eyes.points) return clouds;
  clouds.metres = pool.sensed().points;
  if (!clouds.metres)
    fail(Code::kState, "pool: it has no points for the agent's encoder; set its option modality=points");
  if (pool.sense().num_points != eyes.points)
    fail(Code::kArgument, "encoder_points: the agent's encoder reads %d, but the pool has %d", eyes.points,
         pool.sense().num_points);
  if (eyes.color && !pool.sensed().point_color)
    fail(Code::kState,
         "pool: its points have no colours for the agent's encoder; set its option point_color=true");
  if (eyes.color) clouds.colors = pool.sensed().point_color;
  if (!eyes.classes) return clouds;
  if (const int32_t count = point_classes(pool.sense(), pool.task().scene()); count > eyes.classes)
    fail(Code::kArgument,
         "encoder_classes: the pool's points have %d classes, but the agent's encoder reads %d", count,
         eyes.classes);
  clouds.classes = pool.sensed().point_class;
  return clouds;
}

void rollout(Agent& agent, Pool& pool, Shield* shield, DecisionBuffers& d, Epoch* out) {
  check_match(agent.config(), agent.action_repeat(), pool);
  const PointRows clouds = clouds_of(agent, pool);
  agent.need_no_update("rollout");
  if (agent.missing() != agent.horizon())
    fail(Code::kState,
         "agent: a horizon was begun with rdm_agent_act; finish it with rdm_agent_record and "
         "rdm_agent_update");
  agent.ranks().set_pool(pool.config().seed, static_cast<int32_t>(pool.config().autoreset),
                         pool.options_hash());
  Shielded shielded(agent, pool, shield);
  const Buffers& b = pool.buffers();
  Transition t;
  t.reward = d.reward;
  t.cost = d.cost;
  t.terminated = d.terminated;
  t.truncated = d.truncated;
  t.final_obs = b.final_obs;
  t.valid = d.valid;
  t.success = d.success;
  t.steps = d.steps;
  t.status = d.status;
  const bool draws = pool.task().draws_limit();
  if (draws) t.limit = d.limit;
  try {
    while (agent.missing() > 0) {
      agent.check_cancel();
      agent.act(b.obs, true, b.action, clouds);
      for (int32_t i = 0; draws && i < pool.config().num_envs; ++i)
        d.limit[i] = static_cast<float>(pool.limit(i));
      shielded.look(d);
      hold_action(pool, d, agent.action_repeat() / pool.repeat(), agent.raw_costs());
      shielded.charge(d);
      agent.record(t);
    }
    agent.update(b.obs, out);
    shielded.count(out);
  } catch (...) {
    agent.drop_horizon();
    throw;
  }
}

}  // namespace

rdm_result rdm_agent_rollout(rdm_agent* a, rdm_pool* p, rdm_epoch* io) {
  return call_on(a, [&] {
    const Use use(p);
    if (io) check_out(io, kFirstEpochSize, "io");
    Epoch e;
    const UseIfAny<rdm_shield> shield(a->shield);
    rollout(*a->agent, *p->pool, a->shield ? a->shield->shield : nullptr, a->decision, &e);
    if (io) write_epoch(io, e);
  });
}

rdm_result rdm_agent_set_shield(rdm_agent* a, rdm_shield* shield) {
  return call_on(a, [&] {
    if (shield) need_handle(shield);
    if (a->agent->missing() != a->agent->horizon())
      fail(Code::kState, "set_shield: a horizon has begun; set the shield between epochs");
    if (shield) {
      const Use use(shield);  // it takes memory for what the agent remembers
      shield->shield->expect(a->agent->state_dim());
    }
    a->shield = shield;
  });
}

rdm_result rdm_agent_config_for_pool(rdm_agent_config* c, const rdm_pool* p) {
  return call_with(c, p, [&] {
    auto config = read_struct(c, kFirstAgentConfigSize, rdm_agent_config{}, "config");
    const Pool& pool = *p->pool;
    config.obs_dim = pool.obs_dim();
    config.action_dim = pool.task().action_dim();
    config.cost_dim = pool.cost_dim();
    config.num_envs = pool.config().num_envs;
    config.task = task_at(pool.task_index()).name;
    config.layout_hash = layout_hash(pool.task());
    config.control_dt = static_cast<float>(pool.task().scene().control_dt());
    config.max_steps = pool.task().max_steps();
    config.initial_mean = p->initial_mean;
    config.defaults = p->defaults;
    config.num_defaults = p->num_defaults;
    config.cost_limits = p->cost_limits;
    config.fields = p->fields;
    config.num_fields = static_cast<int32_t>(pool.task().fields().size());
    write_struct(c, config, kFirstAgentConfigSize, "config");
  });
}

#endif

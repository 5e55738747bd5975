// A planner whose proposals come from a policy that remembers, or whose critic has a history: against rollouts of public
// calls alone, which copy the world and the state; ends of episodes in each autoreset mode; saved states; what is
// cancelled or stopped; no heap.
#include "heap_count.hpp"
#include "planners.hpp"
#include "remembering.hpp"

namespace {

using Row = std::vector<float>;
constexpr char kTask[] = "max_steps=13\nnoise=0.3\naction_scale=1";
constexpr char kGru[] = "memory=gru:6\nhidden=8", kHistory[] = "history=4\nhidden=8";
// One sample, without noise: the plan is the policy's rollout.
constexpr char kProposal[] = "samples=1\nhorizon=8\ncosts=ignore";

Pool pool_of(int32_t autoreset = RDM_AUTORESET_OFF, int32_t envs = 1) {
  rdm_pool_config c = pool_config(envs);
  c.task = "lqr_line";
  c.settings = kTask;
  c.autoreset = autoreset;
  c.seed = 4;
  Pool p(make_pool(c));
  EXPECT_EQ(rdm_pool_reset(p.get(), nullptr, nullptr), RDM_OK);
  return p;
}

Planner planner_of(const Pool& pool, const Remembering& r, const char* settings,
                   int32_t (*stop)(void*, int64_t) = nullptr, void* user = nullptr) {
  rdm_planner_config c;
  EXPECT_EQ(rdm_planner_config_init(&c, sizeof c), RDM_OK);
  c.pool = pool.get();
  c.settings = settings;
  c.policy = r.policy.get();
  c.stop = stop;
  c.user = user;
  rdm_planner* p = nullptr;
  EXPECT_EQ(rdm_planner_create(&p, &c), RDM_OK) << rdm_last_error();
  return Planner(p);
}

float act(const Planner& planner, const Pool& pool, rdm_plan_info* info = nullptr) {
  float action = 0;
  EXPECT_EQ(rdm_planner_act(planner.get(), pool.get(), 0, &action, info), RDM_OK)
      << rdm_planner_error(planner.get());
  return action;
}

// The policy's rollout in a copy of the only world, whose state before step `at` of its episode is given; it decides
// each `hold`-th step of an episode, and `held` is what it decided last.
Row rollout(Remembering& r, const Pool& pool, Row state, int32_t at, int32_t hold, float held) {
  const Pool copy = pool_of();
  EXPECT_EQ(rdm_pool_copy(copy.get(), 0, pool.get(), 0), RDM_OK);
  const rdm_buffers c = buffers_of(copy.get());
  Row plan;
  bool over = false;
  for (int32_t t = 0; t < 8; ++t) {
    if (!over && (at + t) % hold == 0) held = r.act(c.obs, state)[0];
    plan.push_back(held);
    if (over) continue;
    c.action[0] = held;
    EXPECT_EQ(rdm_pool_step(copy.get()), RDM_OK);
    over = c.terminated[0] || c.truncated[0];
  }
  return plan;
}

// Each plan, over several episodes, whether a call plans or follows.
TEST(PlansByMemory, ProposesWhatThePolicyWouldDoThatSawTheEpisode) {
  for (const char* kind : {kGru, kHistory})
    for (const int32_t hold : {1, 3})
      for (const int32_t replan : {1, 4})
        for (const int32_t autoreset :
             {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP, RDM_AUTORESET_OFF}) {
          SCOPED_TRACE(::testing::Message()
                       << kind << ", held " << hold << ", replan " << replan << ", autoreset " << autoreset);
          const Pool pool = pool_of(autoreset);
          Remembering r(drawn_agent(pool, std::string(kind) + "\naction_repeat=" + std::to_string(hold), 1));
          const Planner planner =
              planner_of(pool, r, (std::string(kProposal) + "\nreplan=" + std::to_string(replan)).c_str());
          const rdm_buffers b = buffers_of(pool.get());
          Row state = r.fresh();
          const Row nothing = r.fresh();
          float held = 0;
          int32_t moved = 0, at = 0;
          for (int step = 0; step < 36; ++step, ++at) {
            const Row wanted = rollout(r, pool, state, at, hold, held),
                      blind = rollout(r, pool, nothing, at, hold, held);
            if (at % hold == 0) r.act(b.obs, state);
            auto info = RDM_INIT(rdm_plan_info);
            held = act(planner, pool, &info);
            EXPECT_EQ(info.planned, step % replan == 0);
            if (info.planned) {
              EXPECT_EQ(plan_of(planner), wanted) << step;
              moved += blind != wanted;
            }
            b.action[0] = held;
            ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
            if (!b.terminated[0] && !b.truncated[0]) continue;
            state = r.fresh();
            at = -1;
            if (autoreset == RDM_AUTORESET_OFF) {
              ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
            } else if (autoreset == RDM_AUTORESET_NEXT_STEP) {
              ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
            }
          }
          EXPECT_GT(moved, 3);  // plans hang on what is remembered
        }
}

TEST(PlansByMemory, GoesOnFromASavedStateAndBeginsAnewAfterAReset) {
  for (const char* kind : {kGru, kHistory})
    for (const int32_t autoreset : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_OFF}) {
      const Pool pool = pool_of(autoreset);
      Remembering r(drawn_agent(pool, kind, 1));
      const char* settings = "samples=4\nhorizon=6\nreplan=2\ncosts=ignore";
      const Planner planner = planner_of(pool, r, settings), lost = planner_of(pool, r, kProposal),
                    kept = planner_of(pool, r, kProposal);
      const rdm_buffers b = buffers_of(pool.get());
      bool differs = false;
      for (int step = 0; step < 40; ++step) {
        const auto saved = state_of(planner);
        const Planner resumed = planner_of(pool, r, settings);
        ASSERT_EQ(rdm_planner_read_state(resumed.get(), saved.data(), saved.size()), RDM_OK)
            << rdm_planner_error(resumed.get());
        EXPECT_EQ(state_of(resumed), saved);
        const float action = act(planner, pool);
        EXPECT_EQ(act(resumed, pool), action) << step;
        EXPECT_EQ(state_of(resumed), state_of(planner)) << step;
        // one that forgets in each step has the plan of a new one, which has seen nothing
        const Planner fresh = planner_of(pool, r, kProposal);
        ASSERT_EQ(rdm_planner_reset(lost.get()), RDM_OK);
        act(lost, pool), act(fresh, pool), act(kept, pool);
        EXPECT_EQ(plan_of(lost), plan_of(fresh));
        differs |= plan_of(lost) != plan_of(kept);
        b.action[0] = action;
        ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
        if (autoreset == RDM_AUTORESET_OFF && (b.terminated[0] || b.truncated[0])) {
          ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
        }
      }
      EXPECT_TRUE(differs);
      // states of others and broken ones
      const auto state = state_of(planner);
      Remembering none(drawn_agent(pool, "hidden=8", 1));
      const Planner plain = planner_of(pool, none, settings);
      EXPECT_EQ(rdm_planner_read_state(plain.get(), state.data(), state.size()), RDM_ERROR_FORMAT);
      for (size_t at = 0; at < state.size(); at += 7) {
        auto broken = state;
        broken[at] ^= 0x40;
        EXPECT_NE(rdm_planner_read_state(planner.get(), broken.data(), broken.size()), RDM_OK) << at;
        EXPECT_NE(rdm_planner_read_state(planner.get(), state.data(), at), RDM_OK) << at;
      }
      EXPECT_EQ(state_of(planner), state);
    }
}

// A call that is cancelled has seen nothing; one that is stopped has seen the step, as it gives an action.
TEST(PlansByMemory, OfACallThatIsCancelledIsAsIfThereWereNone) {
  const Pool pool = pool_of();
  Remembering r(drawn_agent(pool, kGru, 1));
  int32_t stops = 0;
  rdm_planner* late = nullptr;  // is cancelled while it plans
  const auto stop = [](void* user, int64_t) { return *static_cast<int32_t*>(user); };
  const auto cancel = [](void* user, int64_t) {
    rdm_planner_cancel(*static_cast<rdm_planner**>(user));
    return 0;
  };
  const Planner planner = planner_of(pool, r, kProposal),
                cancelled = planner_of(pool, r, kProposal, cancel, &late),
                stopped = planner_of(pool, r, kProposal, stop, &stops);
  const rdm_buffers b = buffers_of(pool.get());
  for (int step = 0; step < 9; ++step) {
    const auto before = state_of(cancelled);
    float none = 0;
    rdm_planner_cancel(cancelled.get());
    EXPECT_EQ(rdm_planner_act(cancelled.get(), pool.get(), 0, &none, nullptr), RDM_ERROR_CANCELLED);
    EXPECT_EQ(state_of(cancelled), before);
    late = cancelled.get();
    EXPECT_EQ(rdm_planner_act(cancelled.get(), pool.get(), 0, &none, nullptr), RDM_ERROR_CANCELLED);
    late = nullptr;
    EXPECT_EQ(state_of(cancelled), before);
    const float action = act(planner, pool);
    EXPECT_EQ(act(cancelled, pool), action);
    EXPECT_EQ(plan_of(cancelled), plan_of(planner));
    stops = step == 4;
    act(stopped, pool);
    if (step != 4) {
      EXPECT_EQ(plan_of(stopped), plan_of(planner)) << step;
    }
    b.action[0] = action;
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  }
}

// A critic of the same network as an actor, so that the actor's policy gives by public calls what the critic says.
struct Valued {
  Agent drawn, critic;
  Remembering actor;

  Valued(const Pool& pool, const std::string& settings)
      : drawn(drawn_agent(pool, settings, 3, 0.2f)), actor(drawn) {
    rdm_agent_config c;
    EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
    EXPECT_EQ(rdm_agent_config_for_pool(&c, pool.get()), RDM_OK);
    c.algo = "ppo_lag";
    c.settings = settings.c_str();
    critic = Agent(make_agent(c));
    rdm_tensor t;
    int32_t copied = 0;
    for (int32_t i = 0; rdm_agent_tensor_at(critic.get(), i, &t) == RDM_OK; ++i) {
      const std::string name = t.name, net = name.substr(0, name.find('.'));
      if (net != "reward_critic" && net != "cost_critic") continue;
      const std::string of = "actor" + name.substr(net.size());
      std::vector<float> values(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols));
      EXPECT_EQ(rdm_agent_get_tensor(drawn.get(), of.c_str(), values.data(), values.size()), RDM_OK) << of;
      EXPECT_EQ(rdm_agent_set_tensor(critic.get(), t.name, values.data(), values.size()), RDM_OK) << name;
      ++copied;
    }
    EXPECT_EQ(copied, 8);  // weights and biases of two layers, twice
  }
};

// The plan's sums in a copy of the only world, and what the critic says of its end: the state before step `at` of the
// episode is given, and the critic's agent decides each `hold`-th step.
struct Sums {
  double ret = 0, cost = 0, end = 0;
};
Sums sums_of(Valued& v, const Pool& pool, Row state, int32_t at, int32_t hold, const Row& plan) {
  const Pool copy = pool_of();
  EXPECT_EQ(rdm_pool_copy(copy.get(), 0, pool.get(), 0), RDM_OK);
  const rdm_buffers c = buffers_of(copy.get());
  Sums sums;
  for (size_t t = 0; t < plan.size(); ++t) {
    if ((at + static_cast<int32_t>(t)) % hold == 0) v.actor.act(c.obs, state);
    c.action[0] = plan[t];
    EXPECT_EQ(rdm_pool_step(copy.get()), RDM_OK);
    sums.ret += static_cast<double>(c.reward[0]);
    sums.cost += static_cast<double>(c.cost[0]);
    if (c.terminated[0] || c.truncated[0]) return sums;
  }
  sums.end = static_cast<double>(v.actor.act(c.obs, state)[0]);
  return sums;
}

TEST(ValuesByHistory, AreThoseOfACriticThatSawTheEpisode) {
  for (const int32_t hold : {1, 3})
    for (const int32_t autoreset : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP, RDM_AUTORESET_OFF}) {
      SCOPED_TRACE(::testing::Message() << "held " << hold << ", autoreset " << autoreset);
      const Pool pool = pool_of(autoreset);
      Valued v(pool, std::string(kHistory) + "\naction_repeat=" + std::to_string(hold));
      rdm_planner_config pc;
      ASSERT_EQ(rdm_planner_config_init(&pc, sizeof pc), RDM_OK);
      pc.pool = pool.get();
      pc.settings = "samples=3\nhorizon=2\ncosts=ignore\nterminal_cost=true\ndiscount=1\nnoise=0";
      pc.agent = v.critic.get();
      rdm_planner* made = nullptr;
      ASSERT_EQ(rdm_planner_create(&made, &pc), RDM_OK) << rdm_last_error();
      const Planner planner(made);
      const rdm_buffers b = buffers_of(pool.get());
      rdm::Stream stream(5, 0, rdm::Purpose::kTest);
      Row state = v.actor.fresh();
      int32_t at = 0, moved = 0, costly = 0;
      for (int step = 0; step < 36; ++step, ++at) {
        Row plan(2);
        for (float& a : plan) a = 0.3f * static_cast<float>(stream.signed_unit());
        ASSERT_EQ(rdm_planner_set_plan(planner.get(), plan.data()), RDM_OK);
        const auto saved = state_of(planner);
        const Sums wanted = sums_of(v, pool, state, at, hold, plan),
                   blind = sums_of(v, pool, v.actor.fresh(), at, hold, plan);
        if (at % hold == 0) v.actor.act(b.obs, state);
        auto info = RDM_INIT(rdm_plan_info);
        b.action[0] = act(planner, pool, &info);
        EXPECT_NEAR(info.ret, wanted.ret + wanted.end, 2e-6) << step;
        EXPECT_NEAR(info.cost[0], wanted.cost + std::max(wanted.end, 0.0), 2e-6) << step;
        moved += std::abs(blind.end - wanted.end) > 1e-3;
        costly += wanted.end > 0;
        // from the bytes before the call another planner does the same
        ASSERT_EQ(rdm_planner_create(&made, &pc), RDM_OK) << rdm_last_error();
        const Planner resumed(made);
        ASSERT_EQ(rdm_planner_read_state(resumed.get(), saved.data(), saved.size()), RDM_OK)
            << rdm_planner_error(resumed.get());
        act(resumed, pool);
        EXPECT_EQ(state_of(resumed), state_of(planner)) << step;
        ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
        if (!b.terminated[0] && !b.truncated[0]) continue;
        state = v.actor.fresh();
        at = -1;
        if (autoreset == RDM_AUTORESET_OFF) {
          ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
        } else if (autoreset == RDM_AUTORESET_NEXT_STEP) {
          ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
        }
      }
      EXPECT_GT(moved, 8);  // values hang on the history
      EXPECT_GT(costly, 3);
    }
}

TEST(PlansByMemory, TakesNothingFromTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the sanitizer counts";
  const Pool pool = pool_of(RDM_AUTORESET_SAME_STEP);
  Remembering r(drawn_agent(pool, kGru, 1));
  const Planner planner = planner_of(pool, r, "samples=4\nhorizon=6");
  const rdm_buffers b = buffers_of(pool.get());
  int64_t before = 0;
  for (int i = 0; i < 30; ++i) {
    if (i == 2) before = heap_count();
    b.action[0] = act(planner, pool);
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  }
  EXPECT_EQ(heap_count(), before);
}

}  // namespace

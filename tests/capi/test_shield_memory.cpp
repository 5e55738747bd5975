// Backups that remember, and agents that do, under a shield: against a shield written here of public calls alone, which
// copies worlds and states and looks ahead; a memory whose weights are 0 against none; ends of episodes in each
// autoreset mode; saved states; threads; no heap; what an agent remembers while a shield decides.
#include <cmath>
#include <functional>

#include "heap_count.hpp"
#include "remembering.hpp"
#include "shields.hpp"

namespace {

using Row = std::vector<float>;
constexpr size_t kWorlds = 5;
constexpr char kGru[] = "memory=gru:6\nhidden=8", kHistory[] = "history=4\nhidden=8";

Pool pool_of(const char* settings, int32_t autoreset, size_t envs = kWorlds, int32_t threads = 1) {
  rdm_pool_config c = pool_config(static_cast<int32_t>(envs));
  c.task = "lqr_line";
  c.settings = settings;
  c.autoreset = autoreset;
  c.num_threads = threads;
  c.seed = 4;
  Pool p(make_pool(c));
  EXPECT_EQ(rdm_pool_reset(p.get(), nullptr, nullptr), RDM_OK);
  return p;
}

// A shield of exact copies, no noise, no guards and no backups but policies, as lib/shield/shield.hpp has it, in one world.
class ByHand {
 public:
  struct Said {
    Row action;
    int32_t kind;
  };
  ByHand(std::vector<Remembering*> backups, const Pool& pool, double budget, int32_t steps, int32_t block)
      : backups_(std::move(backups)),
        copy_(pool_of(kSettings, RDM_AUTORESET_OFF, 1)),
        from_(pool),
        budget_(budget),
        steps_(steps),
        block_(block) {
    begin();
  }
  static constexpr char kSettings[] = "max_steps=13\nnoise=0.3\naction_scale=1";

  void begin() {  // an episode
    before_.clear();
    for (const Remembering* b : backups_) before_.push_back(b->fresh());
    plan_.clear();
    spent_ = 0;
  }
  void forget_memory() {
    for (size_t p = 0; p < backups_.size(); ++p) before_[p] = backups_[p]->fresh();
  }
  void spend(double cost) { spent_ += cost; }

  Said act(int32_t env, const Row& proposed) {
    Way way = run(env, {proposed}, 0, true);
    Said said{proposed, RDM_SHIELD_OWN};
    if (way.clean()) {
      plan_ = way.actions;
      dirty_ = false;
    } else if (!branch(env, way)) {
      said.kind = RDM_SHIELD_PLAN;
      if (plan_.empty()) least(env);
      said.action = plan_[0];
    } else if (refused_) {
      said = {plan_[0], RDM_SHIELD_CHANGED};
    }
    if (dirty_) said.kind = RDM_SHIELD_UNPROVEN;
    // what the policies have seen when the next decision comes
    const rdm_buffers b = buffers_of(from_.get());
    for (size_t p = 0; p < backups_.size(); ++p) backups_[p]->act(b.obs + env, before_[p]);
    said_plan_ = plan_;
    plan_.erase(plan_.begin());
    return said;
  }
  // As it was said, the present decision included.
  const std::vector<Row>& plan() const { return said_plan_; }

 private:
  struct Way {
    std::vector<Row> actions;
    int32_t fail = -1;
    double excess = 0;
    bool clean() const { return fail < 0; }
  };
  // These actions, then backup b, until the episode ends.
  Way run(int32_t env, const std::vector<Row>& first, size_t b, bool stop_at_cost) {
    EXPECT_EQ(rdm_pool_copy(copy_.get(), 0, from_.get(), env), RDM_OK) << rdm_pool_error(copy_.get());
    const rdm_buffers c = buffers_of(copy_.get());
    Row state = before_[b];
    double spent = spent_;
    const double bound = std::max(budget_, spent_);
    Way way;
    for (bool over = false; !over;) {
      Row action = backups_[b]->act(c.obs, state);  // it sees what is shown, whoever decides
      if (way.actions.size() < first.size()) action = first[way.actions.size()];
      way.actions.push_back(action);
      for (int32_t s = 0; s < steps_ && !over; ++s) {
        std::copy(action.begin(), action.end(), c.action);
        EXPECT_EQ(rdm_pool_step(copy_.get()), RDM_OK);
        spent += static_cast<double>(c.cost[0]);
        over = c.terminated[0] || c.truncated[0];
        if (way.fail < 0 && spent > bound + 1e-6) {
          way.fail = static_cast<int32_t>(way.actions.size()) - 1;
          over |= stop_at_cost;
        }
      }
    }
    way.excess = std::max(spent - bound, 0.0);
    return way;
  }
  // The backup's way that exceeds the budget least.
  void least(int32_t env) {
    double excess = 0;
    for (size_t b = 0; b < backups_.size(); ++b) {
      const Way way = run(env, {}, b, false);
      if (b > 0 && way.excess >= excess) continue;
      plan_ = way.actions;
      excess = way.excess;
    }
    dirty_ = true;
  }
  bool branch(int32_t env, const Way& way) {
    const int32_t top = std::min(way.fail, block_);
    for (int32_t back = 0;; back = back == 0 ? 1 : 2 * back) {
      const int32_t from = std::max(top - back, 0);
      for (size_t b = 0; b < backups_.size(); ++b) {
        const Way other = run(env, {way.actions.begin(), way.actions.begin() + from}, b, true);
        if (!other.clean()) continue;
        plan_ = other.actions;
        dirty_ = false;
        refused_ = from == 0;
        return true;
      }
      if (back >= top) return false;
    }
  }

  std::vector<Remembering*> backups_;
  Pool copy_;
  const Pool& from_;
  double budget_, spent_ = 0;
  int32_t steps_, block_;
  std::vector<Row> before_;
  std::vector<Row> plan_, said_plan_;
  bool dirty_ = false, refused_ = false;
};

// What a shield or the test says of each decision: its kind and the action.
struct Course {
  std::vector<int32_t> kinds;
  Row actions;
  std::vector<Row> plans;
  bool operator==(const Course& o) const {
    return kinds == o.kinds && actions == o.actions && plans == o.plans;
  }
  int64_t count(int32_t kind) const { return std::count(kinds.begin(), kinds.end(), kind); }
};

// Random proposals, drawn for each decision of each world; `decide` fills action [kWorlds] of the worlds in the mask;
// `began` is told of worlds in which an episode begins, `paid` of costs.
struct Play {
  const Pool& pool;
  int32_t autoreset, steps;
  rdm::Stream proposals{9, 0, rdm::Purpose::kTest};

  void go(int decisions, const std::function<void(const uint8_t*, const Row&, float*)>& decide,
          const std::function<void(size_t)>& began = {},
          const std::function<void(size_t, double)>& paid = {}) {
    const rdm_buffers b = buffers_of(pool.get());
    for (int d = 0; d < decisions; ++d) {
      uint8_t runs[kWorlds], goes[kWorlds];
      Row proposed(kWorlds);
      for (size_t i = 0; i < kWorlds; ++i) {
        proposed[i] = 0.45f * static_cast<float>(proposals.signed_unit());
        runs[i] = goes[i] = !(b.terminated[i] || b.truncated[i]) || autoreset == RDM_AUTORESET_SAME_STEP;
      }
      decide(runs, proposed, b.action);
      for (int32_t s = 0; s < steps; ++s) {
        ASSERT_EQ(rdm_pool_step_masked(pool.get(), goes), RDM_OK) << rdm_pool_error(pool.get());
        for (size_t i = 0; i < kWorlds; ++i) {
          if (!goes[i]) continue;
          const bool over = b.terminated[i] || b.truncated[i];
          if (paid) paid(i, static_cast<double>(b.cost[i]));
          goes[i] = !over;
          if (over && began) began(i);
        }
      }
      uint8_t ended[kWorlds];
      for (size_t i = 0; i < kWorlds; ++i) ended[i] = !runs[i] || b.terminated[i] || b.truncated[i];
      if (autoreset == RDM_AUTORESET_OFF) {
        ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, ended), RDM_OK);
      } else if (autoreset == RDM_AUTORESET_NEXT_STEP) {
        ASSERT_EQ(rdm_pool_step_masked(pool.get(), ended), RDM_OK);
      }
    }
  }
};

Course by_shield(const std::vector<const rdm_policy*>& backups, const char* settings, double budget,
                 int32_t autoreset, int32_t steps, int decisions, int32_t threads = 1, int restored_at = -1) {
  const Pool pool = pool_of(ByHand::kSettings, autoreset, kWorlds, threads);
  rdm_shield_config c = shield_config(pool, settings);
  c.budgets = &budget;
  c.steps = steps;
  c.policy = backups[0];
  c.num_threads = threads;
  const auto make = [&] {
    Shield s = shield_of(c);
    for (size_t i = 1; i < backups.size(); ++i)
      EXPECT_EQ(rdm_shield_add_policy(s.get(), backups[i]), RDM_OK) << rdm_shield_error(s.get());
    return s;
  };
  Shield shield = make();
  Course out;
  Play play{pool, autoreset, steps};
  int at = 0;
  play.go(decisions, [&](const uint8_t* runs, const Row& proposed, float* action) {
    if (at++ == restored_at) {  // another shield goes on from what was saved, in worlds that were too
      const auto state = state_of(shield);
      size_t n = 0;
      ASSERT_EQ(rdm_pool_write_state(pool.get(), -1, nullptr, 0, &n), RDM_OK);
      std::vector<unsigned char> worlds(n);
      ASSERT_EQ(rdm_pool_write_state(pool.get(), -1, worlds.data(), n, &n), RDM_OK);
      ASSERT_EQ(rdm_pool_read_state(pool.get(), -1, worlds.data(), n), RDM_OK);
      shield = make();
      ASSERT_EQ(rdm_shield_read_state(shield.get(), state.data(), state.size()), RDM_OK)
          << rdm_shield_error(shield.get());
      EXPECT_EQ(state_of(shield), state);
    }
    ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), runs, proposed.data(), action), RDM_OK)
        << rdm_shield_error(shield.get());
    for (size_t i = 0; i < kWorlds; ++i) {
      if (!runs[i]) continue;
      const auto env = static_cast<int32_t>(i);
      out.kinds.push_back(row_of(shield, pool, env).kind);
      out.actions.push_back(action[i]);
      Row plan(64);
      size_t size = 0;
      ASSERT_EQ(rdm_shield_get_plan(shield.get(), pool.get(), env, plan.data(), plan.size(), &size), RDM_OK);
      plan.resize(size);
      out.plans.push_back(plan);
    }
  });
  return out;
}

Course by_hand(const std::vector<Remembering*>& backups, double budget, int32_t autoreset, int32_t steps,
               int32_t block, int decisions, bool forgets = false) {
  const Pool pool = pool_of(ByHand::kSettings, autoreset);
  std::vector<ByHand> hands;
  for (size_t i = 0; i < kWorlds; ++i) hands.emplace_back(backups, pool, budget, steps, block);
  Course out;
  Play play{pool, autoreset, steps};
  play.go(
      decisions,
      [&](const uint8_t* runs, const Row& proposed, float* action) {
        for (size_t i = 0; i < kWorlds; ++i) {
          if (!runs[i]) continue;
          if (forgets) hands[i].forget_memory();
          const ByHand::Said said = hands[i].act(static_cast<int32_t>(i), {proposed[i]});
          action[i] = said.action[0];
          out.kinds.push_back(said.kind);
          out.actions.push_back(action[i]);
          Row plan;
          for (const Row& a : hands[i].plan()) plan.push_back(a[0]);
          out.plans.push_back(plan);
        }
      },
      [&](size_t i) { hands[i].begin(); }, [&](size_t i, double cost) { hands[i].spend(cost); });
  return out;
}

constexpr char kPlain[] = "zero=false\nhold=false\nproject=false\nunproven=least\nnoise=0\nrounds=8\n";

void expect_same(const Course& a, const Course& b) {
  EXPECT_EQ(a.kinds, b.kinds);
  EXPECT_EQ(a.actions, b.actions);
  EXPECT_EQ(a.plans, b.plans);
}

// Every verdict, action and plan, over many episodes.
TEST(ShieldMemory, DecidesAsAShieldOfPublicCallsDoes) {
  const Pool pool = pool_of(ByHand::kSettings, RDM_AUTORESET_OFF);
  for (const int32_t steps : {1, 2}) {
    const std::string repeat = "\naction_repeat=" + std::to_string(steps);
    Remembering gru(drawn_agent(pool, kGru + repeat, 1)),
        history(drawn_agent(pool, kHistory + repeat, 2, 0.5f)),
        plain(drawn_agent(pool, "hidden=8" + repeat, 3, 0.5f));
    ASSERT_EQ(gru.info.state_dim, 6);
    ASSERT_EQ(history.info.state_dim, 3);
    for (const auto& backups : {std::vector<Remembering*>{&gru}, std::vector<Remembering*>{&history},
                                std::vector<Remembering*>{&history, &plain, &gru}})
      for (const int32_t block : {1, 4})
        for (const int32_t autoreset :
             {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP, RDM_AUTORESET_OFF}) {
          SCOPED_TRACE(::testing::Message()
                       << steps << " steps, " << backups.size() << " backups, state "
                       << backups[0]->info.state_dim << ", block " << block << ", autoreset " << autoreset);
          std::vector<const rdm_policy*> policies;
          for (const Remembering* b : backups) policies.push_back(b->policy.get());
          const std::string settings = kPlain + ("block=" + std::to_string(block));
          const double budget = steps == 2 ? 0.6 : backups[0] == &gru ? 0.35 : 0.5;
          const Course hand = by_hand(backups, budget, autoreset, steps, block, 60);
          expect_same(by_shield(policies, settings.c_str(), budget, autoreset, steps, 60), hand);
          // something is decided of each kind, and by what the backups remember
          EXPECT_GT(hand.count(RDM_SHIELD_OWN), 10);
          EXPECT_GT(hand.count(RDM_SHIELD_CHANGED) + hand.count(RDM_SHIELD_PLAN), 10);
          EXPECT_FALSE(by_hand(backups, budget, autoreset, steps, block, 60, true) == hand);
        }
  }
}

TEST(ShieldMemory, GivesTheSameBytesForAnyThreadsAndAfterASavedState) {
  const Pool pool = pool_of(ByHand::kSettings, RDM_AUTORESET_OFF);
  for (const char* kind : {kGru, kHistory}) {
    Remembering r(drawn_agent(pool, kind, 1));
    const std::vector<const rdm_policy*> backups{r.policy.get()};
    for (const int32_t autoreset : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP, RDM_AUTORESET_OFF}) {
      const char* settings = "unproven=least\nblock=4\nnoise=0.3";
      const Course one = by_shield(backups, settings, 0.35, autoreset, 1, 40);
      expect_same(by_shield(backups, settings, 0.35, autoreset, 1, 40, 3), one);
      // in the middle of an episode, and where worlds have just begun one (13 steps)
      for (const int at : {1, 6, 13, 14, 26}) {
        SCOPED_TRACE(at);
        expect_same(by_shield(backups, settings, 0.35, autoreset, 1, 40, 1, at), one);
      }
    }
  }
}

// A state that is saved where one episode has ended and another begun: what is left of the old plan is none of the new one.
TEST(ShieldMemory, TakesNoPlanOfAnotherEpisodeFromASavedState) {
  const Pool pool = pool_of(ByHand::kSettings, RDM_AUTORESET_SAME_STEP);
  rdm_shield_config c = shield_config(pool);
  const double budget = 0.35;
  c.budgets = &budget;
  const Shield shield = shield_of(c);
  const rdm_buffers b = buffers_of(pool.get());
  const auto planned = [&](const Shield& s) {
    size_t size = 0;
    EXPECT_EQ(rdm_shield_get_plan(s.get(), pool.get(), 0, nullptr, 0, &size), RDM_OK);
    return size;
  };
  const Row zero(kWorlds);
  for (int step = 0; step < 13; ++step) {
    ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, zero.data(), b.action), RDM_OK);
    const Shield now = shield_of(c);
    const auto state = state_of(shield);
    ASSERT_EQ(rdm_shield_read_state(now.get(), state.data(), state.size()), RDM_OK);
    EXPECT_EQ(planned(now), 13u - static_cast<size_t>(step));
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  }
  ASSERT_TRUE(b.truncated[0]);
  const Shield restored = shield_of(c);
  const auto state = state_of(shield);
  ASSERT_EQ(rdm_shield_read_state(restored.get(), state.data(), state.size()), RDM_OK);
  EXPECT_EQ(planned(shield), 0u);
  EXPECT_EQ(planned(restored), 0u);
}

// Whoever plays by the policy has the state that the shield has: as the plan goes on by that policy, an episode is asked
// about once. With a state that is wrong by one decision it would be asked about in each.
TEST(ShieldMemory, HasTheStateOfAnActorThatPlaysByThePolicy) {
  for (const int32_t autoreset : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_OFF})
    for (const char* kind : {kGru, kHistory}) {
      const Pool pool = pool_of("max_steps=10", autoreset);
      Remembering r(drawn_agent(pool, kind, 1));
      rdm_shield_config c = shield_config(pool, "block=1");
      const double budget = 1e9;
      c.budgets = &budget;
      c.policy = r.policy.get();
      const Shield shield = shield_of(c);
      rdm_actor_config ac;
      ASSERT_EQ(rdm_actor_config_init(&ac, sizeof ac), RDM_OK);
      ac.policy = r.policy.get();
      ac.num_envs = kWorlds;
      rdm_actor* made = nullptr;
      ASSERT_EQ(rdm_actor_create(&made, &ac), RDM_OK);
      const Actor actor(made);
      const rdm_buffers b = buffers_of(pool.get());
      for (int step = 0; step < 30; ++step) {
        ASSERT_EQ(rdm_actor_act(actor.get(), b.obs, nullptr, nullptr, b.action), RDM_OK);
        ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
        // to be asked again in the same decision, as after a failure, changes nothing
        ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
        ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
        uint8_t ended[kWorlds];
        for (size_t i = 0; i < kWorlds; ++i) ended[i] = b.terminated[i] || b.truncated[i];
        ASSERT_EQ(rdm_actor_reset(actor.get(), ended, nullptr), RDM_OK);
        if (autoreset == RDM_AUTORESET_OFF) {
          ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, ended), RDM_OK);
        }
      }
      EXPECT_EQ(stats_of(shield).inquiries, 3 * static_cast<int64_t>(kWorlds)) << kind;
      // after rdm_shield_reset it remembers nothing, as of an episode that begins: the actor does
      ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
      ASSERT_EQ(rdm_actor_reset(actor.get(), nullptr, nullptr), RDM_OK);
      int64_t asked = 0;
      for (int step = 0; step < 5; ++step) {
        ASSERT_EQ(rdm_actor_act(actor.get(), b.obs, nullptr, nullptr, b.action), RDM_OK);
        if (step == 2) {
          ASSERT_EQ(rdm_shield_reset(shield.get(), nullptr), RDM_OK);
        }
        if (step == 3) asked = stats_of(shield).inquiries;
        ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
        ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
      }
      EXPECT_GT(stats_of(shield).inquiries, asked) << kind;
    }
}

// Entries of a history whose weights are 0 are no memory: the same verdicts and actions.
TEST(ShieldMemory, OfWeightsOfZeroIsNone) {
  const Pool pool = pool_of(ByHand::kSettings, RDM_AUTORESET_OFF);
  const Agent plain = drawn_agent(pool, "hidden=8", 2, 0.5f), deep = drawn_agent(pool, kHistory, 5, 0.5f);
  rdm_tensor t, wide;
  for (int32_t i = 0; rdm_agent_tensor_at(plain.get(), i, &t) == RDM_OK; ++i) {
    const std::string name = t.name;
    if (name.rfind("actor.", 0) != 0) continue;
    ASSERT_EQ(rdm_agent_tensor_at(deep.get(), i, &wide), RDM_OK);
    ASSERT_EQ(name, wide.name);
    const auto rows = static_cast<size_t>(t.rows), cols = static_cast<size_t>(t.cols),
               more = static_cast<size_t>(wide.cols);
    Row from(rows * cols), to(rows * more);
    ASSERT_EQ(rdm_agent_get_tensor(plain.get(), t.name, from.data(), from.size()), RDM_OK);
    for (size_t r = 0; r < rows; ++r) std::copy_n(&from[r * cols], cols, &to[r * more]);
    ASSERT_EQ(rdm_agent_set_tensor(deep.get(), t.name, to.data(), to.size()), RDM_OK);
  }
  Remembering none(plain), zero(deep);
  ASSERT_EQ(none.info.state_dim, 0);
  ASSERT_EQ(zero.info.state_dim, 3);
  for (const char* settings : {"unproven=least\nblock=4", "unproven=least\nblock=4\ncopies=2"}) {
    const Course a = by_shield({none.policy.get()}, settings, 0.35, RDM_AUTORESET_SAME_STEP, 1, 40),
                 b = by_shield({zero.policy.get()}, settings, 0.35, RDM_AUTORESET_SAME_STEP, 1, 40);
    expect_same(b, a);
    EXPECT_GT(a.count(RDM_SHIELD_OWN), 10);
    EXPECT_LT(a.count(RDM_SHIELD_OWN), static_cast<int64_t>(a.kinds.size()) - 10);
  }
}

TEST(ShieldMemory, TakesNothingFromTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the sanitizer counts";
  const Pool pool = pool_of(ByHand::kSettings, RDM_AUTORESET_SAME_STEP);
  Remembering gru(drawn_agent(pool, kGru, 1)), history(drawn_agent(pool, kHistory, 2));
  rdm_shield_config c = shield_config(pool, "unproven=least");
  const double budget = 0.35;
  c.budgets = &budget;
  c.policy = gru.policy.get();
  const Shield shield = shield_of(c);
  ASSERT_EQ(rdm_shield_add_policy(shield.get(), history.policy.get()), RDM_OK);
  const rdm_buffers b = buffers_of(pool.get());
  int64_t before = 0;
  for (int i = 0; i < 40; ++i) {
    if (i == 3) before = heap_count();
    ASSERT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  }
  EXPECT_EQ(heap_count(), before);
  // nor do an agent's rollouts after the first one, with a backup that remembers beside the agent
  for (const char* kind : {kGru, kHistory}) {
    const Agent agent = drawn_agent(pool, std::string(kind) + "\nhorizon=20", 1);
    ASSERT_EQ(rdm_agent_set_shield(agent.get(), shield.get()), RDM_OK);
    for (int i = 0; i < 4; ++i) {
      if (i == 1) before = heap_count();
      ASSERT_EQ(rdm_agent_rollout(agent.get(), pool.get(), nullptr), RDM_OK) << rdm_agent_error(agent.get());
    }
    EXPECT_EQ(heap_count(), before) << kind;
  }
}

// A plan of a host ends before the episode; the backup that goes on behind it has seen what came before.
TEST(ShieldMemory, GoesOnBehindAPlanOfAHost) {
  const Pool pool = pool_of(ByHand::kSettings, RDM_AUTORESET_OFF);
  for (const char* kind : {kGru, kHistory}) {
    Remembering r(drawn_agent(pool, kind, 1));
    rdm_shield_config c = shield_config(pool, kPlain);
    const double budget = 1e9;
    c.budgets = &budget;
    c.policy = r.policy.get();
    const Shield shield = shield_of(c);
    ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
    const Pool copy = pool_of(ByHand::kSettings, RDM_AUTORESET_OFF, 1);
    const rdm_buffers b = buffers_of(pool.get()), m = buffers_of(copy.get());
    Row state = r.fresh();
    for (int step = 0; step < 5; ++step) {
      if (step == 3) {  // before the shield is asked in this decision, and in the other case after
        const Row three{0.3f, -0.2f, 0.1f};
        ASSERT_EQ(rdm_shield_set_plan(shield.get(), pool.get(), 1, three.data(), 3), RDM_OK);
        Row plan(64);
        size_t size = 0;
        ASSERT_EQ(rdm_shield_get_plan(shield.get(), pool.get(), 1, plan.data(), plan.size(), &size), RDM_OK);
        ASSERT_EQ(size, 10u);
        ASSERT_EQ(rdm_pool_copy(copy.get(), 0, pool.get(), 1), RDM_OK);
        Row walked = state;
        for (size_t d = 0; d < size; ++d) {
          const Row own = r.act(m.obs, walked);
          EXPECT_EQ(plan[d], d < 3 ? three[d] : own[0]) << d;
          m.action[0] = plan[d];
          ASSERT_EQ(rdm_pool_step(copy.get()), RDM_OK);
        }
      }
      std::fill_n(b.action, kWorlds, 0.1f);
      ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
      r.act(b.obs + 1, state);
      ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    }
  }
}

// ---- agents that remember, training under a shield

constexpr char kSmall[] = "\nhorizon=16\nnormalize_obs=false";

struct Learned {
  std::vector<unsigned char> policy;
  uint64_t worlds = 0;
  int64_t refused = 0;
};
Learned learn(const std::string& agent_settings, const char* shield_settings, double budget, int epochs,
              int32_t autoreset = RDM_AUTORESET_SAME_STEP) {
  const Pool pool = pool_of(ByHand::kSettings, autoreset);
  const Agent agent = drawn_agent(pool, agent_settings, 1, 0.5f);
  Shield shield;
  if (shield_settings) {
    rdm_shield_config c = shield_config(pool, shield_settings);
    c.budgets = &budget;
    shield = shield_of(c);
    EXPECT_EQ(rdm_agent_set_shield(agent.get(), shield.get()), RDM_OK) << rdm_agent_error(agent.get());
  }
  Learned out;
  auto e = RDM_INIT(rdm_epoch);
  for (int i = 0; i < epochs; ++i) {
    EXPECT_EQ(rdm_agent_rollout(agent.get(), pool.get(), &e), RDM_OK) << rdm_agent_error(agent.get());
    out.refused += e.refused;
  }
  out.policy = policy_bytes(agent.get());
  out.worlds = hash_of(pool.get());
  return out;
}

// In blocks what copies foresee is executed: with another memory than the agent's it would be something else.
TEST(ShieldMemory, ForeseesWhatAnAgentThatRemembersWillDo) {
  for (const char* kind :
       {kGru, kHistory, "memory=gru:6\nhidden=8\nstd_mode=state\nlearn_std=true\nstd_schedule=none",
        "history=3\nhidden=8\nnoise_correlation=0.7", "memory=gru:3\nhidden=\naverage=0.9"})
    for (const int32_t autoreset : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP}) {
      SCOPED_TRACE(kind);
      const std::string settings = std::string(kind) + kSmall;
      const Learned free = learn(settings, nullptr, 0, 3, autoreset);
      for (const char* block : {"block=1", "block=5", "block=16"}) {
        const Learned shielded = learn(settings, block, 1e9, 3, autoreset);
        EXPECT_EQ(shielded.refused, 0);
        EXPECT_EQ(shielded.policy, free.policy) << block;
        EXPECT_EQ(shielded.worlds, free.worlds) << block;
      }
    }
}

// Nearly without noise, so that what it does next says what it remembers: followed here by public calls.
TEST(ShieldMemory, AnAgentRemembersWhatItsWorldsShowedWhateverTheShieldDoes) {
  for (const char* kind : {kGru, kHistory})
    for (const char* how : {"own", "applied", "cost", "end"})
      for (const int32_t autoreset : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP}) {
        SCOPED_TRACE(::testing::Message() << kind << ", " << how << ", autoreset " << autoreset);
        const Pool pool = pool_of(ByHand::kSettings, autoreset);
        const std::string settings = std::string(kind) +
                                     "\nhorizon=1\nnormalize_obs=false\ninit_std=0.001\nstd_min=0.0005\n" +
                                     "learn_std=false\nshield_learn=" + how;
        const Agent agent = drawn_agent(pool, settings, 1), twin = drawn_agent(pool, settings, 1);
        rdm_shield_config c = shield_config(pool, "unproven=least\nblock=4");
        // where refusals end episodes there is less to remember
        const double budget = std::strcmp(how, "end") == 0 ? 1.5 : 0.35;
        c.budgets = &budget;
        const Shield shield = shield_of(c);
        ASSERT_EQ(rdm_agent_set_shield(agent.get(), shield.get()), RDM_OK);
        const rdm_buffers b = buffers_of(pool.get());
        std::vector<Row> state;
        int64_t refused = 0;
        float furthest = 0;
        auto e = RDM_INIT(rdm_epoch);
        for (int d = 0; d < 50; ++d) {
          Remembering now(agent);
          if (state.empty()) state.assign(kWorlds, now.fresh());
          // what it does in this decision
          size_t n = 0;
          ASSERT_EQ(rdm_agent_write_state(agent.get(), nullptr, 0, &n), RDM_OK);
          std::vector<unsigned char> bytes(n);
          ASSERT_EQ(rdm_agent_write_state(agent.get(), bytes.data(), n, &n), RDM_OK);
          ASSERT_EQ(rdm_agent_read_state(twin.get(), bytes.data(), n), RDM_OK) << rdm_agent_error(twin.get());
          Row action(kWorlds);
          ASSERT_EQ(rdm_agent_act(twin.get(), b.obs, RDM_ACT_SAMPLE, action.data()), RDM_OK);
          for (size_t i = 0; i < kWorlds; ++i) {
            Row fresh = now.fresh();
            const float own = now.act(b.obs + i, state[i])[0];
            EXPECT_NEAR(std::clamp(action[i], -1.0f, 1.0f), own, 0.01) << "decision " << d << ", world " << i;
            furthest = std::max(furthest, std::abs(own - now.act(b.obs + i, fresh)[0]));
          }
          ASSERT_EQ(rdm_agent_rollout(agent.get(), pool.get(), &e), RDM_OK) << rdm_agent_error(agent.get());
          refused += e.refused;
          for (size_t i = 0; i < kWorlds; ++i)
            if (b.terminated[i] || b.truncated[i] || b.episode_step[i] == 0) state[i] = now.fresh();
        }
        EXPECT_GT(refused, 10);
        EXPECT_GT(furthest, 0.1);
      }
}

// The largest difference of the actors' parameters.
float apart(const Agent& a, const Agent& b) {
  float most = 0;
  rdm_tensor t;
  for (int32_t i = 0; rdm_agent_tensor_at(a.get(), i, &t) == RDM_OK; ++i) {
    if (std::string(t.name).rfind("actor.", 0) != 0) continue;
    Row x(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols)), y(x.size());
    EXPECT_EQ(rdm_agent_get_tensor(a.get(), t.name, x.data(), x.size()), RDM_OK);
    EXPECT_EQ(rdm_agent_get_tensor(b.get(), t.name, y.data(), y.size()), RDM_OK);
    for (size_t j = 0; j < x.size(); ++j) most = std::max(most, std::abs(x[j] - y[j]));
  }
  return most;
}

// What was executed is what is learned from: an agent that is handed the same decisions learns the same, up to the rounding
// in which a sample is replaced; one that has forgotten once does not. One pass, since ratios of probabilities that a second
// one clips may lie on either side of the bound.
TEST(ShieldMemory, AnAgentLearnsFromWhatWasApplied) {
  for (const char* kind : {kGru, kHistory}) {
    SCOPED_TRACE(kind);
    const Pool pool = pool_of(ByHand::kSettings, RDM_AUTORESET_SAME_STEP);
    const std::string settings =
        std::string(kind) + "\nhorizon=1\npasses=1\nshield_learn=applied\ninit_std=0.1";
    const Agent agent = drawn_agent(pool, settings, 1), handed = drawn_agent(pool, settings, 1),
                lost = drawn_agent(pool, settings, 1);
    rdm_shield_config c = shield_config(pool, "unproven=least\nblock=4");
    const double budget = 0.35;
    c.budgets = &budget;
    const Shield shield = shield_of(c);
    ASSERT_EQ(rdm_agent_set_shield(agent.get(), shield.get()), RDM_OK);
    const rdm_buffers b = buffers_of(pool.get());
    auto e = RDM_INIT(rdm_epoch);
    int64_t refused = 0;
    for (int d = 0; d < 18; ++d) {  // an episode has 13
      const Row obs(b.obs, b.obs + kWorlds);
      ASSERT_EQ(rdm_agent_rollout(agent.get(), pool.get(), &e), RDM_OK) << rdm_agent_error(agent.get());
      refused += e.refused;
      auto t = RDM_INIT(rdm_transition);
      t.reward = b.reward;
      t.cost = b.cost;
      t.terminated = b.terminated;
      t.truncated = b.truncated;
      t.final_obs = b.final_obs;
      if (d == 5) {
        ASSERT_EQ(rdm_agent_forget(lost.get(), RDM_ACT_SAMPLE, nullptr), RDM_OK);
      }
      for (const Agent* a : {&handed, &lost}) {
        ASSERT_EQ(rdm_agent_put(a->get(), obs.data(), b.action, &t), RDM_OK) << rdm_agent_error(a->get());
        ASSERT_EQ(rdm_agent_update(a->get(), b.obs, &e), RDM_OK) << rdm_agent_error(a->get());
      }
      ASSERT_LT(apart(handed, agent), 2e-6f) << d;
    }
    EXPECT_GT(apart(lost, agent), 5e-4f);
    EXPECT_GT(refused, 10);
  }
}

}  // namespace

// Guards, rdm_project and shields that project: a cost of the action alone is 0 whatever is proposed and while an agent
// learns; what keeps the guards goes through to the bit; a host's own, per world; beside prediction; each refusal.
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "heap_count.hpp"
#include "shields.hpp"

namespace {

Pool pool_of(const char* task, const char* settings = "", int32_t envs = 6) {
  rdm_pool_config c = pool_config(envs);
  c.task = task;
  c.settings = settings;
  c.seed = 3;
  Pool p(make_pool(c));
  EXPECT_EQ(rdm_pool_reset(p.get(), nullptr, nullptr), RDM_OK);
  return p;
}
Shield shield_of(const Pool& pool, const char* settings, const double* budgets = nullptr, int32_t steps = 0) {
  rdm_shield_config c = shield_config(pool, settings);
  c.budgets = budgets;
  c.steps = steps;
  return shield_of(c);
}
constexpr char kProject[] = "predict=false";

size_t width_of(const Pool& pool) {
  return static_cast<size_t>(spec_of(pool.get()).action_dim);
}
std::vector<rdm_guard> guards_of(const Pool& pool) {
  std::vector<rdm_guard> out;
  auto g = RDM_INIT(rdm_guard);
  std::vector<float> normal(width_of(pool));
  while (rdm_pool_guard_at(pool.get(), static_cast<int32_t>(out.size()), &g, normal.data()) == RDM_OK) {
    out.push_back(g);
    EXPECT_NE(normal[static_cast<size_t>(g.entry)], 0);
  }
  EXPECT_EQ(rdm_pool_guard_at(pool.get(), static_cast<int32_t>(out.size()), &g, nullptr), RDM_ERROR_RANGE);
  return out;
}

// Steps under random actions, also beyond the box, and looked at where there is a shield; the sum of a cost.
double play(const Pool& pool, const Shield& shield, int32_t steps, size_t column = 0, size_t envs = 6) {
  const rdm_buffers b = buffers_of(pool.get());
  const auto costs = static_cast<size_t>(spec_of(pool.get()).cost_dim);
  double sum = 0;
  for (int32_t i = 0; i < steps; ++i) {
    EXPECT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_RANDOM), RDM_OK);
    for (size_t j = 0; j < envs * width_of(pool); j += 7) b.action[j] *= 1.5f;
    if (shield) {
      EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK)
          << rdm_shield_error(shield.get());
    }
    EXPECT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    for (size_t e = 0; e < envs; ++e) sum += static_cast<double>(b.cost[e * costs + column]);
  }
  return sum;
}

TEST(Guards, AreDeclaredWhereACommandIsTheAction) {
  const auto count = [](const char* task, const char* settings, int32_t column) {
    int32_t n = 0;
    for (const rdm_guard& g : guards_of(pool_of(task, settings, 1))) n += g.column == column;
    return n;
  };
  EXPECT_EQ(count("hand_over_safe_finger", "cost_mode=command", 0), 6);
  EXPECT_EQ(count("hand_over_safe_finger", "cost_mode=command", 1), 2);
  EXPECT_EQ(count("hand_over_safe_joint", "cost_mode=command", 0), 2);
  EXPECT_EQ(count("catch_underarm_safe_finger", "cost_mode=command\naction_repeat=4", 0), 6);
  EXPECT_EQ(count("catch_underarm_safe_finger", "cost_mode=literal", 0), 6);
  EXPECT_EQ(count("catch_underarm_safe_joint", "cost_mode=literal", 0), 2);
  // the released column 0 looks at the action as it was given
  EXPECT_EQ(count("catch_underarm_safe_joint", "cost_mode=literal\naction_average=0.5", 0), 2);
  EXPECT_EQ(count("catch_underarm_safe_joint", "cost_mode=literal\naction_average=0.5", 1), 0);
  for (const char* settings : {"cost_mode=angle", "cost_mode=command\naction_average=0.5",
                               "cost_mode=command\ncontrol=velocity", "cost_mode=command\ncontrol=torque",
                               "cost_mode=command\naction_delay=1", "cost_mode=command\naction_delay=0..2"})
    EXPECT_EQ(count("hand_over_safe_finger", settings, 0), 0) << settings;
  EXPECT_TRUE(guards_of(pool_of("hand_over_wall", "", 1)).empty());

  const Pool pool = pool_of("hand_over_safe_joint", "cost_mode=command", 1);
  const auto rows = guards_of(pool);
  EXPECT_EQ(rows[0].column, 0);
  EXPECT_EQ(rows[0].entry, rows[1].entry);
  EXPECT_EQ(rows[0].bound, 0.5f);
  EXPECT_EQ(rows[1].bound, 0.5f);
}

TEST(Guards, KeepTheirCostAt0WhateverIsProposed) {
  for (const auto& [task, settings] :
       {std::pair{"hand_over_safe_finger", "cost_mode=command"},
        std::pair{"hand_over_safe_finger",
                  "cost_mode=command\nwindow.ff2.low=31.7\nwindow.ff3.high=33.3\nwindow.ff4.low=-3.3"},
        std::pair{"hand_over_safe_joint", "cost_mode=command\naction_repeat=3"},
        std::pair{"hand_over_safe_finger", "cost_mode=command\nhand=allegro"},
        std::pair{"catch_underarm_safe_finger", "cost_mode=command"},
        std::pair{"catch_underarm_safe_finger", "cost_mode=literal"},
        std::pair{"catch_underarm_safe_joint", "cost_mode=literal\naction_average=0.4"}}) {
    const Pool free = pool_of(task, settings), pool = pool_of(task, settings);
    EXPECT_GT(play(free, {}, 90), 0) << task << '\n' << settings;
    const Shield shield = shield_of(pool, kProject);
    EXPECT_EQ(play(pool, shield, 90), 0) << task << '\n' << settings;
    const rdm_shield_stats s = stats_of(shield);
    EXPECT_EQ(s.decisions, 6 * 90);
    EXPECT_GT(s.projected, 0);
    EXPECT_EQ(s.copied, 0);
    EXPECT_EQ(s.inquiries, 0);
  }
}

TEST(Guards, AreThoseOfCostsWhoseBudgetIs0) {
  const Pool pool = pool_of("hand_over_safe_finger", "cost_mode=command");
  std::vector<double> budgets(static_cast<size_t>(spec_of(pool.get()).cost_dim), -1);
  budgets[1] = 0;
  const Shield second = shield_of(pool, kProject, budgets.data());
  EXPECT_EQ(play(pool, second, 60, 1), 0);
  EXPECT_GT(play(pool, second, 60, 0), 0);
  budgets[1] = 5;  // may be spent
  const Shield none = shield_of(pool, kProject, budgets.data());
  const rdm_buffers b = buffers_of(pool.get());
  EXPECT_EQ(rdm_shield_act(none.get(), pool.get(), nullptr, b.action, b.action), RDM_ERROR_STATE);
  EXPECT_NE(std::strstr(rdm_shield_error(none.get()), "predict=false"), nullptr);
}

TEST(Guards, LetThroughToTheBitWhatKeepsThem) {
  const Pool pool = pool_of("hand_over_safe_finger", "cost_mode=command", 2);
  const Shield shield = shield_of(pool, kProject);
  const size_t dim = width_of(pool);
  std::vector<float> proposed(2 * dim, 0.25f), out(2 * dim);
  proposed[dim - 1] = 1.75f;  // the pool clips it
  proposed[dim - 2] = -0.0f;
  const auto rows = guards_of(pool);
  proposed[static_cast<size_t>(rows[0].entry)] = rows[0].bound;
  proposed[dim + static_cast<size_t>(rows[0].entry)] = std::nextafter(rows[0].bound, 2.0f);
  ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, proposed.data(), out.data()), RDM_OK);
  EXPECT_EQ(std::memcmp(out.data(), proposed.data(), dim * sizeof(float)), 0);
  EXPECT_EQ(row_of(shield, pool, 0).kind, RDM_SHIELD_OWN);
  EXPECT_EQ(row_of(shield, pool, 0).column, -1);
  EXPECT_EQ(out[dim + static_cast<size_t>(rows[0].entry)], rows[0].bound);
  EXPECT_EQ(row_of(shield, pool, 1).kind, RDM_SHIELD_PROJECTED);
  EXPECT_EQ(row_of(shield, pool, 1).column, 0);
  EXPECT_EQ(row_of(shield, pool, 1).planned, 0);
  EXPECT_EQ(stats_of(shield).projected, 1);
}

// As of a learned model c(s) + g(s) . a <= d.
TEST(Guards, OfAHostAreEachWorldsOwn) {
  const Pool pool = pool_of("hand_over_wall", "", 3);
  const Shield shield = shield_of(pool, kProject);
  const size_t dim = width_of(pool);
  std::vector<float> normal(dim), proposed(3 * dim, 0.5f), out(3 * dim), expected(dim);
  for (size_t j = 0; j < dim; ++j) normal[j] = j % 3 == 0 ? 0.25f * static_cast<float>(j + 1) : -0.5f;
  ASSERT_EQ(rdm_shield_add_guard(shield.get(), normal.data(), 1), RDM_OK);
  std::vector<float> other(dim, 0.0f);
  other[4] = other[9] = 1;
  ASSERT_EQ(rdm_shield_set_guard(shield.get(), 1, 0, other.data(), 0.25f), RDM_OK);
  ASSERT_EQ(rdm_shield_set_guard(shield.get(), 2, 0, other.data(), 7), RDM_OK);
  const auto act = [&] {
    return rdm_shield_act(shield.get(), pool.get(), nullptr, proposed.data(), out.data());
  };
  ASSERT_EQ(act(), RDM_OK);
  const float one = 1, quarter = 0.25f;
  ASSERT_EQ(rdm_project(normal.data(), &one, 1, dim, proposed.data(), expected.data()), RDM_OK);
  EXPECT_EQ(std::memcmp(out.data(), expected.data(), dim * sizeof(float)), 0);
  ASSERT_EQ(rdm_project(other.data(), &quarter, 1, dim, proposed.data(), expected.data()), RDM_OK);
  EXPECT_EQ(std::memcmp(out.data() + dim, expected.data(), dim * sizeof(float)), 0);
  EXPECT_FLOAT_EQ(out[dim + 4], 0.125f);
  EXPECT_EQ(std::memcmp(out.data() + 2 * dim, proposed.data(), dim * sizeof(float)), 0);
  EXPECT_EQ(row_of(shield, pool, 1).kind, RDM_SHIELD_PROJECTED);
  EXPECT_EQ(row_of(shield, pool, 1).column, -1);
  EXPECT_EQ(row_of(shield, pool, 2).kind, RDM_SHIELD_OWN);

  // what cannot be kept is refused, and what was stays
  EXPECT_EQ(rdm_shield_set_guard(shield.get(), 1, 0, other.data(), -2.5f), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(rdm_shield_error(shield.get()), "world 1"), nullptr);
  const auto before = out;
  ASSERT_EQ(act(), RDM_OK);
  EXPECT_EQ(out, before);

  // they are state
  const auto state = state_of(shield);
  const Shield resumed = shield_of(pool, kProject);
  EXPECT_EQ(rdm_shield_read_state(resumed.get(), state.data(), state.size()), RDM_ERROR_FORMAT);
  ASSERT_EQ(rdm_shield_add_guard(resumed.get(), other.data(), 0), RDM_OK);
  ASSERT_EQ(rdm_shield_read_state(resumed.get(), state.data(), state.size()), RDM_OK)
      << rdm_shield_error(resumed.get());
  EXPECT_EQ(state_of(resumed), state);
  ASSERT_EQ(rdm_shield_act(resumed.get(), pool.get(), nullptr, proposed.data(), out.data()), RDM_OK);
  EXPECT_EQ(out, before);
}

// Plans keep them as well, and the prediction goes on from what was projected.
TEST(Guards, HoldBesidePrediction) {
  const Pool pool = pool_of("hand_over_safe_joint", "cost_mode=angle\naction_repeat=4", 4);
  const Shield shield = shield_of(pool, "block=4\nnoise=0.5");
  const size_t dim = width_of(pool);
  std::vector<float> normal(dim, 0.0f);
  normal[5] = 1, normal[6] = -2;
  const auto keeps = [&](const float* a) { return static_cast<double>(a[5] - 2 * a[6]) <= -0.5 + 1e-6; };
  ASSERT_EQ(rdm_shield_add_guard(shield.get(), normal.data(), -0.5f), RDM_OK);
  const rdm_buffers b = buffers_of(pool.get());
  std::vector<float> plan(1000 * dim);
  for (int i = 0; i < 25; ++i) {
    EXPECT_EQ(play(pool, shield, 1, 0, 4), 0);
    for (size_t e = 0; e < 4; ++e) EXPECT_TRUE(keeps(b.action + e * dim));
    size_t size = 0;
    ASSERT_EQ(rdm_shield_get_plan(shield.get(), pool.get(), i % 4, plan.data(), plan.size(), &size), RDM_OK);
    for (size_t k = 0; k < size; k += dim) EXPECT_TRUE(keeps(plan.data() + k));
  }
  const rdm_shield_stats s = stats_of(shield);
  EXPECT_GT(s.projected, 0);
  EXPECT_GT(s.changed + s.planned, 0);
  EXPECT_EQ(s.unproven, 0);
  // another guard asks anew
  size_t size = 0;
  ASSERT_EQ(rdm_shield_set_guard(shield.get(), 2, 0, normal.data(), -0.5f), RDM_OK);
  ASSERT_EQ(rdm_shield_get_plan(shield.get(), pool.get(), 2, nullptr, 0, &size), RDM_OK);
  EXPECT_GT(size, 0u);
  ASSERT_EQ(rdm_shield_set_guard(shield.get(), 2, 0, normal.data(), -0.75f), RDM_OK);
  ASSERT_EQ(rdm_shield_get_plan(shield.get(), pool.get(), 2, nullptr, 0, &size), RDM_OK);
  EXPECT_EQ(size, 0u);
}

// Copies that draw for themselves keep them too.
TEST(Guards, HoldInCopiesOfWorldsThatAreNotKnown) {
  const Pool pool = pool_of("hand_over_safe_joint", "cost_mode=angle\naction_repeat=4\nlevel=2", 4);
  const Shield shield = shield_of(pool, "copies=3\nunproven=least");
  std::vector<float> normal(width_of(pool), 0.0f);
  normal[5] = 1, normal[6] = -2;
  ASSERT_EQ(rdm_shield_add_guard(shield.get(), normal.data(), -0.5f), RDM_OK);
  const rdm_buffers b = buffers_of(pool.get());
  for (int i = 0; i < 10; ++i) {
    play(pool, shield, 1, 0, 4);
    for (size_t e = 0; e < 4; ++e) {
      const float* a = b.action + e * normal.size();
      EXPECT_LE(static_cast<double>(a[5] - 2 * a[6]), -0.5 + 1e-6);
    }
  }
  EXPECT_GT(stats_of(shield).projected, 0);
  EXPECT_GT(stats_of(shield).copied, 0);
}

TEST(Guards, TakeNothingFromTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the sanitizer counts";
  const Pool pool = pool_of("hand_over_safe_finger", "cost_mode=command");
  const Shield shield = shield_of(pool, kProject);
  std::vector<float> normal(width_of(pool), 0.5f);
  ASSERT_EQ(rdm_shield_add_guard(shield.get(), normal.data(), 0.5f), RDM_OK);
  const rdm_buffers b = buffers_of(pool.get());
  play(pool, shield, 2);
  const int64_t before = heap_count();
  EXPECT_EQ(rdm_shield_set_guard(shield.get(), 1, 0, normal.data(), 0.25f), RDM_OK);
  EXPECT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_RANDOM), RDM_OK);
  EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
  EXPECT_EQ(heap_count(), before);
}

// ---- learning

struct Learned {
  int64_t violations = 0, refused = 0, unproven = 0, copied = 0;
  std::vector<unsigned char> policy;
};
Learned learn(const char* agent_settings, const char* shield_settings, int epochs = 2) {
  const Pool pool = pool_of("hand_over_safe_finger", "cost_mode=command", 8);
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool.get()), RDM_OK);
  c.algo = "ppo_lag";
  const std::string settings =
      std::string("hidden=16\nhorizon=16\naction_repeat=4\nmultiplier_init=1\n") + agent_settings;
  c.settings = settings.c_str();
  const Agent agent(make_agent(c));
  const Shield shield = shield_settings ? shield_of(pool, shield_settings, nullptr, 4) : Shield();
  EXPECT_EQ(rdm_agent_set_shield(agent.get(), shield.get()), RDM_OK);
  Learned out;
  auto e = RDM_INIT(rdm_epoch);
  for (int i = 0; i < epochs; ++i) {
    EXPECT_EQ(rdm_agent_rollout(agent.get(), pool.get(), &e), RDM_OK) << rdm_agent_error(agent.get());
    out.violations += e.violations;
    out.refused += e.refused;
    out.unproven += e.unproven;
    out.copied += e.copied;
  }
  if (shield) {
    const rdm_shield_stats s = stats_of(shield);
    EXPECT_EQ(out.refused, s.projected + s.changed + s.planned + s.unproven);
  }
  out.policy = policy_bytes(agent.get());
  return out;
}

TEST(GuardedLearning, NeverBreaksARule) {
  const Learned free = learn("", nullptr);
  EXPECT_GT(free.violations, 0);
  std::vector<std::vector<unsigned char>> policies{free.policy};
  for (const char* how : {"own", "applied", "cost"}) {
    const Learned l = learn((std::string("shield_learn=") + how).c_str(), kProject, 4);
    EXPECT_EQ(l.violations, 0) << how;
    EXPECT_GT(l.refused, 0) << how;
    EXPECT_EQ(l.unproven, 0) << how;
    EXPECT_EQ(l.copied, 0) << how;
    for (const auto& other : policies) EXPECT_NE(l.policy, other) << how << ": learns as another one";
    policies.push_back(l.policy);
  }
  // what is projected runs on: an episode ends where a copy would cost
  EXPECT_EQ(learn("shield_learn=end", kProject, 4).policy, policies[1]);
}

// Where guards keep the only cost that is looked at, copies find nothing more: the same is learned, from the agent's own
// actions as they were before they were projected, also where a block of them is foreseen.
TEST(GuardedLearning, LearnsTheSameBesidePrediction) {
  for (const char* how : {"shield_learn=own", "shield_learn=applied"}) {
    // of correlated noise the next draw goes on from what is learned from, which nobody foresees
    const std::string raw = std::string("normalize_obs=false\nnoise_correlation=0\n") + how;
    EXPECT_EQ(learn(how, "block=1\nlook=2").policy, learn(how, kProject).policy);
    EXPECT_EQ(learn(raw.c_str(), "block=8\nlook=2").policy, learn(raw.c_str(), kProject).policy);
  }
}

// ---- refusals

TEST(GuardRefusals, OfProjections) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float normals[] = {1, 2, 0, 0, 1, nan}, bounds[] = {1, 1, 1}, action[] = {0.5f, 0.5f};
  float out[] = {7, 7};
  const auto refused = [&](rdm_result r, rdm_result want, const char* text) {
    EXPECT_EQ(r, want);
    EXPECT_NE(std::strstr(rdm_last_error(), text), nullptr) << rdm_last_error();
    EXPECT_EQ(out[0], 7);
  };
  refused(rdm_project(normals, bounds, 2, 2, action, out), RDM_ERROR_ARGUMENT, "row 1");
  refused(rdm_project(normals + 4, bounds, 1, 2, action, out), RDM_ERROR_ARGUMENT, "entry 1");
  refused(rdm_project(normals, &nan, 1, 2, action, out), RDM_ERROR_ARGUMENT, "bound");
  refused(rdm_project(normals, bounds, 1, 2, normals + 4, out), RDM_ERROR_ARGUMENT, "action: entry 1");
  refused(rdm_project(nullptr, bounds, 1, 2, action, out), RDM_ERROR_ARGUMENT, "normals");
  refused(rdm_project(normals, nullptr, 1, 2, action, out), RDM_ERROR_ARGUMENT, "bounds");
  refused(rdm_project(normals, bounds, 33, 2, action, out), RDM_ERROR_RANGE, "count");
  refused(rdm_project(normals, bounds, 1, 0, action, out), RDM_ERROR_RANGE, "dim");
  const float apart[] = {1, 2, -1, -2}, never[] = {-1, 0.5f};
  refused(rdm_project(apart, never, 2, 2, action, out), RDM_ERROR_ARGUMENT, "no action");
  ASSERT_EQ(rdm_project(nullptr, nullptr, 0, 2, normals, out), RDM_OK);
  EXPECT_EQ(out[1], 1);
}

TEST(GuardRefusals, OfShields) {
  const Pool pool = pool_of("hand_over_safe_finger", "cost_mode=command", 2);
  const Shield shield = shield_of(pool, kProject);
  const size_t dim = width_of(pool);
  std::vector<float> normal(dim, 0.0f);
  const auto add = [&](float bound) { return rdm_shield_add_guard(shield.get(), normal.data(), bound); };
  EXPECT_EQ(add(1), RDM_ERROR_ARGUMENT);  // a normal of 0
  normal[static_cast<size_t>(guards_of(pool)[0].entry)] = 1;
  EXPECT_EQ(add(-0.75f), RDM_ERROR_ARGUMENT);  // the task's window ends before
  EXPECT_NE(std::strstr(rdm_shield_error(shield.get()), "no action"), nullptr);
  EXPECT_EQ(rdm_shield_set_guard(shield.get(), 0, 0, normal.data(), 1), RDM_ERROR_RANGE);
  for (int i = 6; i < RDM_MAX_GUARDS; ++i) EXPECT_EQ(add(1), RDM_OK);
  EXPECT_EQ(add(1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_shield_set_guard(shield.get(), 2, 0, normal.data(), 1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_shield_set_guard(shield.get(), 0, 26, normal.data(), 1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_shield_set_guard(shield.get(), 0, 0, nullptr, 1), RDM_ERROR_ARGUMENT);

  // without prediction a pool of other options, and a policy, are refused all the same
  const Pool other = pool_of("hand_over_safe_finger", "cost_mode=command\nmax_steps=9", 2);
  const rdm_buffers b = buffers_of(other.get());
  EXPECT_EQ(rdm_shield_act(shield.get(), other.get(), nullptr, b.action, b.action), RDM_ERROR_ARGUMENT);
  rdm_policy* policy = nullptr;
  const std::string path = std::string(RDM_TEST_DATA) + "/../examples/policies/hand_over_safe_finger.rdm";
  ASSERT_EQ(rdm_policy_read_file(&policy, path.c_str()), RDM_OK) << rdm_last_error();
  const Policy owned(policy);
  const Shield held = shield_of(pool, kProject, nullptr, 4);
  EXPECT_EQ(rdm_shield_add_policy(held.get(), policy), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(rdm_shield_error(held.get()), "predict=false"), nullptr)
      << rdm_shield_error(held.get());

  // a window that no command is in
  rdm_shield_config c;
  ASSERT_EQ(rdm_shield_config_init(&c, sizeof c), RDM_OK);
  const Pool never =
      pool_of("hand_over_safe_finger", "cost_mode=command\nwindow.ff4.low=25\nwindow.ff4.high=30", 1);
  c.pool = never.get();
  rdm_shield* s = nullptr;
  EXPECT_EQ(rdm_shield_create(&s, &c), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(rdm_last_error(), "no action"), nullptr) << rdm_last_error();
  c.settings = "project=false\nunproven=least";
  EXPECT_EQ(rdm_shield_create(&s, &c), RDM_OK) << rdm_last_error();
  rdm_shield_destroy(s);
}

TEST(GuardRefusals, BrokenStates) {
  const Pool pool = pool_of("hand_over_wall", "", 2);
  const Shield shield = shield_of(pool, kProject);
  std::vector<float> normal(width_of(pool), 0.5f);
  ASSERT_EQ(rdm_shield_add_guard(shield.get(), normal.data(), 1), RDM_OK);
  const auto state = state_of(shield);
  for (size_t at = 0; at < state.size(); at += 1 + state.size() / 97) {
    auto broken = state;
    broken[at] ^= 0x40;
    EXPECT_NE(rdm_shield_read_state(shield.get(), broken.data(), broken.size()), RDM_OK) << at;
    EXPECT_NE(rdm_shield_read_state(shield.get(), state.data(), at), RDM_OK) << at;
  }
  EXPECT_EQ(state_of(shield), state);
}

}  // namespace

// rdm_shield_*: under a shield no cost exceeds its budget, whatever is proposed and while an agent learns; a shield that
// has nothing to do changes no byte; the same bytes for any threads and after a saved state; each refusal.
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

#include "heap_count.hpp"
#include "policies.hpp"
#include "shields.hpp"

namespace {

// Actions that are held have effects.
constexpr char kHeld[] = "action_repeat=4";

Pool pool_of(const char* task, const char* settings = "", int32_t envs = 8, int32_t threads = 0,
             int32_t autoreset = RDM_AUTORESET_SAME_STEP, uint64_t seed = 3) {
  rdm_pool_config c = pool_config(envs);
  c.task = task;
  c.settings = settings;
  c.num_threads = threads;
  c.autoreset = autoreset;
  c.seed = seed;
  Pool p(make_pool(c));
  EXPECT_EQ(rdm_pool_reset(p.get(), nullptr, nullptr), RDM_OK);
  return p;
}

Shield shield_of(const Pool& pool, const char* settings = "") {
  return shield_of(shield_config(pool, settings));
}

int64_t violations_of(const Pool& pool) {
  auto out = RDM_INIT(rdm_pool_stats);
  EXPECT_EQ(rdm_pool_get_stats(pool.get(), &out), RDM_OK);
  return out.violations;
}
}  // namespace

TEST(ShieldRefusals, APoolOfAnotherSizeHasNoRows) {
  const Pool pool = pool_of("hand_over_safe_joint", kHeld, 4),
             small = pool_of("hand_over_safe_joint", kHeld, 1);
  const Shield shield = shield_of(pool);
  auto row = RDM_INIT(rdm_shield_row);
  size_t size = 0;
  EXPECT_EQ(rdm_shield_get_row(shield.get(), pool.get(), 3, &row), RDM_OK);
  EXPECT_EQ(rdm_shield_get_row(shield.get(), small.get(), 3, &row), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_shield_get_plan(shield.get(), small.get(), 3, nullptr, 0, &size), RDM_ERROR_ARGUMENT);
}

namespace {
// Random actions, or a policy's, looked at.
void play(const Pool& pool, const Shield& shield, int32_t steps, const rdm_policy* policy = nullptr,
          int32_t n = 32) {
  const rdm_buffers b = buffers_of(pool.get());
  std::vector<unsigned char> scratch(policy ? rdm_policy_scratch(policy, n) : 0);
  for (int32_t i = 0; i < steps; ++i) {
    if (policy) {
      ASSERT_EQ(rdm_policy_act(policy, b.obs, n, nullptr, b.action, scratch.data(), scratch.size()), RDM_OK);
    } else {
      ASSERT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_RANDOM), RDM_OK);
    }
    if (shield) {
      ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK)
          << rdm_shield_error(shield.get());
    }
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  }
}

TEST(Shields, LetNoCostComeWhateverIsProposed) {
  for (const auto& [task, settings, steps] :
       {std::tuple{"hand_over_wall", "action_repeat=2", 40}, std::tuple{"hand_over_safe_joint", kHeld, 20},
        std::tuple{"reorient", "action_repeat=3", 20}, std::tuple{"grasp", "action_repeat=4", 20},
        std::tuple{"grasp", "action_repeat=4\narm=ur5e", 20},
        std::tuple{"jenga", "action_repeat=4\npair=paper", 12}}) {
    const Policy policy = shipped(task);
    // no throw at random comes near the wall; what never moves drops the egg
    const rdm_policy *player = std::string(task) == "hand_over_wall" ? policy.get() : nullptr,
                     *backup = std::string(task) == "reorient" ? policy.get() : nullptr;
    const Pool free = pool_of(task, settings, 32);
    play(free, {}, steps, player);
    EXPECT_GT(violations_of(free), 0) << task << ": there is nothing to shield from";
    const Pool pool = pool_of(task, settings, 32);
    rdm_shield_config c = shield_config(pool);
    c.policy = backup;
    const Shield shield = shield_of(c);
    play(pool, shield, steps, player);
    EXPECT_EQ(violations_of(pool), 0) << task;
    const rdm_shield_stats s = stats_of(shield);
    EXPECT_EQ(s.decisions, 32 * steps);
    EXPECT_EQ(s.unproven, 0) << task;
    EXPECT_GT(s.changed + s.planned, 0) << task;
    EXPECT_GT(s.copied, s.decisions);
  }
}

// Of budgets above 0 that much is spent, and no more, of each column that has one.
TEST(Shields, KeepBudgets) {
  const auto most = [](double budget) {
    const Pool pool = pool_of("hand_over_safe_joint", kHeld, 6);
    rdm_shield_config c = shield_config(pool);
    std::vector<double> budgets(static_cast<size_t>(spec_of(pool.get()).cost_dim), -1);
    budgets[0] = budget;
    c.budgets = budgets.data();
    const Shield shield = shield_of(c);
    const rdm_buffers b = buffers_of(pool.get());
    const auto costs = static_cast<size_t>(spec_of(pool.get()).cost_dim);
    float worst = 0;
    for (int i = 0; i < 30; ++i) {
      EXPECT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_RANDOM), RDM_OK);
      EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
      EXPECT_EQ(rdm_pool_step(pool.get()), RDM_OK);
      for (size_t e = 0; e < 6; ++e) worst = std::max(worst, b.episode_cost[e * costs]);
    }
    return worst;
  };
  EXPECT_EQ(most(0), 0);
  const float spent = most(7);
  EXPECT_GT(spent, 4);
  EXPECT_LE(spent, 7);
}

TEST(Shields, ChangeNoByteWhereThereIsNothingToDo) {
  const auto course = [](bool shielded) {
    const Pool pool = pool_of("hand_over_wall", "action_repeat=2");
    const Shield shield = shielded ? shield_of(pool) : Shield();
    const rdm_buffers b = buffers_of(pool.get());
    for (int i = 0; i < 60; ++i) {
      EXPECT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_ZERO), RDM_OK);
      if (shielded) {
        EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
      }
      EXPECT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    }
    // action 0 is what its plan goes on by, so that an episode is asked about once
    if (shielded) {
      EXPECT_LT(stats_of(shield).inquiries, 8 * 4);
    }
    return hash_of(pool.get());
  };
  EXPECT_EQ(course(true), course(false));
}

TEST(Shields, SayWhatWouldHaveCome) {
  const Pool pool = pool_of("hand_over_safe_joint", "", 1);
  const Shield shield = shield_of(pool);
  const rdm_buffers b = buffers_of(pool.get());
  std::vector<float> out(static_cast<size_t>(spec_of(pool.get()).action_dim));
  std::vector<float> bad(out.size(), 0.0f);
  bad[2] = 1;  // FF4 to the end of its range
  ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, bad.data(), out.data()), RDM_OK);
  rdm_shield_row row = row_of(shield, pool, 0);
  int32_t calls = 0;
  // the first decisions may go through, until one of them can no more be taken back
  for (; row.kind == RDM_SHIELD_OWN && calls < 20; ++calls) {
    EXPECT_EQ(row.column, -1);
    EXPECT_EQ(row.ahead, 0);
    std::copy(out.begin(), out.end(), b.action);
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, bad.data(), out.data()), RDM_OK);
    row = row_of(shield, pool, 0);
  }
  ASSERT_NE(row.kind, RDM_SHIELD_OWN);
  EXPECT_NE(out, bad);
  EXPECT_EQ(row.column, 0);
  EXPECT_GT(row.ahead, 0);
  EXPECT_GE(row.backup, 0);
  // it tells the truth: without the shield the cost comes just then
  int32_t step = 0;
  do {
    std::copy(bad.begin(), bad.end(), b.action);
    if (step > 0) std::copy(bad.begin(), bad.end(), b.action);
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    ++step;
  } while (b.cost[0] == 0 && step < 70);
  EXPECT_LE(step, row.ahead);
}

// What is proposed is not clean for a while already, so every plan is not.
TEST(Shields, NameTheWorldInWhichNothingIsClean) {
  const Pool pool =
      pool_of("hand_over_safe_finger", "start_finger=paper\nwindow.ff2.low=80\nwindow.ff2.high=85", 3);
  const rdm_buffers b = buffers_of(pool.get());
  const std::vector<float> zero(3 * static_cast<size_t>(spec_of(pool.get()).action_dim), 0.0f);
  {
    const Shield shield = shield_of(pool);
    std::vector<float> out(zero.size(), 0.5f);
    const uint8_t mask[] = {0, 1, 1};
    EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), mask, zero.data(), out.data()), RDM_ERROR_STATE);
    EXPECT_NE(std::strstr(rdm_shield_error(shield.get()), "world 1"), nullptr)
        << rdm_shield_error(shield.get());
    EXPECT_NE(std::strstr(rdm_shield_error(shield.get()), "unproven=least"), nullptr);
    EXPECT_EQ(out[0], 0.5f);
  }
  const Shield shield = shield_of(pool, "unproven=least");
  ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, zero.data(), b.action), RDM_OK);
  EXPECT_EQ(row_of(shield, pool, 2).kind, RDM_SHIELD_UNPROVEN);
  EXPECT_EQ(stats_of(shield).unproven, 3);
}

// Worlds that draw their dynamics: an exact copy knows them, so nothing comes; copies that draw for themselves do not, and the
// more of them agree, the less comes.
TEST(Shields, KnowDrawnWorldsOnlyByExactCopies) {
  const Policy policy = shipped("hand_over_wall");
  const auto violations = [&](const char* settings) {
    const Pool pool = pool_of("hand_over_wall", "action_repeat=2\nlevel=3", 16);
    rdm_shield_config c = shield_config(pool, settings);
    c.policy = policy.get();
    const Shield shield = settings ? shield_of(c) : Shield();
    play(pool, shield, 74, policy.get(), 16);
    return violations_of(pool);
  };
  EXPECT_EQ(violations("unproven=least"), 0);
  const int64_t bare = violations(nullptr), one = violations("unproven=least\ncopies=1"),
                four = violations("unproven=least\ncopies=4");
  EXPECT_GT(one, 0) << "they know what they should not";
  EXPECT_LT(one, bare);
  EXPECT_LT(four, one);
}

std::vector<unsigned char> course_of(int32_t threads, bool resumed) {
  const Pool pool = pool_of("reorient", "action_repeat=3", 7, threads);
  const Policy backup = shipped("reorient");
  rdm_shield_config c = shield_config(pool, "block=4\nnoise=0.5");
  c.policy = backup.get();
  c.num_threads = threads;
  Shield shield = shield_of(c);
  play(pool, shield, 12);
  if (resumed) {
    const auto state = state_of(shield);
    size_t n = 0;
    EXPECT_EQ(rdm_pool_write_state(pool.get(), -1, nullptr, 0, &n), RDM_OK);
    std::vector<unsigned char> worlds(n);
    EXPECT_EQ(rdm_pool_write_state(pool.get(), -1, worlds.data(), n, &n), RDM_OK);
    play(pool, shield, 3);  // goes astray
    EXPECT_EQ(rdm_pool_read_state(pool.get(), -1, worlds.data(), n), RDM_OK);
    shield = shield_of(c);
    EXPECT_EQ(rdm_shield_read_state(shield.get(), state.data(), state.size()), RDM_OK)
        << rdm_shield_error(shield.get());
  }
  play(pool, shield, 12);
  auto out = state_of(shield);
  const uint64_t hash = hash_of(pool.get());
  const auto* bytes = reinterpret_cast<const unsigned char*>(&hash);
  out.insert(out.end(), bytes, bytes + sizeof hash);
  return out;
}

TEST(Shields, GiveTheSameBytesForAnyThreadsAndAfterASavedState) {
  const auto one = course_of(1, false);
  EXPECT_EQ(course_of(3, false), one);
  EXPECT_EQ(course_of(2, true), one);
}

TEST(Shields, NoticeWorldsThatWereMoved) {
  const Pool pool = pool_of("hand_over_wall", "action_repeat=2", 2);
  const Shield shield = shield_of(pool);
  const rdm_buffers b = buffers_of(pool.get());
  const auto asked = [&] {
    const int64_t before = stats_of(shield).inquiries;
    EXPECT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_ZERO), RDM_OK);
    EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
    return stats_of(shield).inquiries - before;
  };
  EXPECT_EQ(asked(), 2);
  EXPECT_EQ(asked(), 0);
  const uint8_t second[] = {0, 1};
  ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, second), RDM_OK);
  EXPECT_EQ(asked(), 1);
  ASSERT_EQ(rdm_pool_copy(pool.get(), 0, pool.get(), 1), RDM_OK);
  EXPECT_EQ(asked(), 1);
  ASSERT_EQ(rdm_shield_reset(shield.get(), second), RDM_OK);
  EXPECT_EQ(asked(), 1);
  ASSERT_EQ(rdm_shield_reset(shield.get(), nullptr), RDM_OK);
  EXPECT_EQ(asked(), 2);
}

TEST(Shields, TakeNothingFromTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the sanitizer counts";
  const Pool pool = pool_of("reorient", "action_repeat=3", 4);
  const Policy backup = shipped("reorient");
  rdm_shield_config c = shield_config(pool);
  c.policy = backup.get();
  const Shield shield = shield_of(c);
  play(pool, shield, 3);
  const int64_t before = heap_count();
  play(pool, shield, 6);
  EXPECT_EQ(heap_count(), before);
}

// ---- learning

struct Learned {
  int64_t violations = 0, refused = 0, unproven = 0, inevitable = 0, steps = 0;
  std::vector<unsigned char> policy;
};

Learned learn(const char* task, const char* pool_settings, const char* agent_settings,
              const char* shield_settings, int epochs, const double* budgets = nullptr,
              const char* algo = "ppo_lag") {
  const Pool pool = pool_of(task, pool_settings, 8);
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool.get()), RDM_OK);
  c.algo = algo;
  c.settings = agent_settings;
  const Agent agent(make_agent(c));
  Shield shield;
  if (shield_settings) {
    rdm_shield_config s = shield_config(pool, shield_settings);
    s.budgets = budgets;
    s.steps = 4;
    shield = shield_of(s);
    EXPECT_EQ(rdm_agent_set_shield(agent.get(), shield.get()), RDM_OK);
  }
  Learned out;
  auto e = RDM_INIT(rdm_epoch);
  for (int i = 0; i < epochs; ++i) {
    EXPECT_EQ(rdm_agent_rollout(agent.get(), pool.get(), &e), RDM_OK) << rdm_agent_error(agent.get());
    out.violations += e.violations;
    out.refused += e.refused;
    out.unproven += e.unproven;
    out.inevitable += e.inevitable;
  }
  EXPECT_EQ(out.violations, violations_of(pool));
  out.steps = e.env_steps;
  out.policy = policy_bytes(agent.get());
  return out;
}

constexpr char kSmall[] = "hidden=16\nhorizon=16\naction_repeat=4\nmultiplier_init=1";

// Episodes begin with the finger outside of its window: some steps cost whatever it does, and no others do.
TEST(ShieldedLearning, CountsWhatNoPlanAvoidsApart) {
  for (const char* how : {"own", "end"}) {
    const std::string settings = std::string(kSmall) + "\nshield_learn=" + how;
    const Learned l =
        learn("hand_over_safe_finger", "start_finger=paper", settings.c_str(), "unproven=least", 3);
    EXPECT_GT(l.inevitable, 0) << how;
    EXPECT_EQ(l.inevitable, l.violations) << how;
    EXPECT_GE(4 * l.unproven, l.inevitable) << how;
  }
}

TEST(ShieldedLearning, NeverBreaksARule) {
  const Learned free = learn("hand_over_safe_joint", "", kSmall, nullptr, 3);
  EXPECT_GT(free.violations, 0);
  EXPECT_EQ(free.refused, -3);  // there was none
  EXPECT_EQ(free.inevitable, -3);
  std::vector<std::vector<unsigned char>> policies{free.policy};
  for (const char* how : {"own", "applied", "cost", "end"}) {
    const std::string settings = std::string(kSmall) + "\nshield_learn=" + how;
    const Learned l = learn("hand_over_safe_joint", "", settings.c_str(), "", 3);
    EXPECT_EQ(l.violations, 0) << how;
    EXPECT_EQ(l.unproven, 0) << how;
    EXPECT_EQ(l.inevitable, 0) << how;
    EXPECT_GT(l.refused, 0) << how;
    for (const auto& other : policies) EXPECT_NE(l.policy, other) << how << ": learns as another one";
    policies.push_back(l.policy);
  }
  const Learned charged =
      learn("hand_over_safe_joint", "", (std::string(kSmall) + "\nshield_penalty=0.5").c_str(), "", 3);
  EXPECT_EQ(charged.violations, 0);
  EXPECT_NE(charged.policy, policies[1]);
}

// With nothing to refuse: decision by decision always; in blocks where what is foreseen is what comes, as observations are
// not normalised.
TEST(ShieldedLearning, ChangesNoByteWhereThereIsNothingToDo) {
  const double budgets[8] = {1e9, -1, -1, -1, -1, -1, -1, -1};
  for (const char* more : {"", "\nnoise_correlation=0.7"}) {
    const std::string plain = std::string(kSmall) + more, raw = plain + "\nnormalize_obs=false";
    const Learned free = learn("hand_over_safe_joint", "", plain.c_str(), nullptr, 2);
    const Learned one = learn("hand_over_safe_joint", "", plain.c_str(), "block=1", 2, budgets);
    EXPECT_EQ(one.refused, 0);
    EXPECT_EQ(one.policy, free.policy);
    const Learned unscaled = learn("hand_over_safe_joint", "", raw.c_str(), nullptr, 2);
    EXPECT_EQ(learn("hand_over_safe_joint", "", raw.c_str(), "block=16", 2, budgets).policy, unscaled.policy);
    EXPECT_EQ(
        learn("hand_over_safe_joint", "", (raw + "\nstd_mode=state").c_str(), "block=5", 2, budgets).policy,
        learn("hand_over_safe_joint", "", (raw + "\nstd_mode=state").c_str(), nullptr, 2).policy);
  }
}

// ---- refusals

// Plans that a policy's shield has made are those of one that knows nothing but action 0, world by world.
TEST(Shields, GoOnByPlansOfAHost) {
  const Policy policy = shipped("hand_over_wall");
  const Pool pool = pool_of("hand_over_wall", "action_repeat=2", 8);
  rdm_shield_config c = shield_config(pool, "hold=false");
  c.policy = policy.get();
  const Shield teacher = shield_of(c), student = shield_of(pool, "hold=false\ntries=2\nrounds=1");
  const rdm_buffers b = buffers_of(pool.get());
  const auto dim = static_cast<size_t>(spec_of(pool.get()).action_dim);
  std::vector<float> out(8 * dim), plan(200 * dim);
  std::vector<unsigned char> scratch(rdm_policy_scratch(policy.get(), 8));
  ASSERT_EQ(rdm_policy_act(policy.get(), b.obs, 8, nullptr, b.action, scratch.data(), scratch.size()),
            RDM_OK);
  ASSERT_EQ(rdm_shield_act(teacher.get(), pool.get(), nullptr, b.action, out.data()), RDM_OK);
  for (int32_t env = 0; env < 8; ++env) {
    size_t size = 0, own = 0;
    ASSERT_EQ(rdm_shield_get_plan(teacher.get(), pool.get(), env, plan.data(), plan.size(), &size), RDM_OK);
    ASSERT_GT(size, 0u);
    ASSERT_EQ(rdm_shield_set_plan(student.get(), pool.get(), env, plan.data(), size / dim), RDM_OK)
        << rdm_shield_error(student.get());
    ASSERT_EQ(rdm_shield_get_plan(student.get(), pool.get(), env, nullptr, 0, &own), RDM_OK);
    EXPECT_EQ(own, size);
  }
  // Held to the plans, the worlds go as the policy's do; what is proposed as planned is not asked about.
  const int64_t copied = stats_of(student).copied;
  std::vector<int32_t> kinds(8);
  for (int t = 0; t < 36; ++t) {
    for (size_t env = 0; env < 8; ++env) {
      size_t size = 0;
      ASSERT_EQ(rdm_shield_get_plan(student.get(), pool.get(), static_cast<int32_t>(env), plan.data(),
                                    plan.size(), &size),
                RDM_OK);
      ASSERT_GT(size, 0u);
      std::copy_n(plan.data(), dim, b.action + env * dim);
    }
    ASSERT_EQ(rdm_shield_act(student.get(), pool.get(), nullptr, b.action, b.action), RDM_OK);
    ASSERT_EQ(rdm_shield_get_kinds(student.get(), kinds.data()), RDM_OK);
    for (int32_t env = 0; env < 8; ++env) {
      EXPECT_EQ(kinds[static_cast<size_t>(env)], RDM_SHIELD_OWN);
      EXPECT_EQ(kinds[static_cast<size_t>(env)], row_of(student, pool, env).kind);
    }
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    if (b.terminated[0] || b.truncated[0]) break;
  }
  EXPECT_EQ(stats_of(student).copied, copied);
  EXPECT_EQ(violations_of(pool), 0);
}

TEST(ShieldRefusals, OfPlans) {
  const Pool pool = pool_of("hand_over_safe_joint", kHeld, 2);
  const Shield shield = shield_of(pool), drawn = shield_of(pool, "copies=2"),
               bare = shield_of(pool, "zero=false\nhold=false");
  const auto dim = static_cast<size_t>(spec_of(pool.get()).action_dim);
  std::vector<float> plan(10 * dim, 0.0f);
  const auto refused = [&](const Shield& s, size_t decisions, rdm_result code, const char* text) {
    EXPECT_EQ(rdm_shield_set_plan(s.get(), pool.get(), 1, plan.data(), decisions), code);
    EXPECT_NE(std::strstr(rdm_shield_error(s.get()), text), nullptr) << rdm_shield_error(s.get());
  };
  ASSERT_EQ(rdm_shield_set_plan(shield.get(), pool.get(), 1, plan.data(), 10), RDM_OK);  // then action 0
  size_t size = 0, after = 0;
  ASSERT_EQ(rdm_shield_get_plan(shield.get(), pool.get(), 1, nullptr, 0, &size), RDM_OK);
  EXPECT_GT(size, plan.size());
  refused(drawn, 10, RDM_ERROR_UNSUPPORTED, "copies=2");
  refused(bare, 10, RDM_ERROR_STATE, "ends before the episode");
  refused(shield, 0, RDM_ERROR_RANGE, "decisions, 0,");
  refused(shield, 1000, RDM_ERROR_RANGE, "decisions, 1000,");
  EXPECT_EQ(rdm_shield_set_plan(shield.get(), pool.get(), 2, plan.data(), 10), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_shield_set_plan(shield.get(), pool.get(), 1, nullptr, 10), RDM_ERROR_ARGUMENT);
  plan[3] = std::numeric_limits<float>::infinity();
  refused(shield, 10, RDM_ERROR_ARGUMENT, "entry 3");
  plan[3] = 0;
  for (size_t d = 0; d < 10; ++d) plan[d * dim + 2] = 1;  // FF4 to the end of its range
  refused(shield, 10, RDM_ERROR_STATE, "world 1: under the plan cost column 0");
  ASSERT_EQ(rdm_shield_get_plan(shield.get(), pool.get(), 1, nullptr, 0, &after), RDM_OK);
  EXPECT_EQ(after, size);
}

// A task recommends options of shields among its defaults.
TEST(Shields, HaveDefaultsOfTheirTask) {
  const auto noise = [](const char* task, const char* settings) {
    const Pool pool = pool_of(task, "", 1);
    const Shield shield = shield_of(pool, settings);
    char text[2000];
    size_t size = 0;
    EXPECT_EQ(rdm_shield_get_settings(shield.get(), text, sizeof text, &size), RDM_OK);
    const char* at = std::strstr(text, "noise=");
    return at ? std::atof(at + 6) : -1;
  };
  EXPECT_EQ(noise("hand_over_wall", ""), 0.2);
  EXPECT_EQ(noise("reorient", ""), 1);
  EXPECT_EQ(noise("reorient", "noise=0.5"), 0.5);
}

TEST(ShieldRefusals, NameWhatIsWrong) {
  const Pool pool = pool_of("hand_over_wall", "", 2);
  const auto refused = [&](const rdm_shield_config& c, const char* text) {
    rdm_shield* s = nullptr;
    const rdm_result r = rdm_shield_create(&s, &c);
    EXPECT_NE(r, RDM_OK) << text;
    EXPECT_NE(std::strstr(rdm_last_error(), text), nullptr) << rdm_last_error();
    rdm_shield_destroy(s);
  };
  rdm_shield_config c = shield_config(pool);
  c.steps = -1;
  refused(c, "config.steps");
  c = shield_config(pool, "blok=3");
  refused(c, "block");
  c = shield_config(pool, "tries=1");
  refused(c, "tries");
  c = shield_config(pool);
  const double none[16] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  c.budgets = none;
  refused(c, "budget");
  c = shield_config(pool);
  c.num_threads = 1000;
  refused(c, "num_threads");

  const Shield shield = shield_of(pool);
  const rdm_buffers b = buffers_of(pool.get());
  const Pool other = pool_of("hand_over_wall", "", 3);
  EXPECT_EQ(rdm_shield_act(shield.get(), other.get(), nullptr, b.action, b.action), RDM_ERROR_ARGUMENT);
  const Pool task = pool_of("grasp", "", 2);
  EXPECT_EQ(rdm_shield_act(shield.get(), task.get(), nullptr, b.action, b.action), RDM_ERROR_ARGUMENT);
  b.action[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_ERROR_ARGUMENT);
  b.action[1] = 0;
  EXPECT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, nullptr, b.action), RDM_ERROR_ARGUMENT);
  const Pool off = pool_of("hand_over_wall", "max_steps=1", 2, 0, RDM_AUTORESET_OFF);
  const Shield of_off = shield_of(off);
  const rdm_buffers o = buffers_of(off.get());
  ASSERT_EQ(rdm_pool_step(off.get()), RDM_OK);
  EXPECT_EQ(rdm_shield_act(of_off.get(), off.get(), nullptr, o.action, o.action), RDM_ERROR_STATE);
  const Shield without = shield_of(pool, "zero=false\nhold=false");
  EXPECT_EQ(rdm_shield_act(without.get(), pool.get(), nullptr, b.action, b.action), RDM_ERROR_STATE);
}

TEST(ShieldRefusals, StatesOfOthersAndBrokenOnes) {
  const Pool pool = pool_of("hand_over_wall", "", 2);
  const Shield shield = shield_of(pool), other = shield_of(pool, "block=3");
  play(pool, shield, 2);
  const auto state = state_of(shield);
  EXPECT_EQ(rdm_shield_read_state(other.get(), state.data(), state.size()), RDM_ERROR_FORMAT);
  for (size_t at = 0; at < state.size(); at += 1 + state.size() / 97) {
    auto broken = state;
    broken[at] ^= 0x40;
    EXPECT_NE(rdm_shield_read_state(shield.get(), broken.data(), broken.size()), RDM_OK) << at;
    EXPECT_NE(rdm_shield_read_state(shield.get(), state.data(), at), RDM_OK) << at;
  }
  EXPECT_EQ(state_of(shield), state);
}

TEST(ShieldRefusals, OfLearning) {
  const Pool pool = pool_of("hand_over_safe_joint", "", 8);
  rdm_agent_config c;
  ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  ASSERT_EQ(rdm_agent_config_for_pool(&c, pool.get()), RDM_OK);
  c.settings = kSmall;
  const Agent agent(make_agent(c));
  const Shield shield = shield_of(pool);  // decisions of one step, the agent's last four
  ASSERT_EQ(rdm_agent_set_shield(agent.get(), shield.get()), RDM_OK);
  EXPECT_EQ(rdm_agent_rollout(agent.get(), pool.get(), nullptr), RDM_ERROR_ARGUMENT);
  ASSERT_EQ(rdm_agent_set_shield(agent.get(), nullptr), RDM_OK);
  EXPECT_EQ(rdm_agent_rollout(agent.get(), pool.get(), nullptr), RDM_OK);
}

}  // namespace

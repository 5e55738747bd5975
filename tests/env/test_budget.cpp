// What is left of an episode's limit: what is shown of it, what follows once it is spent, limits that are drawn.
#include <algorithm>
#include <string>

#include "heap_count.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

// The toy costs 1 in a step whose first action is above 0.5, and its limit is 3.
constexpr int kLeft = kToyObs, kLimit = kToyObs + 1;

PoolConfig config(const char* settings, Autoreset autoreset = Autoreset::kSameStep, uint64_t seed = 0) {
  register_toy();
  PoolConfig c;
  c.settings = settings;
  c.autoreset = autoreset;
  c.seed = seed;
  return c;
}

// Pushes at random, so that some steps cost, and not so far that an episode ends early.
void draw_actions(TestPool& p) {
  p->baseline(Baseline::kRandom);
  for (int32_t env = 0; env < p->config().num_envs; ++env)
    p.action(env)[0] = p.action(env)[0] > 0 ? 0.51f : -0.51f;
}

float number(double x) {
  return static_cast<float>(x);
}

// z of every world by a loop of its own, from the costs that the pool reports.
struct Loop {
  double discount, whole;  // of one limit for all
  std::vector<double> left;
  void begin(size_t env, double limit) { left[env] = limit; }
  double spend(size_t env, float cost) {
    left[env] = (left[env] - static_cast<double>(cost)) / discount;
    return left[env];
  }
};

TEST(Budget, WithoutTheOptionNothingIsAdded) {
  TestPool plain("toy_push", 2, {}, config(nullptr)), off("toy_push", 2, {}, config("budget=none\nlimit=-1"));
  plain->reset(nullptr, nullptr);
  off->reset(nullptr, nullptr);
  for (int t = 0; t < 25; ++t)
    for (TestPool* p : {&plain, &off}) draw_actions(*p), (*p)->step(nullptr);
  EXPECT_EQ(plain->obs_dim(), kToyObs);
  EXPECT_EQ(plain->options_hash(), off->options_hash());
  EXPECT_EQ(plain->hash(-1), off->hash(-1));
}

// Over 3 episodes of 10 steps, with the sum of costs as it is and with it discounted.
TEST(Budget, WhatIsLeftFollowsFromTheCosts) {
  for (const double g : {1.0, 0.9}) {
    constexpr int kEnvs = 8;
    const std::string settings = "budget=show\nlimit=4\nbudget_discount=" + std::to_string(g);
    TestPool p("toy_push", kEnvs, {}, config(settings.c_str()));
    TestPool plain("toy_push", kEnvs, {}, config(nullptr));
    ASSERT_EQ(p->obs_dim(), kToyObs + 1);
    p->reset(nullptr, nullptr);
    plain->reset(nullptr, nullptr);
    const double whole = g < 1 ? 4 * (1 - std::pow(g, 10)) / ((1 - g) * 10) : 4;
    Loop loop{g, whole, std::vector<double>(kEnvs, whole)};
    bool negative = false;
    for (int t = 0; t < 30; ++t) {
      draw_actions(p);
      draw_actions(plain);
      p->step(nullptr);
      plain->step(nullptr);
      for (size_t env = 0; env < kEnvs; ++env) {
        const auto e = static_cast<int32_t>(env);
        const double left = loop.spend(env, p.rows().cost[env * kToyCosts]);
        const float* final_obs = p.rows().final_obs + env * static_cast<size_t>(p->obs_dim());
        EXPECT_NEAR(static_cast<double>(final_obs[kLeft]), left / whole, 1e-6) << t;
        negative |= left < 0;
        if (p.ended(e)) loop.begin(env, whole);
        EXPECT_NEAR(static_cast<double>(p.obs(e)[kLeft]), loop.left[env] / whole, 1e-6) << t;
        EXPECT_EQ(std::memcmp(p.obs(e), plain.obs(e), kToyObs * sizeof(float)), 0);
        EXPECT_EQ(p.rows().reward[env], plain.rows().reward[env]);  // show changes nothing
      }
    }
    EXPECT_TRUE(negative);
  }
}

// A limit that is just met is kept: the reward goes with the first step beyond it.
TEST(Budget, BeyondTheLimitTheRewardIsAConstant) {
  TestPool p("toy_push", 1, {}, config("budget=saute\nlimit=2\nunsafe_reward=-7"));
  p->reset(nullptr, nullptr);
  for (int t = 1; t <= 10; ++t) {
    p.action(0)[0] = t % 2 ? 0.51f : -0.51f;  // costs in steps 1, 3, 5 ...
    p.action(0)[1] = 0.5f;
    p->step(nullptr);
    EXPECT_EQ(p.rows().reward[0], t < 5 ? 0.5f : -7.0f) << t;
    EXPECT_EQ(p.rows().truncated[0], t == 10);
    EXPECT_FALSE(p.rows().terminated[0]);
  }
}

TEST(Budget, BeyondTheLimitAnEpisodeEnds) {
  TestPool p("toy_push", 1, {}, config("budget=end\nlimit=2", Autoreset::kOff));
  p->reset(nullptr, nullptr);
  for (int t = 1; t <= 5; ++t) {
    p.action(0)[0] = t % 2 ? 0.51f : -0.51f;
    p.action(0)[1] = 0.5f;
    p->step(nullptr);
    EXPECT_EQ(p.rows().terminated[0], t == 5) << t;
    EXPECT_EQ(p.rows().reward[0], t == 5 ? -1.0f : 0.5f) << t;
  }
  EXPECT_EQ(p.rows().episode_cost[0], 3);
}

// The task's limit is 3.
TEST(Budget, TheTasksLimitIsTheDefault) {
  TestPool p("toy_push", 1, {}, config("budget=show"));
  p->reset(nullptr, nullptr);
  p.action(0)[0] = 0.51f, p.action(0)[1] = 0;
  p->step(nullptr);
  EXPECT_EQ(p.obs(0)[kLeft], number(2.0 / 3));
  EXPECT_EQ(p->limit(0), 3);
}

// What was spent stays spent; the next episode begins with a limit of its own.
TEST(Budget, ALimitChangesInTheMiddleOfAnEpisode) {
  TestPool p("toy_push", 2, {}, config("limit_range=2..8\nlimit=4\nbudget=saute"));
  const auto pushed = [&] {  // one step that costs and one that does not, forth and back
    for (const float a : {0.51f, -0.51f}) {
      for (int32_t env = 0; env < 2; ++env) p.action(env)[0] = a, p.action(env)[1] = 0.5f;
      p->step(nullptr);
    }
  };
  EXPECT_THROW(p->set_limit(-1, 4), Error);  // before the first reset
  p->reset(nullptr, nullptr);
  pushed();
  const std::vector<float> row(p.obs(1), p.obs(1) + p->obs_dim());
  const uint64_t other = p->hash(0);
  p->set_limit(1, 8);
  EXPECT_EQ(p->hash(0), other);
  EXPECT_EQ(p->limit(0), 4);
  EXPECT_EQ(p->limit(1), 8);
  EXPECT_EQ(p.obs(1)[kLeft], number(7.0 / 8));
  EXPECT_EQ(p.obs(1)[kLimit], 1);
  EXPECT_TRUE(std::equal(row.begin(), row.begin() + kToyObs, p.obs(1)));
  pushed();
  EXPECT_EQ(p.obs(0)[kLeft], number(2.0 / 4));
  EXPECT_EQ(p.obs(1)[kLeft], number(6.0 / 8));
  p->set_limit(-1, 2);
  EXPECT_EQ(p.obs(0)[kLeft], 0);
  pushed();  // and now it is overspent
  for (int32_t env = 0; env < 2; ++env) EXPECT_EQ(p.rows().reward[static_cast<size_t>(env)], -1);
  for (const double wrong : {1.9, 8.1, std::nan("")}) EXPECT_THROW(p->set_limit(0, wrong), Error);
  EXPECT_EQ(p->limit(0), 2);

  TestPool again("toy_push", 2, {}, config("limit_range=2..8\nlimit=4\nbudget=saute"));
  again->copy(-1, *p, 1);  // a saved state has it
  EXPECT_EQ(again->limit(0), 2);
  for (int k = 0; k < 2; ++k) pushed();  // its 10 steps are over
  EXPECT_EQ(p->limit(0), 4);

  TestPool fixed("toy_push", 1, {}, config("budget=show")), none("toy_push", 1, {}, config(nullptr));
  for (TestPool* q : {&fixed, &none}) {
    (*q)->reset(nullptr, nullptr);
    EXPECT_THROW((*q)->set_limit(0, 3), Error);
  }
}

TEST(Budget, ALimitIsDrawnAtEachResetAndShown) {
  constexpr int kEnvs = 200;
  TestPool p("toy_push", kEnvs, {}, config("limit_range=5..40"));
  TestPool set("toy_push", kEnvs, {}, config("limit_range=5..40\nlimit=15"));
  ASSERT_EQ(p->obs_dim(), kToyObs + 2);
  ASSERT_EQ(set->obs_dim(), p->obs_dim());
  EXPECT_TRUE(p->task().draws_limit());
  EXPECT_FALSE(set->task().draws_limit());
  p->reset(nullptr, nullptr);
  set->reset(nullptr, nullptr);
  double sum = 0, low = 1e9, high = 0;
  std::vector<double> first;
  for (int32_t env = 0; env < kEnvs; ++env) {
    const double d = p->limit(env);
    EXPECT_EQ(p.obs(env)[kLimit], number(d / 40));
    EXPECT_EQ(p.obs(env)[kLeft], 1);
    EXPECT_EQ(set.obs(env)[kLimit], number(15.0 / 40));
    EXPECT_EQ(set->limit(env), 15);
    sum += d, low = std::min(low, d), high = std::max(high, d);
    first.push_back(d);
  }
  EXPECT_NEAR(sum / kEnvs, 22.5, 4 * 35 / std::sqrt(12.0 * kEnvs));
  EXPECT_GE(low, 5);
  EXPECT_LT(high, 40);
  for (int t = 0; t < 10; ++t) {
    draw_actions(p);
    p->step(nullptr);
    for (int32_t env = 0; env < kEnvs; ++env) {
      double& d = first[static_cast<size_t>(env)];
      EXPECT_EQ(p->limit(env) == d, !p.ended(env)) << t;  // with its end another episode has begun
      d = p->limit(env);
    }
  }
}

// The share of the limit grows with the control steps of a world, whatever its episodes.
TEST(Budget, SimmerBeginsLow) {
  TestPool p("toy_push", 2, {}, config("budget=simmer\nlimit=4\nsimmer_start=0.25\nsimmer_steps=40"));
  p->reset(nullptr, nullptr);
  for (int episode = 0; episode < 6; ++episode) {
    EXPECT_EQ(p.obs(0)[kLeft], number(std::min(1.0, 0.25 + 0.75 * episode / 4))) << episode;
    for (int t = 0; t < 10; ++t) {
      for (int32_t env = 0; env < 2; ++env) p.action(env)[0] = -0.51f, p.action(env)[1] = 0;
      p->step(nullptr);
    }
  }
}

TEST(Budget, AnyThreadsAndEverySavedStateGoOnToTheSameBytes) {
  for (const char* settings :
       {"budget=saute\nlimit_range=1..4\nbudget_discount=0.95", "budget=simmer\nlimit=2\nsimmer_steps=30"}) {
    std::vector<uint64_t> hashes;
    for (const int32_t threads : {0, 3}) {
      PoolConfig c = config(settings, Autoreset::kNextStep);
      c.num_threads = threads;
      TestPool p("toy_push", 7, {}, c), other("toy_push", 7, {}, config(settings, Autoreset::kNextStep, 9));
      p->reset(nullptr, nullptr);
      other->reset(nullptr, nullptr);
      for (int t = 0; t < 17; ++t) draw_actions(p), p->step(nullptr);
      const std::vector<unsigned char> state = p.state();
      other->set_state(-1, state.data(), state.size());
      EXPECT_EQ(other->hash(-1), p->hash(-1));
      for (int t = 0; t < 17; ++t)
        for (TestPool* each : {&p, &other}) draw_actions(*each), (*each)->step(nullptr);
      EXPECT_EQ(other->hash(-1), p->hash(-1)) << settings;
      EXPECT_EQ(std::memcmp(p.rows().reward, other.rows().reward, 7 * sizeof(float)), 0);
      hashes.push_back(p->hash(-1));
    }
    EXPECT_EQ(hashes[0], hashes[1]) << settings;
  }
}

TEST(Budget, AStateWithALimitThatCannotBeIsRefused) {
  TestPool p("toy_push", 1, {}, config("limit_range=5..40")),
      narrow("toy_push", 1, {}, config("limit_range=5..6"));
  p->reset(nullptr, nullptr);
  const std::vector<unsigned char> state = p.state();
  EXPECT_EQ(code_of([&] { narrow->set_state(-1, state.data(), state.size()); }), Code::kFormat);
}

TEST(Budget, DisturbancesLeaveItAlone) {
  TestPool p("toy_push", 1, {}, config("budget=show\nlimit=4\nnoise.*=0.5"));
  p->reset(nullptr, nullptr);
  EXPECT_EQ(p.obs(0)[kLeft], 1);
}

TEST(Budget, WrongOptionsAreRefused) {
  for (const char* settings :
       {"limit=5", "limit_range=0..5", "budget=soup", "budget=show\nbudget_discount=0", "limit_range=9..5"})
    EXPECT_NE(code_of([&] { TestPool p("toy_push", 1, {}, config(settings)); }), Code::kOk) << settings;
}

TEST(Budget, NoHeapInAStep) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  TestPool p("toy_push", 3, {}, config("budget=saute\nlimit_range=1..4"));
  p->reset(nullptr, nullptr);
  const int64_t before = heap_count();
  for (int t = 0; t < 25; ++t) draw_actions(p), p->step(nullptr);
  EXPECT_EQ(heap_count(), before);
}

}  // namespace
}  // namespace rdm::test

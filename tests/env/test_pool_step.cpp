// Episodes, the three autoreset modes, masks, flags and baselines, on a task whose every number is known.
#include <cmath>

#include "heap_count.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

PoolConfig mode(Autoreset autoreset, uint64_t seed = 0) {
  register_toy();
  PoolConfig c;
  c.autoreset = autoreset;
  c.seed = seed;
  return c;
}

std::vector<float> row(const float* from) {
  return std::vector<float>(from, from + kToyObs);
}

TEST(PoolStep, StepBeforeResetIsAStateError) {
  TestPool p("toy_push", 2, {}, mode(Autoreset::kSameStep));
  EXPECT_EQ(code_of([&] { p->step(nullptr); }), Code::kState);
  const uint8_t first[] = {1, 0};
  p->reset(nullptr, first);
  EXPECT_EQ(code_of([&] { p->step(nullptr); }), Code::kState);
  p->step(first);
  EXPECT_EQ(p.rows().episode_step[0], 1);
}

TEST(PoolStep, SumsRewardAndCostsOfTheEpisode) {
  TestPool p("toy_push", 1, {}, mode(Autoreset::kSameStep));
  p->reset(nullptr, nullptr);
  for (int t = 1; t <= 10; ++t) {
    p.action(0)[0] = t % 2 ? 0.75f : 0.0f;
    p.action(0)[1] = 0.5f;
    p->step(nullptr);
    EXPECT_EQ(p.rows().reward[0], 0.5f);
    EXPECT_EQ(p.cost(0)[0], t % 2 ? 1.0f : 0.0f);
    EXPECT_EQ(p.rows().cost_raw[0], t % 2 ? 0.75f : 0.0f);
    EXPECT_EQ(p.rows().episode_step[0], t);
    EXPECT_EQ(p.rows().episode_return[0], 0.5f * static_cast<float>(t));
    EXPECT_EQ(p.rows().episode_cost[0], static_cast<float>((t + 1) / 2));
    EXPECT_EQ(p.rows().episode_cost[1], 0.25f * static_cast<float>(t));
    if (p.ended(0)) break;
  }
}

TEST(PoolStep, ActionsAreClippedAndTheBufferIsNotTouched) {
  TestPool p("toy_push", 1, {}, mode(Autoreset::kSameStep));
  p->reset(nullptr, nullptr);
  p.action(0)[0] = -7;
  p.action(0)[1] = 3;
  p->step(nullptr);
  EXPECT_EQ(p.obs(0)[6], -1);
  EXPECT_EQ(p.obs(0)[7], 1);
  EXPECT_EQ(p.rows().reward[0], 1);
  EXPECT_EQ(p.action(0)[0], -7);
}

TEST(PoolStep, SameStepGivesTheFreshObservationAndKeepsTheLast) {
  TestPool p("toy_push", 1, {}, mode(Autoreset::kSameStep));
  p->reset(nullptr, nullptr);
  p.action(0)[1] = 1;
  const auto first = row(p.obs(0));
  for (int t = 1; t < 10; ++t) {
    p->step(nullptr);
    EXPECT_EQ(row(p.obs(0)), row(p.final_obs(0)));
    EXPECT_FALSE(p.ended(0));
  }
  p->step(nullptr);
  EXPECT_TRUE(p.rows().truncated[0]);
  EXPECT_FALSE(p.rows().terminated[0]);
  EXPECT_EQ(p.rows().reward[0], 1);
  EXPECT_EQ(p.rows().episode_return[0], 10);
  EXPECT_EQ(p.rows().episode_step[0], 10);
  EXPECT_EQ(p.final_obs(0)[7], 1);  // the action of the last step
  EXPECT_EQ(p.obs(0)[7], 0);
  EXPECT_NE(p.obs(0)[0], first[0]);  // a new draw
  p->step(nullptr);
  EXPECT_FALSE(p.ended(0));
  EXPECT_EQ(p.rows().episode_return[0], 1);
  EXPECT_EQ(p.rows().episode_step[0], 1);
}

TEST(PoolStep, NextStepSpendsOneStepOnTheReset) {
  TestPool p("toy_push", 1, {}, mode(Autoreset::kNextStep));
  p->reset(nullptr, nullptr);
  p.action(0)[1] = 1;
  for (int t = 1; t <= 10; ++t) p->step(nullptr);
  EXPECT_TRUE(p.rows().truncated[0]);
  EXPECT_EQ(p.obs(0)[7], 1);
  EXPECT_EQ(row(p.obs(0)), row(p.final_obs(0)));
  p.action(0)[0] = NAN;  // the action of the reset step does not count
  p->step(nullptr);
  EXPECT_FALSE(p.ended(0));
  EXPECT_EQ(p.rows().status[0], 0u);
  EXPECT_EQ(p.rows().reward[0], 0);
  EXPECT_EQ(p.cost(0)[1], 0);
  EXPECT_EQ(p.rows().episode_step[0], 0);
  EXPECT_EQ(p.rows().episode_return[0], 0);
  EXPECT_EQ(p.obs(0)[7], 0);
  EXPECT_EQ(row(p.obs(0)), row(p.final_obs(0)));
  p.action(0)[0] = 0;
  p->step(nullptr);
  EXPECT_EQ(p.rows().reward[0], 1);
}

TEST(PoolStep, OffWaitsForTheHost) {
  TestPool p("toy_push", 2, {{"max_steps", nullptr, 3}}, mode(Autoreset::kOff));
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 3; ++t) p->step(nullptr);
  EXPECT_TRUE(p.rows().truncated[0]);
  const auto last = row(p.obs(0));
  EXPECT_EQ(code_of([&] { p->step(nullptr); }), Code::kState);
  const uint8_t first[] = {1, 0}, second[] = {0, 1};
  p->reset(nullptr, first);
  EXPECT_NE(row(p.obs(0)), last);
  EXPECT_FALSE(p.ended(0));
  EXPECT_TRUE(p.ended(1));  // not reset: its rows stay
  EXPECT_EQ(code_of([&] { p->step(second); }), Code::kState);
  p->step(first);
  EXPECT_EQ(p.rows().episode_step[0], 1);
  EXPECT_EQ(p.rows().episode_step[1], 3);
}

TEST(PoolStep, TerminationIsNotTruncation) {
  TestPool p("toy_push", 1, {{"max_steps", nullptr, 100}}, mode(Autoreset::kSameStep));
  p->reset(nullptr, nullptr);
  p.action(0)[0] = 1;
  int steps = 0;
  bool success = false;
  do {
    p->step(nullptr);
    ++steps;
    success = success || p.rows().success[0];
  } while (!p.ended(0) && steps < 100);
  EXPECT_TRUE(p.rows().terminated[0]);
  EXPECT_FALSE(p.rows().truncated[0]);
  EXPECT_TRUE(p.rows().success[0]);
  EXPECT_TRUE(success);
  EXPECT_GT(p.final_obs(0)[0], 1);
  EXPECT_LT(p.obs(0)[0], 0.1f);
}

TEST(PoolStep, TerminationAtTheTimeLimitIsTerminationAlone) {
  // with this push the ball passes x = 1 in one step
  TestPool p("toy_push", 1, {{"max_steps", nullptr, 1}}, mode(Autoreset::kSameStep));
  p->reset(nullptr, nullptr);
  Motion m;
  m.X.p.x = 2;
  p->world(0).set_body(0, m);
  p->step(nullptr);
  EXPECT_TRUE(p.rows().terminated[0]);
  EXPECT_FALSE(p.rows().truncated[0]);
}

void expect_lost(TestPool& p, uint32_t bit) {
  EXPECT_EQ(p.rows().status[1], bit);
  EXPECT_TRUE(p.rows().truncated[1]);
  EXPECT_FALSE(p.rows().terminated[1]);
  EXPECT_EQ(p.rows().reward[1], 0);
  EXPECT_EQ(p.cost(1)[0], 0);
  EXPECT_EQ(p.cost(1)[1], 0);
}

TEST(PoolStep, ABadActionIsFlaggedAndTheOthersGoOnByteForByte) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    TestPool p("toy_push", 3, {}, mode(Autoreset::kSameStep)),
        clean("toy_push", 3, {}, mode(Autoreset::kSameStep));
    for (TestPool* q : {&p, &clean}) {
      (*q)->reset(nullptr, nullptr);
      (*q)->step(nullptr);
    }
    const auto last = row(p.obs(1));
    p.action(1)[1] = bad;
    p->step(nullptr);
    clean->step(nullptr);
    expect_lost(p, kStatusBadAction);
    EXPECT_EQ(row(p.final_obs(1)), last);
    for (const int env : {0, 2}) EXPECT_EQ(p->hash(env), clean->hash(env));
    p.action(1)[1] = 0;
    p->step(nullptr);
    EXPECT_EQ(p.rows().status[1], 0u);
    EXPECT_EQ(p.rows().episode_step[1], 1);
  }
}

TEST(PoolStep, ADivergedWorldIsFlaggedCountedAndReset) {
  for (const char* how : {"nan_at", "blast_at", "huge_at"}) {
    TestPool p("toy_push", 2, {{how, nullptr, 4}}, mode(Autoreset::kSameStep));
    p->reset(nullptr, nullptr);
    for (int t = 0; t < 3; ++t) p->step(nullptr);
    EXPECT_FALSE(p.ended(1));
    p.action(1)[0] = 1;
    const auto last = row(p.obs(1));
    p->step(nullptr);
    expect_lost(p, kStatusDiverged);
    EXPECT_EQ(row(p.final_obs(1)), last);
    EXPECT_EQ(p.rows().episode_cost[3], 0.75f);
    EXPECT_EQ(p->stats().diverged, 2);
    for (const float x : row(p.obs(1))) EXPECT_TRUE(std::isfinite(x));
    p->step(nullptr);
    EXPECT_EQ(p.rows().status[1], 0u) << how;
    EXPECT_EQ(p.rows().episode_step[1], 1);
  }
}

TEST(PoolStep, AnErrorInAWorkerComesOutOfStep) {
  PoolConfig c = mode(Autoreset::kSameStep);
  c.num_threads = 2;
  TestPool p("toy_push", 4, {{"throw_at", nullptr, 2}}, c);
  p->reset(nullptr, nullptr);
  p->step(nullptr);
  EXPECT_EQ(code_of([&] { p->step(nullptr); }), Code::kInternal);
  EXPECT_STREQ(last_error(), "the toy throws");
}

// World 1 is a step ahead, so that it throws alone.
TEST(PoolStep, AnErrorOfOneWorldStopsNoOther) {
  for (const int32_t group : {1, 2, 4}) {
    PoolConfig c = mode(Autoreset::kSameStep);
    c.group_size = group;
    TestPool p("toy_push", 4, {{"throw_at", nullptr, 2}}, c);
    p->reset(nullptr, nullptr);
    const uint8_t ahead[] = {0, 1, 0, 0};
    p->step(ahead);
    EXPECT_EQ(code_of([&] { p->step(nullptr); }), Code::kInternal);
    for (int env = 0; env < 4; ++env) EXPECT_EQ(p.rows().episode_step[env], 1) << group << " " << env;
    for (const int env : {0, 2, 3}) EXPECT_EQ(p.rows().episode_cost[2 * env + 1], 0.25f) << env;
  }
}

// What a host can see after steps with masks, bad actions and worlds that break and end at different times.
std::vector<unsigned char> history(Autoreset autoreset, const char* end, int32_t group, int32_t threads) {
  PoolConfig c = mode(autoreset, 5);
  c.group_size = group;
  c.num_threads = threads;
  constexpr int kWorlds = 11;
  TestPool p("toy_push", kWorlds, {{end, nullptr, 7}}, c);
  p->reset(nullptr, nullptr);
  Stream stream(1, 0, Purpose::kTest);
  std::vector<unsigned char> seen;
  const auto see = [&](const void* from, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(from);
    seen.insert(seen.end(), bytes, bytes + size);
  };
  for (int t = 0; t < 60; ++t) {
    p->baseline(Baseline::kRandom);
    uint8_t mask[kWorlds];
    for (uint8_t& on : mask) on = stream.below(3) > 0;
    if (stream.below(2)) p.action(static_cast<int>(stream.below(kWorlds)))[0] = NAN;
    p->step(t % 3 ? mask : nullptr);
    const Buffers& b = p.rows();
    see(b.obs, sizeof(float) * kWorlds * kToyObs);
    see(b.final_obs, sizeof(float) * kWorlds * kToyObs);
    see(b.reward, sizeof(float) * kWorlds);
    see(b.episode_return, sizeof(float) * kWorlds);
    for (const float* costs : {b.cost, b.cost_raw, b.episode_cost})
      see(costs, sizeof(float) * kWorlds * kToyCosts);
    see(b.episode_step, sizeof(int32_t) * kWorlds);
    see(b.status, sizeof(uint32_t) * kWorlds);
    for (const uint8_t* flags : {b.terminated, b.truncated, b.success}) see(flags, kWorlds);
  }
  const auto state = p.state();
  see(state.data(), state.size());
  return seen;
}

TEST(PoolStep, GroupsGiveTheSameBytes) {
  for (const Autoreset autoreset : {Autoreset::kSameStep, Autoreset::kNextStep})
    for (const char* end : {"nan_at", "max_steps"}) {
      const auto alone = history(autoreset, end, 1, 0);
      for (const int32_t group : {0, 2, 3, 4, 8, 11, 100})
        for (const int32_t threads : {0, 3})
          EXPECT_TRUE(history(autoreset, end, group, threads) == alone) << group << " " << threads;
    }
}

TEST(PoolStep, MaskedWorldsStandStill) {
  TestPool p("toy_push", 2, {}, mode(Autoreset::kSameStep));
  p->reset(nullptr, nullptr);
  p.action(0)[0] = p.action(1)[0] = 1;
  const uint8_t first[] = {1, 0};
  const uint64_t before = p->hash(1);
  const auto obs = row(p.obs(1));
  p->step(first);
  EXPECT_EQ(p.rows().episode_step[0], 1);
  EXPECT_EQ(p.rows().episode_step[1], 0);
  EXPECT_EQ(p->hash(1), before);
  EXPECT_EQ(row(p.obs(1)), obs);
  EXPECT_EQ(p.cost(1)[1], 0);
}

TEST(PoolStep, ASeedNamesWhatThePoolOfOneWorldCreatedWithItHas) {
  TestPool one("toy_push", 1, {}, mode(Autoreset::kSameStep, 7)),
      many("toy_push", 3, {}, mode(Autoreset::kSameStep, 1));
  many->reset(nullptr, nullptr);
  EXPECT_NE(many.obs(0)[0], many.obs(1)[0]);
  many.action(0)[0] = 1;
  for (int t = 0; t < 5; ++t) many->step(nullptr);
  many->baseline(Baseline::kRandom);
  const uint64_t seeds[] = {8, 7, 7};
  many->reset(seeds, nullptr);
  // and goes on with: the second episode is drawn from the same stream
  for (int episode = 0; episode < 2; ++episode) {
    one->reset(nullptr, nullptr);
    if (episode > 0) many->reset(nullptr, nullptr);
    EXPECT_EQ(many->hash(1), one->hash(0));
    EXPECT_EQ(many->hash(2), one->hash(0));
    EXPECT_NE(many->hash(0), one->hash(0));
    one->baseline(Baseline::kRandom);
    many->baseline(Baseline::kRandom);
    for (const int world : {1, 2})
      for (int k = 0; k < kToyActions; ++k) EXPECT_EQ(many.action(world)[k], one.action(0)[k]);
  }
}

TEST(PoolStep, ResetClearsAllRows) {
  TestPool p("toy_push", 1, {}, mode(Autoreset::kOff));
  p->reset(nullptr, nullptr);
  p.action(0)[1] = 1;
  for (int t = 0; t < 10; ++t) p->step(nullptr);
  p->reset(nullptr, nullptr);
  const Buffers& b = p.rows();
  EXPECT_EQ(b.reward[0], 0);
  EXPECT_EQ(b.cost[0] + b.cost[1] + b.cost_raw[0] + b.cost_raw[1], 0);
  EXPECT_EQ(b.episode_return[0] + b.episode_cost[0] + b.episode_cost[1], 0);
  EXPECT_EQ(b.episode_step[0] + b.terminated[0] + b.truncated[0] + b.success[0], 0);
  EXPECT_EQ(b.status[0], 0u);
  EXPECT_EQ(row(p.obs(0)), row(p.final_obs(0)));
}

TEST(PoolStep, Baselines) {
  TestPool p("toy_push", 2, {}, mode(Autoreset::kSameStep));
  p->baseline(Baseline::kHold);
  EXPECT_EQ(p.action(1)[1], 0.125f);
  p->baseline(Baseline::kZero);
  EXPECT_EQ(p.action(1)[1], 0);
  double sum = 0, least = 1, most = -1;
  constexpr int kDraws = 5000;
  for (int i = 0; i < kDraws; ++i) {
    p->baseline(Baseline::kRandom);
    for (int k = 0; k < 4; ++k) {
      const double a = p.rows().action[k];
      sum += a;
      least = std::min(least, a);
      most = std::max(most, a);
    }
  }
  EXPECT_LT(std::abs(sum / (4 * kDraws)), 4 * 0.5774 / std::sqrt(4.0 * kDraws));
  EXPECT_LT(least, -0.999);
  EXPECT_GT(most, 0.999);
  EXPECT_GE(least, -1);
  EXPECT_LE(most, 1);
}

TEST(PoolStep, ThreadsGiveTheSameBytes) {
  uint64_t hashes[4];
  int at = 0;
  for (const int32_t threads : {0, 1, 2, 4}) {
    PoolConfig c = mode(Autoreset::kSameStep, 3);
    c.num_threads = threads;
    TestPool p("toy_push", 7, {}, c);
    p->reset(nullptr, nullptr);
    for (int t = 0; t < 40; ++t) {
      p->baseline(Baseline::kRandom);
      p->step(nullptr);
    }
    hashes[at++] = p->hash(-1);
  }
  for (int i = 1; i < 4; ++i) EXPECT_EQ(hashes[i], hashes[0]) << i;
}

TEST(PoolStep, AllocatesNothing) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  for (const int32_t threads : {0, 2}) {
    PoolConfig c = mode(Autoreset::kSameStep);
    c.num_threads = threads;
    c.group_size = 3;
    TestPool p("toy_push", 4, {}, c);
    const int64_t before = heap_count();
    p->reset(nullptr, nullptr);
    for (int t = 0; t < 30; ++t) {
      p->baseline(Baseline::kRandom);
      p->step(nullptr);
    }
    EXPECT_EQ(heap_count(), before);
  }
}

}  // namespace
}  // namespace rdm::test

// What a world shows and does less exactly than it could: noise, bias, delay and drop-out of fields, late
// actions, costs that end an episode.
#include <algorithm>
#include <string>

#include "heap_count.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

// The toy's fields: ball.position (0 to 2), ball.velocity (3 to 5), action (6, 7: the one carried out).
// Nothing is pushed here, so that every episode has its 10 steps.
constexpr int kAction = 6, kReward = 7;

PoolConfig config(const char* settings, Autoreset autoreset = Autoreset::kSameStep, uint64_t seed = 0) {
  register_toy();
  PoolConfig c;
  c.settings = settings;
  c.autoreset = autoreset;
  c.seed = seed;
  return c;
}

void draw_actions(TestPool& p) {
  p->baseline(Baseline::kRandom);
  for (int32_t env = 0; env < p->config().num_envs; ++env) p.action(env)[0] = 0;
}
void run(TestPool& p, int steps) {
  for (int t = 0; t < steps; ++t) {
    draw_actions(p);
    p->step(nullptr);
  }
}

// Steps all worlds of both with the same actions.
void run_both(TestPool& a, TestPool& b, int steps) {
  for (int t = 0; t < steps; ++t) {
    draw_actions(a);
    draw_actions(b);
    a->step(nullptr);
    b->step(nullptr);
  }
}

TEST(Disturbance, WithoutOptionsNothingIsAdded) {
  TestPool plain("toy_push", 2, {}, config(nullptr)),
      off("toy_push", 2, {}, config("noise.*=0\naction_delay=0\nend_on_cost=false"));
  plain->reset(nullptr, nullptr);
  off->reset(nullptr, nullptr);
  run_both(plain, off, 25);
  EXPECT_EQ(plain->state_size(-1), off->state_size(-1));
  EXPECT_EQ(plain->hash(-1), off->hash(-1));
}

TEST(Disturbance, NoiseHasItsDeviationAndIsNewInEachStep) {
  constexpr int kEnvs = 400;
  TestPool plain("toy_push", kEnvs, {}, config(nullptr));
  TestPool noisy("toy_push", kEnvs, {}, config("noise.ball.position=0.25"));
  plain->reset(nullptr, nullptr);
  noisy->reset(nullptr, nullptr);
  double sum = 0, squares = 0, product = 0;
  int count = 0;
  std::vector<double> last(kEnvs * 3);
  for (int t = 0; t < 9; ++t) {
    for (int env = 0; env < kEnvs; ++env) {
      EXPECT_EQ(std::memcmp(plain.obs(env) + 3, noisy.obs(env) + 3, 5 * sizeof(float)), 0);
      for (int i = 0; i < 3; ++i, ++count) {
        const double e = static_cast<double>(noisy.obs(env)[i]) - static_cast<double>(plain.obs(env)[i]);
        double& before = last[static_cast<size_t>(3 * env + i)];
        sum += e, squares += e * e, product += e * before;
        before = e;
      }
    }
    run_both(plain, noisy, 1);
    EXPECT_EQ(std::memcmp(plain.rows().reward, noisy.rows().reward, kEnvs * sizeof(float)), 0);
    EXPECT_EQ(std::memcmp(noisy.rows().obs, noisy.rows().final_obs, kEnvs * kToyObs * sizeof(float)), 0);
  }
  EXPECT_NEAR(sum / count, 0, 0.01);
  EXPECT_NEAR(std::sqrt(squares / count), 0.25, 0.005);
  EXPECT_NEAR(product / count, 0, 0.003);
}

TEST(Disturbance, ABiasIsConstantInAnEpisodeAndDrawnAtItsReset) {
  constexpr int kEnvs = 300;
  TestPool plain("toy_push", kEnvs, {}, config(nullptr));
  TestPool off("toy_push", kEnvs, {}, config("bias.action=0.5"));
  plain->reset(nullptr, nullptr);
  off->reset(nullptr, nullptr);
  const auto error = [&](int env, int i) {
    return static_cast<double>(off.obs(env)[i]) - static_cast<double>(plain.obs(env)[i]);
  };
  std::vector<double> first;
  double squares = 0, most = 0;
  for (int env = 0; env < kEnvs; ++env)
    for (int i = kAction; i < kToyObs; ++i) {
      first.push_back(error(env, i));
      squares += first.back() * first.back();
      most = std::max(most, std::abs(first.back()));
    }
  EXPECT_LE(most, 0.5);
  EXPECT_GT(most, 0.48);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(first.size())), 0.5 / std::sqrt(3.0), 0.02);
  run_both(plain, off, 5);
  for (int env = 0; env < kEnvs; ++env)
    for (int i = 0; i < 2; ++i)
      EXPECT_NEAR(error(env, kAction + i), first[static_cast<size_t>(2 * env + i)], 1e-6);
  run_both(plain, off, 5);  // into the next episode
  int same = 0;
  for (int env = 0; env < kEnvs; ++env)
    same += std::abs(error(env, kAction) - first[static_cast<size_t>(2 * env)]) < 1e-3;
  EXPECT_LE(same, 3);
}

TEST(Disturbance, ALateFieldShowsWhatItWasAndNothingBeforeTheReset) {
  for (const int delay : {1, 3, 16}) {
    TestPool p("toy_push", 1, {}, config(("delay.action=" + std::to_string(delay)).c_str()));
    p->reset(nullptr, nullptr);
    for (int episode = 0; episode < 2; ++episode) {
      EXPECT_EQ(p.obs(0)[kReward], 0);  // of the reset
      std::vector<float> given = {0};
      for (int t = 1; t <= 10; ++t) {
        given.push_back(0.01f * static_cast<float>(10 * episode + t));
        p.action(0)[1] = given.back();
        p->step(nullptr);
        EXPECT_EQ(p.final_obs(0)[kReward], given[static_cast<size_t>(std::max(t - delay, 0))]) << t;
        EXPECT_EQ(p.ended(0), t == 10);
      }
    }
  }
}

TEST(Disturbance, AFieldThatDropsOutStaysAsItWasShown) {
  TestPool frozen("toy_push", 1, {}, config("dropout.action=1\nnoise.action=0.5"));
  frozen->reset(nullptr, nullptr);
  const float shown[2] = {frozen.obs(0)[kAction], frozen.obs(0)[kReward]};
  EXPECT_NE(shown[0], 0);
  run(frozen, 9);
  EXPECT_EQ(std::memcmp(frozen.obs(0) + kAction, shown, sizeof shown), 0);
  run(frozen, 1);
  EXPECT_EQ(std::memcmp(frozen.final_obs(0) + kAction, shown, sizeof shown), 0);
  EXPECT_NE(frozen.obs(0)[kAction], shown[0]);  // a new episode

  constexpr int kEnvs = 500;
  TestPool p("toy_push", kEnvs, {}, config("dropout.action=0.3"));
  p->reset(nullptr, nullptr);
  std::vector<float> before(kEnvs);
  int kept = 0, steps = 0;
  for (int t = 1; t <= 9; ++t) {
    for (int env = 0; env < kEnvs; ++env) before[static_cast<size_t>(env)] = p.obs(env)[kReward];
    run(p, 1);
    for (int env = 0; env < kEnvs; ++env, ++steps) {
      const float now = p.obs(env)[kReward];
      const bool stays = now == before[static_cast<size_t>(env)];
      kept += stays;
      EXPECT_TRUE(stays || now == p.action(env)[1]);
    }
  }
  EXPECT_NEAR(static_cast<double>(kept) / steps, 0.3, 0.03);
}

TEST(Disturbance, ARangeIsDrawnPerWorldAndEpisode) {
  constexpr int kEnvs = 300;
  TestPool p("toy_push", kEnvs, {}, config("delay.action=2..4"));
  int seen[5] = {}, moved = 0;
  std::vector<int> delay(kEnvs), last(kEnvs);
  for (int episode = 0; episode < 2; ++episode) {
    p->reset(nullptr, nullptr);
    for (int t = 1; t <= 5; ++t) {
      for (int env = 0; env < kEnvs; ++env) p.action(env)[1] = 0.1f * static_cast<float>(t);
      p->step(nullptr);
    }
    for (int env = 0; env < kEnvs; ++env) {
      const int d = 5 - static_cast<int>(std::lround(10 * p.obs(env)[kReward]));
      ASSERT_TRUE(d >= 2 && d <= 4);
      ++seen[d];
      delay[static_cast<size_t>(env)] = d;
      moved += episode == 1 && d != last[static_cast<size_t>(env)];
    }
    last = delay;
  }
  for (int d = 2; d <= 4; ++d) EXPECT_NEAR(seen[d], 200, 50) << d;
  EXPECT_NEAR(moved, 200, 50);
}

TEST(Disturbance, LaterLinesWinAndPatternsMeetSeveralFields) {
  TestPool plain("toy_push", 1, {}, config(nullptr));
  TestPool p("toy_push", 1, {},
             config("noise.BALL.*=1\nnoise.action=5\nnoise.ball.position=0\nnoise.*ction=0"));
  plain->reset(nullptr, nullptr);
  p->reset(nullptr, nullptr);
  for (int i = 0; i < kToyObs; ++i) EXPECT_EQ(p.obs(0)[i] == plain.obs(0)[i], i < 3 || i >= kAction) << i;
}

TEST(Disturbance, AFieldThatIsNoneIsNamed) {
  register_toy();
  const auto text_of = [](const char* settings) {
    EXPECT_EQ(code_of([&] { TestPool p("toy_push", 1, {}, config(settings)); }), Code::kNotFound) << settings;
    return std::string(last_error());
  };
  EXPECT_EQ(text_of("noise.ball.positon=0.1"),
            "toy_push option noise.ball.positon: no field of the observation has this name; nearest is "
            "ball.position");
  EXPECT_EQ(text_of("delay.cube.*=1"),
            "toy_push option delay.cube.*: no field of the observation has this name");
  EXPECT_EQ(text_of("nose.action=1"), "toy_push option nose.action: unknown; nearest is noise.FIELD");
  for (const char* bad : {"delay.action=17", "delay.action=0.5", "dropout.action=1.5", "noise.action=-1",
                          "bias.action=0.2..0.1", "action_delay=17", "action_delay=1..17", "end_on_cost=2"})
    EXPECT_EQ(code_of([&] { TestPool p("toy_push", 1, {}, config(bad)); }), Code::kRange) << bad;
  EXPECT_EQ(code_of([&] { TestPool p("toy_push", 1, {}, config("end_on_cost=0..1")); }), Code::kArgument);
}

TEST(Disturbance, ALateActionIsCarriedOutAfterTheHoldAction) {
  for (const int delay : {1, 4, 16}) {
    TestPool p("toy_push", 1, {}, config(("action_delay=" + std::to_string(delay)).c_str()));
    p->reset(nullptr, nullptr);
    for (int episode = 0; episode < 2; ++episode) {
      std::vector<float> given;
      for (int t = 1; t <= 10; ++t) {
        given.push_back(0.01f * static_cast<float>(10 * episode + t));
        p.action(0)[1] = given.back();
        p->step(nullptr);
        const float done = t > delay ? given[static_cast<size_t>(t - 1 - delay)] : 0.125f;
        EXPECT_EQ(p.final_obs(0)[kReward], done) << t;
        EXPECT_EQ(p.rows().reward[0], done) << t;
      }
    }
  }
}

TEST(Disturbance, ACostEndsTheEpisodeWhereItIsAskedTo) {
  TestPool p("toy_push", 1, {}, config("end_on_cost=true\nmax_steps=50"));
  p->reset(nullptr, nullptr);
  for (int t = 1; t <= 7; ++t) {
    p.action(0)[0] = t == 7 ? 0.6f : 0;  // column 1 costs in each step, and has no limit
    p->step(nullptr);
    EXPECT_EQ(p.rows().terminated[0], t == 7) << t;
    EXPECT_FALSE(p.rows().truncated[0]);
    EXPECT_EQ(p.cost(0)[0], t == 7);
  }
  EXPECT_EQ(p.rows().episode_step[0], 7);
  EXPECT_EQ(p.final_obs(0)[kAction], 0.6f);
  EXPECT_EQ(p.obs(0)[kAction], 0);
}

TEST(Disturbance, WhatIsRepeatedIsDelayedByControlSteps) {
  TestPool p("toy_push", 1, {}, config("action_repeat=4\naction_delay=2\ndelay.action=1"));
  p->reset(nullptr, nullptr);
  p.action(0)[1] = 0.25f;
  p->step(nullptr);
  EXPECT_EQ(p.obs(0)[kReward], 0.25f);  // given at 0 to 3, done at 2 and 3, seen of 2
  p.action(0)[1] = 0.5f;
  p->step(nullptr);
  EXPECT_EQ(p.obs(0)[kReward], 0.5f);
}

constexpr const char* kAll =
    "noise.*=0.01..0.2\nbias.ball.*=0.1\ndelay.ball.position=0..5\ndelay.action=3\ndropout.*=0.2\naction_"
    "delay=0..3";

TEST(Disturbance, TheBytesAreThoseOfAnyNumberOfThreads) {
  TestPool one("toy_push", 7, {}, config(kAll));
  PoolConfig more = config(kAll);
  more.num_threads = 3;
  TestPool three("toy_push", 7, {}, more);
  one->reset(nullptr, nullptr);
  three->reset(nullptr, nullptr);
  run(one, 33);
  run(three, 33);
  EXPECT_EQ(one->hash(-1), three->hash(-1));
  EXPECT_EQ(std::memcmp(one.rows().final_obs, three.rows().final_obs, sizeof(float) * 7 * kToyObs), 0);
  // a world by itself is as it is among others
  TestPool alone("toy_push", 1, {}, config(kAll, Autoreset::kSameStep, 77));
  TestPool named("toy_push", 3, {}, config(kAll));
  const uint64_t seeds[] = {5, 77, 9};
  alone->reset(nullptr, nullptr);
  named->reset(seeds, nullptr);
  run(alone, 15);
  run(named, 15);
  EXPECT_EQ(alone->hash(0), named->hash(1));
}

TEST(Disturbance, ASavedStateGoesOnWithTheSameBytes) {
  for (const Autoreset mode : {Autoreset::kSameStep, Autoreset::kNextStep}) {
    TestPool a("toy_push", 3, {}, config(kAll, mode, 5)), b("toy_push", 3, {}, config(kAll, mode, 9));
    a->reset(nullptr, nullptr);
    run(a, 17);
    const auto state = a.state();
    b->set_state(-1, state.data(), state.size());
    EXPECT_EQ(a->hash(-1), b->hash(-1));
    EXPECT_EQ(std::memcmp(a.rows().obs, b.rows().obs, sizeof(float) * 3 * kToyObs), 0);
    run(a, 23);
    run(b, 23);
    EXPECT_EQ(a->hash(-1), b->hash(-1));
    EXPECT_EQ(std::memcmp(a.rows().obs, b.rows().obs, sizeof(float) * 3 * kToyObs), 0);
  }
  TestPool a("toy_push", 1, {}, config(kAll)), plain("toy_push", 1, {}, config(nullptr));
  const auto state = a.state();
  EXPECT_EQ(code_of([&] { plain->set_state(-1, state.data(), state.size()); }), Code::kFormat);
  EXPECT_STREQ(last_error(), "state: it belongs to a pool of task toy_push with other options");
}

TEST(Disturbance, AStateWithWhatNoWorldDrawsIsRefused) {
  TestPool p("toy_push", 1, {},
             config("noise.action=0.1..0.2\nbias.action=0.1\ndelay.action=1..2\ndropout.action=0.5\naction_"
                    "delay=1..2"));
  p->reset(nullptr, nullptr);
  run(p, 3);
  const auto good = p.state();
  Reader in(good.data(), good.size(), "state");
  in.begin_file("RDMSTATE", 2);
  in.need_section("WRLD");
  const size_t size = in.left(), begin = static_cast<size_t>(in.view(size) - good.data());
  // noise, bias [2], delay, ring [3][2], drop-out, shown [2], of the action delay and ring [3][2]
  constexpr size_t kNumbers = 1 + 2 + 1 + 6 + 1 + 2 + 1 + 6;
  const size_t numbers = begin + size - kNumbers * sizeof(float);
  const auto set = [&](size_t i, float x) {
    auto bad = good;
    std::memcpy(bad.data() + numbers + i * sizeof x, &x, sizeof x);
    const uint32_t crc = crc32(bad.data() + begin, size);
    std::memcpy(bad.data() + begin - 12, &crc, sizeof crc);
    return code_of([&] { p->set_state(-1, bad.data(), bad.size()); });
  };
  const uint64_t before = p->hash(-1);
  struct Case {
    size_t at;
    float x;
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const Case& c : {Case{0, 0.05f},
                        {0, 0.3f},
                        {0, kNan},
                        {1, 0.2f},
                        {2, -0.2f},
                        {3, 0},
                        {3, 1.5f},
                        {3, 3},
                        {3, 1e9f},
                        {4, kNan},
                        {10, 0.6f},
                        {11, kNan},
                        {13, 3},
                        {13, -1},
                        {14, 1.5f},
                        {19, kNan}}) {
    EXPECT_EQ(set(c.at, c.x), Code::kFormat) << c.at << ' ' << c.x;
    EXPECT_STREQ(last_error(), "state: a disturbance is outside of what its options allow");
  }
  EXPECT_EQ(p->hash(-1), before);
  EXPECT_EQ(set(0, 0.15f), Code::kOk);
}

TEST(Disturbance, StepsTakeNoMemory) {
  TestPool p("toy_push", 4, {}, config(kAll));
  p->reset(nullptr, nullptr);
  run(p, 12);
  const int64_t before = heap_count();
  run(p, 1);
  EXPECT_EQ(heap_count(), before);
}

}  // namespace
}  // namespace rdm::test

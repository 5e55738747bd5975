// rdm_planner_*: plans that are near the optimum of a known problem, within its limit, the same for any
// threads and after a saved state; each method's move against the formula, each refusal; what a call does that
// is stopped or cancelled.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <limits>
#include <thread>

#include "base/rng.hpp"
#include "contract.hpp"
#include "heap_count.hpp"
#include "owned.hpp"
#include "planners.hpp"

namespace {

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

Pool pool_of(const char* task, const char* settings = "", int32_t envs = 1, uint64_t seed = 1,
             int32_t threads = 0, int32_t autoreset = RDM_AUTORESET_OFF) {
  rdm_pool_config c = pool_config(envs);
  c.task = task;
  c.settings = settings;
  c.seed = seed;
  c.num_threads = threads;
  c.autoreset = autoreset;
  Pool p(make_pool(c));
  EXPECT_EQ(rdm_pool_reset(p.get(), nullptr, nullptr), RDM_OK);
  return p;
}

rdm_planner_config config_of(const Pool& pool, const char* settings) {
  rdm_planner_config c;
  EXPECT_EQ(rdm_planner_config_init(&c, sizeof c), RDM_OK);
  c.pool = pool.get();
  c.settings = settings;
  c.seed = 7;
  return c;
}
Planner planner_of(const rdm_planner_config& c) {
  rdm_planner* p = nullptr;
  EXPECT_EQ(rdm_planner_create(&p, &c), RDM_OK) << rdm_last_error();
  return Planner(p);
}
Planner planner_of(const Pool& pool, const char* settings) {
  return planner_of(config_of(pool, settings));
}

rdm_plan_info act(const Planner& planner, const Pool& pool, float* action) {
  rdm_plan_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(rdm_planner_act(planner.get(), pool.get(), 0, action, &info), RDM_OK)
      << rdm_planner_error(planner.get());
  return info;
}

struct Played {
  double ret = 0, cost = 0;
  int32_t steps = 0;
};
// An episode of world 0 by planning; no planner: by zero.
Played play(const Pool& pool, const Planner& planner) {
  const rdm_buffers b = buffers_of(pool.get());
  while (!b.terminated[0] && !b.truncated[0]) {
    if (planner)
      act(planner, pool, b.action);
    else
      EXPECT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_ZERO), RDM_OK);
    EXPECT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  }
  return {static_cast<double>(b.episode_return[0]), static_cast<double>(b.episode_cost[0]),
          b.episode_step[0]};
}

// lqr_line without noise: x' = x + a, reward -(x^2 + 0.1 a^2), 20 steps from x0. Its optimum is -P x0^2.
constexpr const char* kLine = "noise=0";
double optimum(double x0) {
  double p = 1;  // the last step's a is 0
  for (int i = 1; i < 20; ++i) p = 1 + 0.1 * p / (0.1 + p);
  return -p * x0 * x0;
}
double start_of(const Pool& pool) {
  return static_cast<double>(buffers_of(pool.get()).obs[0]);
}

TEST(Plans, AreNearTheOptimumByEveryMethod) {
  struct Case {
    const char* settings;
    double slack;  // what the last noise costs
  };
  for (const Case& test : {Case{"method=predictive\nnoise=0.05", 0.15},
                           {"method=cem\nnoise=0.2\nelites=16\nnoise_min=0.002", 0.02},
                           {"method=mppi\nnoise=0.05\ntemperature=0.1", 0.02}})
    for (const char* interpolation : {"zero", "linear", "cubic"})
      for (const uint64_t seed : {1, 2, 3}) {
        const Pool pool = pool_of("lqr_line", kLine, 1, seed);
        const double x0 = start_of(pool), best = optimum(x0);
        const std::string settings =
            std::string(test.settings) + "\ninterpolation=" + interpolation +
            "\nsamples=128\niterations=8\nhorizon=6\ncosts=ignore\nknots=" +
            (std::string(interpolation) == "zero" ? "6" : "4");  // its pieces must be single steps
        const Played played = play(pool, planner_of(pool, settings.c_str()));
        EXPECT_GE(played.ret, 1.05 * best - test.slack) << settings << " seed " << seed << ", x0 " << x0;
        EXPECT_LE(played.ret, best + 1e-4);
        EXPECT_LT(-20 * x0 * x0, 1.05 * best - test.slack);  // by zero
      }
}

TEST(Plans, KeepTheLimitWhereReturnWouldBreakIt) {
  for (const uint64_t seed : {1, 2, 3, 5}) {
    Pool pool = pool_of("lqr_line", kLine, 1, seed);
    const double x0 = start_of(pool), limit = 0.3 * x0 * x0;  // the optimum moves at once: 0.83 x0^2
    rdm_planner_config c = config_of(
        pool, "method=cem\niterations=8\nsamples=128\nhorizon=8\nknots=8\nnoise=0.04\nnoise_min=0.002");
    c.cost_limits = &limit;
    const Played kept = play(pool, planner_of(c));
    EXPECT_LE(kept.cost, limit) << seed;
    EXPECT_GT(kept.ret, -8 * x0 * x0) << seed;  // by zero it is -20
    pool = pool_of("lqr_line", kLine, 1, seed);
    c = config_of(pool, "method=cem\niterations=4\nhorizon=8\nknots=8\nnoise=0.1\ncosts=ignore");
    EXPECT_GT(play(pool, planner_of(c)).cost, limit) << seed;
  }
}

// Without limits of its own a planner keeps the limit that the pool's episode has.
TEST(Plans, KeepTheLimitOfThePool) {
  const Pool pool = pool_of("ball_run", "budget=show\nlimit=0");
  rdm_planner_config c = config_of(pool, "method=cem\nsamples=64\nhorizon=32\niterations=4");
  double none[RDM_MAX_COSTS];
  std::fill_n(none, RDM_MAX_COSTS, -1);
  none[0] = 0;
  std::vector<float> action(2), own(2);
  const rdm_plan_info pools = act(planner_of(c), pool, action.data());
  c.cost_limits = none;
  const rdm_plan_info given = act(planner_of(c), pool, own.data());
  EXPECT_EQ(action, own);
  EXPECT_EQ(pools.cost[0], given.cost[0]);
  EXPECT_EQ(pools.feasible_share, given.feasible_share);
}

TEST(Plans, AMultiplierBuysLessCost) {
  double last = std::numeric_limits<double>::infinity();
  for (const char* multiplier : {"0", "1", "10"}) {
    const Pool pool = pool_of("lqr_line", kLine, 1, 2);
    const std::string settings =
        std::string(
            "method=cem\niterations=4\nhorizon=8\nknots=8\nnoise=0.1\ncosts=multiplier\nmultiplier=") +
        multiplier;
    const double cost = play(pool, planner_of(pool, settings.c_str())).cost;
    EXPECT_LT(cost, 0.95 * last) << multiplier;
    last = cost;
  }
}

// Two steps ahead with one knot: what sample i does and gets is a line of arithmetic.
constexpr const char* kOneStep = "samples=6\nhorizon=2\nknots=1\nnoise=0.1\ncosts=ignore\n";

struct TwoSteps {
  float action[6];
  double ret[6];
  TwoSteps(double x, const float centre[2], float sigma, rdm::Stream& stream, float noise[6]) {
    stream.normals(noise, 6);
    for (int i = 0; i < 6; ++i) {
      noise[i] = i == 0 ? 0 : noise[i] * sigma;
      action[i] = std::clamp(centre[0] + noise[i], -1.0f, 1.0f);
      const double a = 5.0 * static_cast<double>(action[i]),
                   b = 5.0 * static_cast<double>(std::clamp(centre[1] + noise[i], -1.0f, 1.0f));
      ret[i] = -(x * x + 0.1 * a * a) - ((x + a) * (x + a) + 0.1 * b * b);
    }
  }
};

TEST(Methods, PredictiveSamplingTakesTheBest) {
  const Pool pool = pool_of("lqr_line", kLine);
  const Planner planner = planner_of(pool, kOneStep);
  float action = 0;
  const rdm_plan_info info = act(planner, pool, &action);
  rdm::Stream stream(7, 0, rdm::Purpose::kPolicyNoise);
  const float centre[2] = {};
  float noise[6];
  const TwoSteps expected(start_of(pool), centre, 0.1f, stream, noise);
  const auto best = std::max_element(expected.ret, expected.ret + 6) - expected.ret;
  EXPECT_EQ(info.planned, 1);
  EXPECT_EQ(info.best, best);
  EXPECT_NEAR(info.ret, expected.ret[best], 1e-5);
  EXPECT_EQ(action, expected.action[best]);
  EXPECT_EQ(info.steps, 12);
}

TEST(Methods, PathIntegralTakesTheWeightedMean) {
  const Pool pool = pool_of("lqr_line", kLine);
  const Planner planner = planner_of(pool, (std::string(kOneStep) + "method=mppi\ntemperature=0.7").c_str());
  float action = 0;
  act(planner, pool, &action);
  rdm::Stream stream(7, 0, rdm::Purpose::kPolicyNoise);
  const float centre[2] = {};
  float noise[6];
  const TwoSteps s(start_of(pool), centre, 0.1f, stream, noise);
  double mean = 0, square = 0, total = 0, sum = 0;
  for (const double r : s.ret) mean += r / 6;
  for (const double r : s.ret) square += (r - mean) * (r - mean) / 6;
  for (int i = 0; i < 6; ++i) {
    const double w = std::exp((s.ret[i] - mean) / (0.7 * std::sqrt(square)));
    total += w;
    sum += w * static_cast<double>(s.action[i]);
  }
  EXPECT_NEAR(static_cast<double>(action), sum / total, 1e-5);
}

TEST(Methods, CrossEntropyGoesToTheElitesMeanAndTakesTheirDeviation) {
  const Pool pool = pool_of("lqr_line", kLine);
  const Planner planner = planner_of(
      pool, (std::string(kOneStep) + "method=cem\nelites=3\niterations=2\nnoise_min=0.001").c_str());
  float action = 0;
  act(planner, pool, &action);
  rdm::Stream stream(7, 0, rdm::Purpose::kPolicyNoise);
  float centre[2] = {}, sigma = 0.1f, noise[6];
  for (int iteration = 0; iteration < 2; ++iteration) {
    const TwoSteps s(start_of(pool), centre, sigma, stream, noise);
    int order[] = {0, 1, 2, 3, 4, 5};
    std::sort(order, order + 6, [&](int a, int b) { return s.ret[a] > s.ret[b]; });
    double mean = 0, of_noise = 0, square = 0, second = 0;
    for (int e = 0; e < 3; ++e) {
      mean += static_cast<double>(s.action[order[e]]) / 3;
      second += static_cast<double>(std::clamp(centre[1] + noise[order[e]], -1.0f, 1.0f)) / 3;
      of_noise += static_cast<double>(noise[order[e]]) / 3;
    }
    for (int e = 0; e < 3; ++e) {
      const double off = static_cast<double>(noise[order[e]]) - of_noise;
      square += off * off / 3;
    }
    centre[0] = static_cast<float>(mean);
    centre[1] = static_cast<float>(second);
    sigma = static_cast<float>(std::sqrt(square));
  }
  EXPECT_NEAR(action, centre[0], 1e-6);
}

TEST(Rollouts, AreJudgedFeasibleFirst) {
  // limit on a^2 over the episode: a sample is feasible when |5 (a0, a1)|^2 stays within
  const Pool pool = pool_of("lqr_line", kLine);
  const double limit = 0.1;
  rdm_planner_config c = config_of(pool, "samples=6\nhorizon=2\nknots=1\nnoise=0.1");
  c.cost_limits = &limit;
  float action = 0;
  const rdm_plan_info info = act(planner_of(c), pool, &action);
  rdm::Stream stream(7, 0, rdm::Purpose::kPolicyNoise);
  const float centre[2] = {};
  float noise[6];
  const TwoSteps s(start_of(pool), centre, 0.1f, stream, noise);
  int feasible = 0, best = 0;  // sample 0 costs nothing
  for (int i = 0; i < 6; ++i) {
    const double cost = 2 * 25 * static_cast<double>(s.action[i]) * static_cast<double>(s.action[i]);
    if (cost > limit) continue;
    ++feasible;
    if (s.ret[i] > s.ret[best]) best = i;
  }
  ASSERT_GT(feasible, 1);
  ASSERT_LT(feasible, 6);
  EXPECT_EQ(info.best, best);
  EXPECT_NEAR(info.feasible_share, feasible / 6.0, 1e-12);
  EXPECT_LE(info.cost[0], limit);
}

TEST(Rollouts, EndWhereTheEpisodeDoes) {
  const Pool pool = pool_of("lqr_line", "noise=0\nmax_steps=3");
  rdm_planner_config c = config_of(pool, "samples=2\nhorizon=9\ncosts=ignore\ndiscount=0.5");
  const float noise = 0;
  c.noise = &noise;
  float action = 1;
  const rdm_plan_info info = act(planner_of(c), pool, &action);
  const double x = start_of(pool);
  EXPECT_EQ(action, 0);  // lqr_line's initial mean, and no noise
  EXPECT_NEAR(info.ret, -1.75 * x * x, 1e-5);
  EXPECT_EQ(info.steps, 6);
}

TEST(Rollouts, TheBudgetIsWhatTheEpisodeHasLeft) {
  const Pool pool = pool_of("lqr_line", kLine);
  const rdm_buffers b = buffers_of(pool.get());
  const float noise = 0;
  const auto feasible = [&](double limit, const char* budget) {
    rdm_planner_config c = config_of(pool, budget);
    c.noise = &noise;
    c.cost_limits = &limit;
    const Planner planner = planner_of(c);
    const std::vector<float> plan(10, 0.1f);  // costs 0.25 a step
    EXPECT_EQ(rdm_planner_set_plan(planner.get(), plan.data()), RDM_OK);
    float action = 0;
    return act(planner, pool, &action).feasible_share;
  };
  EXPECT_EQ(feasible(2.51, "samples=1\nhorizon=10"), 1);
  EXPECT_EQ(feasible(2.49, "samples=1\nhorizon=10"), 0);
  EXPECT_EQ(feasible(5.01, "samples=1\nhorizon=10\nbudget=share"), 1);  // 10 of 20 steps: half of it
  EXPECT_EQ(feasible(4.99, "samples=1\nhorizon=10\nbudget=share"), 0);
  b.action[0] = 0.2f;  // 1 is spent
  ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  EXPECT_EQ(feasible(3.51, "samples=1\nhorizon=10"), 1);
  EXPECT_EQ(feasible(3.49, "samples=1\nhorizon=10"), 0);
  EXPECT_EQ(feasible(-1, "samples=1\nhorizon=10"), 1);  // no limit
}

TEST(WarmStart, ThePlanIsShiftedByAStep) {
  const Pool pool = pool_of("lqr_line", kLine);
  rdm_planner_config c = config_of(pool, "samples=1\nhorizon=4");
  const Planner planner = planner_of(c);
  const float given[] = {0.1f, -0.2f, 0.3f, 7.0f};
  ASSERT_EQ(rdm_planner_set_plan(planner.get(), given), RDM_OK);
  float action = 0;
  act(planner, pool, &action);
  EXPECT_EQ(action, 0.1f);  // not shifted, and cut
  EXPECT_EQ(plan_of(planner), (std::vector<float>{0.1f, -0.2f, 0.3f, 1.0f}));
  act(planner, pool, &action);
  EXPECT_EQ(action, -0.2f);
  EXPECT_EQ(plan_of(planner), (std::vector<float>{-0.2f, 0.3f, 1.0f, 1.0f}));
  act(planner, pool, &action);
  EXPECT_EQ(action, 0.3f);
  ASSERT_EQ(rdm_planner_reset(planner.get()), RDM_OK);
  act(planner, pool, &action);
  EXPECT_EQ(action, 0);
  const Planner cold = planner_of(pool, "samples=1\nhorizon=4\nwarm_start=false");
  ASSERT_EQ(rdm_planner_set_plan(cold.get(), given), RDM_OK);
  act(cold, pool, &action);
  EXPECT_EQ(action, 0);
}

TEST(WarmStart, APlanIsFollowedBetweenPlans) {
  const Pool pool = pool_of("lqr_line", kLine);
  const Planner planner = planner_of(pool, "samples=16\nhorizon=5\nreplan=3");
  float action = 0;
  std::vector<float> plan;
  for (int i = 0; i < 7; ++i) {
    const rdm_plan_info info = act(planner, pool, &action);
    EXPECT_EQ(info.planned, i % 3 == 0) << i;
    EXPECT_EQ(info.steps > 0, i % 3 == 0) << i;
    if (i % 3 == 0) plan = plan_of(planner);
    EXPECT_EQ(action, plan[sz(i % 3)]) << i;
  }
}

// What a planner of a hand's task does in four steps: actions and its state, for any threads.
std::vector<unsigned char> course_of(int32_t threads, int32_t own_threads) {
  const Pool pool = pool_of("hand_over_safe_finger", "", 1, 3, threads);
  rdm_planner_config c =
      config_of(pool, "method=cem\nsamples=17\nhorizon=5\nknots=3\niterations=2\ninterpolation=cubic");
  c.num_threads = own_threads;
  const Planner planner = planner_of(c);
  const rdm_buffers b = buffers_of(pool.get());
  std::vector<unsigned char> out;
  for (int i = 0; i < 4; ++i) {
    act(planner, pool, b.action);
    const auto* bytes = reinterpret_cast<const unsigned char*>(b.action);
    out.insert(out.end(), bytes, bytes + sizeof(float) * sz(spec_of(pool.get()).action_dim));
    EXPECT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  }
  const auto state = state_of(planner);
  out.insert(out.end(), state.begin(), state.end());
  return out;
}

TEST(Determinism, TheSameBytesForAnyThreads) {
  const auto one = course_of(1, 0);
  EXPECT_EQ(course_of(3, 0), one);
  EXPECT_EQ(course_of(1, 3), one);
}

TEST(Determinism, ASavedPlannerGoesOnWithTheSameBytes) {
  const Pool pool = pool_of("lqr_line", "");
  const char* settings = "method=mppi\nsamples=9\nhorizon=7\nreplan=2\niterations=2";
  const Planner a = planner_of(pool, settings);
  rdm_planner_config c = config_of(pool, settings);
  c.seed = 1234;
  const Planner b = planner_of(c);
  float x = 0, y = 0;
  for (int i = 0; i < 3; ++i) act(a, pool, &x);
  const auto state = state_of(a);
  ASSERT_EQ(rdm_planner_read_state(b.get(), state.data(), state.size()), RDM_OK)
      << rdm_planner_error(b.get());
  for (int i = 0; i < 5; ++i) {
    act(a, pool, &x);
    act(b, pool, &y);
    ASSERT_EQ(x, y) << i;
    ASSERT_EQ(state_of(a), state_of(b)) << i;
  }
}

TEST(Determinism, AStateThatIsNotWholeOrOfAnotherPlannerIsRefused) {
  const Pool pool = pool_of("lqr_line", "");
  const Planner a = planner_of(pool, "samples=3\nhorizon=2"),
                other = planner_of(pool, "samples=3\nhorizon=3");
  float x = 0;
  act(a, pool, &x);
  const auto state = state_of(a);
  const auto before = state_of(other);
  EXPECT_EQ(rdm_planner_read_state(other.get(), state.data(), state.size()), RDM_ERROR_FORMAT);
  EXPECT_NE(std::string(rdm_planner_error(other.get())).find("other options"), std::string::npos);
  EXPECT_EQ(state_of(other), before);
  for (size_t size = 0; size < state.size(); ++size)
    ASSERT_EQ(rdm_planner_read_state(a.get(), state.data(), size), RDM_ERROR_FORMAT) << size;
  for (size_t at = 0; at < state.size(); ++at) {
    auto bad = state;
    bad[at] ^= 0xffu;
    const rdm_result r = rdm_planner_read_state(a.get(), bad.data(), bad.size());
    ASSERT_TRUE(r == RDM_ERROR_FORMAT || r == RDM_ERROR_VERSION_MISMATCH) << at << ' ' << r;
  }
  EXPECT_EQ(state_of(a), state);
  size_t size = 0;
  unsigned char small[8];
  EXPECT_EQ(rdm_planner_write_state(a.get(), small, sizeof small, &size), RDM_ERROR_RANGE);
}

// An agent for the pool, with every weight 0: its policy's mean is what the last bias says.
Agent agent_of(const Pool& pool, const char* settings) {
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool.get()), RDM_OK);
  c.settings = settings;
  return Agent(make_agent(c));
}
// Every number of a network is 0 but the last bias.
void set_output(const Agent& agent, const std::string& net, float value) {
  rdm_tensor t;
  std::string last;
  for (int32_t i = 0; rdm_agent_tensor_at(agent.get(), i, &t) == RDM_OK; ++i) {
    const std::string name = t.name;
    if (name.rfind(net, 0) != 0 || name.find("log_std") != std::string::npos) continue;
    const std::vector<float> zero(sz(t.rows * t.cols));
    ASSERT_EQ(rdm_agent_set_tensor(agent.get(), t.name, zero.data(), zero.size()), RDM_OK);
    if (name.find("bias") != std::string::npos) last = name;
  }
  ASSERT_EQ(rdm_agent_set_tensor(agent.get(), last.c_str(), &value, 1), RDM_OK) << last;
}
Policy policy_of(const Agent& agent) {
  const auto bytes = policy_bytes(agent.get());
  rdm_policy* p = nullptr;
  EXPECT_EQ(rdm_policy_read(&p, bytes.data(), bytes.size()), RDM_OK) << rdm_last_error();
  return Policy(p);
}

// Lets a call ask so many times, then says stop.
struct Patience {
  int64_t left = 0;
  int64_t asked = 0, steps = 0;

  static int32_t stop(void* user, int64_t steps) {
    auto* p = static_cast<Patience*>(user);
    EXPECT_GE(steps, p->asked == 0 ? 0 : p->steps);
    p->steps = steps;
    return p->asked++ >= p->left;
  }
};
Planner planner_of(const Pool& pool, const char* settings, Patience* patience,
                   const rdm_policy* policy = nullptr, int32_t threads = 0) {
  rdm_planner_config c = config_of(pool, settings);
  c.stop = patience ? Patience::stop : nullptr;
  c.user = patience;
  c.policy = policy;
  c.num_threads = threads;
  return planner_of(c);
}
constexpr const char* kMethods[] = {"method=predictive\n", "method=cem\nelites=3\n", "method=mppi\n"};

TEST(Stops, WhatWasFinishedCountsAsIfMoreHadNotBeenAskedFor) {
  for (const char* method : kMethods)
    for (int32_t finished = 1; finished <= 3; ++finished)
      for (int32_t begun = 0; begun < 5; ++begun) {  // steps of the next iteration
        const Pool pool = pool_of("lqr_line", kLine), twin = pool_of("lqr_line", kLine);
        const std::string settings = std::string(method) + "samples=9\nhorizon=5\niterations=";
        Patience patience;
        const Planner cut = planner_of(pool, (settings + "4").c_str(), &patience);
        const Planner fewer = planner_of(twin, (settings + std::to_string(finished)).c_str());
        const rdm_buffers b = buffers_of(pool.get()), t = buffers_of(twin.get());
        for (int call = 0; call < 4; ++call) {
          patience = {5 * finished + begun};
          const rdm_plan_info info = act(cut, pool, b.action), other = act(fewer, twin, t.action);
          ASSERT_EQ(b.action[0], t.action[0]) << settings << finished << ' ' << begun << ' ' << call;
          ASSERT_EQ(plan_of(cut), plan_of(fewer));
          EXPECT_EQ(info.cut, 1);
          EXPECT_EQ(info.planned, 1);
          EXPECT_EQ(info.iterations, finished);
          EXPECT_EQ(info.steps, 9 * (5 * finished + begun));
          EXPECT_EQ(patience.steps, info.steps) << "what it was asked with last";
          EXPECT_EQ(other.cut, 0);
          EXPECT_EQ(other.iterations, finished);
          EXPECT_EQ(info.best, other.best);
          EXPECT_EQ(info.ret, other.ret);
          EXPECT_EQ(info.feasible_share, other.feasible_share);
          ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
          ASSERT_EQ(rdm_pool_step(twin.get()), RDM_OK);
        }
      }
}

TEST(Stops, OnesThatNeverComeChangeNothing) {
  for (const char* method : kMethods) {
    const Pool pool = pool_of("lqr_line", kLine);
    const std::string settings = std::string(method) + "samples=9\nhorizon=5\niterations=3";
    Patience patience{15};
    const Planner asked = planner_of(pool, settings.c_str(), &patience);
    const Planner plain = planner_of(pool, settings.c_str());
    float x = 0, y = 0;
    const rdm_plan_info info = act(asked, pool, &x);
    act(plain, pool, &y);
    EXPECT_EQ(info.cut, 0) << "an answer is asked for before a step, not behind the last one";
    EXPECT_EQ(info.iterations, 3);
    EXPECT_EQ(patience.asked, 15);
    EXPECT_EQ(x, y);
    EXPECT_EQ(state_of(asked), state_of(plain));
  }
}

TEST(Stops, BeforeTheFirstIterationThePlanIsFollowedAndTheNextCallPlans) {
  const Pool pool = pool_of("lqr_line", kLine);
  Patience patience{1000};
  const Planner planner =
      planner_of(pool, "method=cem\nsamples=9\nhorizon=5\nreplan=3\niterations=2", &patience);
  float action = 9;
  patience = {4};  // there is no plan yet
  rdm_plan_info info = act(planner, pool, &action);
  EXPECT_EQ(info.cut, 1);
  EXPECT_EQ(info.planned, 0);
  EXPECT_EQ(info.iterations, 0);
  EXPECT_EQ(info.steps, 36);
  EXPECT_EQ(info.ret, 0);
  ASSERT_EQ(rdm_pool_get_initial_mean(pool.get(), &action), RDM_OK);
  EXPECT_EQ(plan_of(planner), std::vector<float>(5, action));
  patience = {1000};
  EXPECT_EQ(act(planner, pool, &action).planned, 1) << "option replan counts from a plan that was made";
  EXPECT_EQ(act(planner, pool, &action).planned, 0);
  EXPECT_EQ(act(planner, pool, &action).planned, 0);
  std::vector<float> plan = plan_of(planner);
  const auto stream = state_of(planner);
  patience = {0};
  info = act(planner, pool, &action);
  EXPECT_EQ(info.cut, 1);
  EXPECT_EQ(info.steps, 0);
  std::rotate(plan.begin(), plan.begin() + 1, plan.end());
  plan[4] = plan[3];
  EXPECT_EQ(plan_of(planner), plan);
  EXPECT_EQ(action, plan[0]);
  patience = {1000};
  EXPECT_EQ(act(planner, pool, &action).planned, 1);
}

TEST(Stops, AtEachPlaceTheSameBytesForAnyThreads) {
  const auto course = [](int32_t threads, int64_t asks, bool with_policy) {
    const Pool pool = pool_of("hand_over_safe_finger", "max_steps=40");
    const Agent agent = agent_of(pool, "hidden=8");
    const Policy policy = policy_of(agent);
    Patience patience;
    const Planner planner = planner_of(pool, "method=cem\nelites=3\nsamples=6\nhorizon=4\niterations=2",
                                       &patience, with_policy ? policy.get() : nullptr, threads);
    const rdm_buffers b = buffers_of(pool.get());
    std::vector<unsigned char> out;
    for (int call = 0; call < 3; ++call) {
      patience = {call == 1 ? asks : 1000};
      const rdm_plan_info info = act(planner, pool, b.action);
      const auto* bytes = reinterpret_cast<const unsigned char*>(&info);
      out.insert(out.end(), bytes, bytes + sizeof info);
      const auto state = state_of(planner);
      out.insert(out.end(), state.begin(), state.end());
      EXPECT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    }
    return out;
  };
  for (const bool with_policy : {false, true}) {
    std::vector<unsigned char> last;
    for (const int64_t asks : {0, 1, 4, 5, 7, 8}) {
      const auto one = course(1, asks, with_policy);
      EXPECT_EQ(course(2, asks, with_policy), one) << asks;
      EXPECT_NE(one, last) << asks;
      last = one;
    }
  }
}

TEST(Stops, WithoutAPlanThePolicyActs) {
  const Pool pool = pool_of("lqr_line", kLine);
  const Agent agent = agent_of(pool, "hidden=4");
  set_output(agent, "actor", 0.25f);
  const Policy policy = policy_of(agent);
  for (const int64_t asks : {0, 2, 4, 6}) {
    Patience patience{asks};
    const Planner planner = planner_of(pool, "samples=4\nhorizon=5", &patience, policy.get());
    float action = 0;
    const rdm_plan_info info = act(planner, pool, &action);
    EXPECT_EQ(info.cut, 1) << asks;
    EXPECT_EQ(info.iterations, 0);
    EXPECT_EQ(action, 0.25f);
    EXPECT_EQ(plan_of(planner), std::vector<float>(5, 0.25f));
  }
}

TEST(Stops, WhoIsAskedMayNotCallThePlanner) {
  struct Host {
    rdm_planner* planner = nullptr;
    rdm_result inner = RDM_OK;
    static int32_t stop(void* user, int64_t) {
      auto* h = static_cast<Host*>(user);
      h->inner = rdm_planner_reset(h->planner);
      return 0;
    }
  } host;
  const Pool pool = pool_of("lqr_line", kLine);
  rdm_planner_config c = config_of(pool, "samples=3\nhorizon=2");
  c.stop = Host::stop;
  c.user = &host;
  const Planner planner = planner_of(c);
  host.planner = planner.get();
  float action = 0;
  EXPECT_EQ(act(planner, pool, &action).cut, 0);
  EXPECT_EQ(host.inner, RDM_ERROR_STATE);
}

// What a cancelled call leaves: everything as it was, so that the next one is the twin's.
struct Cancelled {
  static constexpr int kMost = 10000;  // questions
  Pool pool = pool_of("lqr_line", kLine);
  std::atomic<int> asked = 0;
  void (*when_asked)(Cancelled*) = nullptr;
  Planner planner, twin;

  explicit Cancelled(void (*then)(Cancelled*)) {
    const char* settings = "method=cem\nsamples=64\nhorizon=20\niterations=1000";
    rdm_planner_config c = config_of(pool, settings);
    c.stop = [](void* user, int64_t) {
      auto* self = static_cast<Cancelled*>(user);
      if (++self->asked == 700 && self->when_asked) self->when_asked(self);
      return self->asked > kMost ? 1 : 0;
    };
    c.user = this;
    planner = planner_of(c);
    when_asked = nullptr;
    twin = planner_of(pool, "method=cem\nsamples=64\nhorizon=20\niterations=1");
    float action = 9;
    asked = kMost - 20;  // one iteration
    EXPECT_EQ(act(planner, pool, &action).cut, 1);
    EXPECT_EQ(act(twin, pool, &action).cut, 0);
    asked = 0;
    when_asked = then;
  }
  void expect_unheard_of() {
    float action = 9;
    rdm_plan_info info{};
    info.struct_size = sizeof info;
    info.best = 77;
    const auto before = state_of(planner);
    EXPECT_EQ(rdm_planner_act(planner.get(), pool.get(), 0, &action, &info), RDM_ERROR_CANCELLED);
    EXPECT_LE(asked, kMost) << "it ended by the stop";
    EXPECT_STREQ(rdm_planner_error(planner.get()), "cancelled by the host");
    EXPECT_EQ(action, 9);
    EXPECT_EQ(info.best, 77);
    EXPECT_EQ(state_of(planner), before);
    // once
    when_asked = nullptr;
    asked = kMost - 20;
    float x = 0, y = 1;
    EXPECT_EQ(act(planner, pool, &x).iterations, 1);
    act(twin, pool, &y);
    EXPECT_EQ(x, y);
    EXPECT_EQ(plan_of(planner), plan_of(twin));
  }
};

TEST(Cancels, FromAnotherThread) {
  static std::atomic<bool> done = false;
  Cancelled c([](Cancelled*) {
    while (!done) std::this_thread::yield();
  });
  std::thread other([&] {
    while (c.asked < 700) std::this_thread::yield();
    rdm_planner_cancel(c.planner.get());
    done = true;
  });
  c.expect_unheard_of();
  other.join();
}

TEST(Cancels, FromASignalHandler) {
  static rdm_planner* planner = nullptr;
  Cancelled c([](Cancelled*) { EXPECT_EQ(std::raise(SIGINT), 0); });
  planner = c.planner.get();
  const auto before = std::signal(SIGINT, [](int) { rdm_planner_cancel(planner); });
  c.expect_unheard_of();
  std::signal(SIGINT, before);
}

TEST(Cancels, OfNothingThatRunsIsHeardByTheNextCall) {
  Cancelled c(nullptr);
  rdm_planner_cancel(c.planner.get());
  c.expect_unheard_of();
  rdm_planner_cancel(nullptr);
}

TEST(Cancels, AFollowedPlanHearsItToo) {
  const Pool pool = pool_of("lqr_line", kLine);
  const Planner planner = planner_of(pool, "samples=3\nhorizon=4\nreplan=4");
  float action = 0;
  EXPECT_EQ(act(planner, pool, &action).planned, 1);
  const auto before = state_of(planner);
  rdm_planner_cancel(planner.get());
  EXPECT_EQ(rdm_planner_act(planner.get(), pool.get(), 0, &action, nullptr), RDM_ERROR_CANCELLED);
  EXPECT_EQ(state_of(planner), before);
  EXPECT_EQ(act(planner, pool, &action).planned, 0);
}

TEST(Proposals, APolicyAloneActsAsItDoesWithoutAPlanner) {
  const Pool pool = pool_of("hand_over_safe_finger", "max_steps=40", 1, 3),
             twin = pool_of("hand_over_safe_finger", "max_steps=40", 1, 3);
  const Agent agent = agent_of(pool, "hidden=8,8\ninit_std=0.5");
  const Policy policy = policy_of(agent);
  rdm_policy_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(rdm_policy_get_info(policy.get(), &info), RDM_OK);
  ASSERT_GT(info.action_repeat, 1);
  rdm_planner_config c = config_of(pool, "samples=1\nhorizon=6");
  c.policy = policy.get();
  const Planner planner = planner_of(c);
  const rdm_buffers b = buffers_of(pool.get()), t = buffers_of(twin.get());
  std::vector<unsigned char> scratch(rdm_policy_scratch(policy.get(), 1));
  for (int i = 0; i < 3 * info.action_repeat; ++i) {
    act(planner, pool, b.action);
    if (i % info.action_repeat == 0) {
      ASSERT_EQ(rdm_policy_act(policy.get(), t.obs, 1, nullptr, t.action, scratch.data(), scratch.size()),
                RDM_OK);
    }
    for (int32_t j = 0; j < info.action_dim; ++j) ASSERT_EQ(b.action[j], t.action[j]) << i << ' ' << j;
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    ASSERT_EQ(rdm_pool_step(twin.get()), RDM_OK);
  }
}

TEST(Proposals, ThePolicysRolloutIsSampleZeroAndThePlanSampleOne) {
  const Pool pool = pool_of("lqr_line", kLine);
  const double x = start_of(pool);
  const Agent agent = agent_of(pool, "hidden=4");
  // the move that is best in two steps: a = -x / 1.1, in units of 5
  const auto good = static_cast<float>(-x / 1.1 / 5);
  set_output(agent, "actor", good);
  const Policy policy = policy_of(agent);
  rdm_planner_config c = config_of(pool, "samples=4\nhorizon=2\ncosts=ignore\nnoise=0.5");
  c.policy = policy.get();
  const Planner planner = planner_of(c);
  float action = 0;
  // the policy holds its move in the second step too, where it is too much
  const std::vector<float> plan = {good, 0};
  EXPECT_EQ(act(planner, pool, &action).best, 0);
  EXPECT_EQ(action, good);
  ASSERT_EQ(rdm_planner_set_plan(planner.get(), plan.data()), RDM_OK);
  const rdm_plan_info info = act(planner, pool, &action);
  EXPECT_EQ(info.best, 1);
  EXPECT_NEAR(info.ret, -(x * x + x * x * 0.1 / 1.1), 1e-4);
  EXPECT_EQ(plan_of(planner), plan);
}

TEST(Critics, AStateIsWorthWhatTheCriticSays) {
  const Pool pool = pool_of("lqr_line", kLine);
  const Agent agent = agent_of(pool, "hidden=4\nreward_factor=0.5");
  set_output(agent, "reward_critic", 3);
  set_output(agent, "cost_critic", 2);
  float value = 0, cost[RDM_MAX_COSTS];
  const float obs = 0.3f;
  ASSERT_EQ(rdm_agent_get_values(agent.get(), &obs, 1, &value, cost), RDM_OK) << rdm_agent_error(agent.get());
  EXPECT_FLOAT_EQ(value, 6);  // in the task's units
  EXPECT_FLOAT_EQ(cost[0], 2);
  EXPECT_EQ(cost[1], 0);
  const double x = start_of(pool);
  const float noise = 0;
  const auto info_of = [&](const char* settings) {
    rdm_planner_config c = config_of(pool, settings);
    c.noise = &noise;
    c.agent = agent.get();
    float action = 0;
    return act(planner_of(c), pool, &action);
  };
  EXPECT_NEAR(info_of("samples=2\nhorizon=3\ndiscount=0.5").ret, -1.75 * x * x + 0.125 * 6, 1e-5);
  EXPECT_EQ(info_of("samples=2\nhorizon=3").cost[0], 0);
  EXPECT_NEAR(info_of("samples=2\nhorizon=3\nterminal_cost=true").cost[0], 2, 1e-5);
  // an episode that ends within the horizon has nothing to come
  EXPECT_NEAR(info_of("samples=2\nhorizon=20").ret, -20 * x * x, 1e-3);
}

TEST(Critics, AnyNumberOfRows) {
  const Pool pool = pool_of("lqr_line", kLine);
  const Agent agent = agent_of(pool, "hidden=8");
  std::vector<float> obs(1000), all(1000);
  for (size_t i = 0; i < obs.size(); ++i) obs[i] = static_cast<float>(i) * 0.01f - 5;
  ASSERT_EQ(rdm_agent_get_values(agent.get(), obs.data(), 1000, all.data(), nullptr), RDM_OK);
  EXPECT_NE(all[0], all[999]);
  for (size_t i = 0; i < obs.size(); i += 37) {
    float one = 0;
    ASSERT_EQ(rdm_agent_get_values(agent.get(), &obs[i], 1, &one, nullptr), RDM_OK);
    EXPECT_EQ(one, all[i]) << i;
  }
  EXPECT_EQ(rdm_agent_get_values(agent.get(), obs.data(), 0, all.data(), nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_agent_get_values(agent.get(), nullptr, 1, all.data(), nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_get_values(agent.get(), obs.data(), 1, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  obs[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(rdm_agent_get_values(agent.get(), obs.data(), 2, all.data(), nullptr), RDM_ERROR_ARGUMENT);
  const Agent scaled = agent_of(pool, "normalize_reward=true");
  EXPECT_EQ(rdm_agent_get_values(scaled.get(), obs.data(), 1, all.data(), nullptr), RDM_ERROR_UNSUPPORTED);
  rdm_planner_config c = config_of(pool, "samples=2");
  c.agent = scaled.get();
  rdm_planner* p = nullptr;
  EXPECT_EQ(rdm_planner_create(&p, &c), RDM_ERROR_UNSUPPORTED);
}

TEST(PlannerErrors, AWrongConfigIsNamed) {
  const Pool pool = pool_of("lqr_line", "");
  const auto refused = [&](rdm_planner_config c, rdm_result code, const char* text) {
    rdm_planner* p = nullptr;
    char error[256] = "";
    c.error = error;
    c.error_size = sizeof error;
    EXPECT_EQ(rdm_planner_create(&p, &c), code) << text;
    EXPECT_NE(std::string(error).find(text), std::string::npos) << error;
    EXPECT_EQ(p, nullptr);
  };
  rdm_planner_config c = config_of(pool, nullptr);
  c.pool = nullptr;
  refused(c, RDM_ERROR_ARGUMENT, "config.pool is NULL");
  refused(config_of(pool, "sampels=3"), RDM_ERROR_NOT_FOUND, "nearest is samples");
  refused(config_of(pool, "samples=0"), RDM_ERROR_RANGE, "samples");
  refused(config_of(pool, "method=sampling"), RDM_ERROR_RANGE, "method");
  refused(config_of(pool, "horizon=3\nreplan=4"), RDM_ERROR_RANGE, "replan: 4 is above the horizon, 3");
  c = config_of(pool, nullptr);
  c.num_threads = 257;
  refused(c, RDM_ERROR_RANGE, "config.num_threads: 257");
  float noise = -1;
  c = config_of(pool, nullptr);
  c.noise = &noise;
  refused(c, RDM_ERROR_RANGE, "noise: entry 0 is outside [0, 10]");
  noise = std::numeric_limits<float>::quiet_NaN();
  refused(c, RDM_ERROR_RANGE, "noise: entry 0");
  const double limit = std::numeric_limits<double>::quiet_NaN();
  c = config_of(pool, nullptr);
  c.cost_limits = &limit;
  refused(c, RDM_ERROR_ARGUMENT, "cost_limits: entry 0 is not a number");
  const Pool hands = pool_of("hand_over_safe_finger");
  const Agent agent = agent_of(hands, "hidden=4");
  const Policy policy = policy_of(agent);
  c = config_of(pool, nullptr);
  c.policy = policy.get();
  refused(c, RDM_ERROR_VERSION_MISMATCH, "obs_dim: the policy has");
  c = config_of(pool, nullptr);
  c.agent = agent.get();
  refused(c, RDM_ERROR_ARGUMENT, "obs_dim: the agent has");
}

TEST(PlannerErrors, AWrongCallChangesNothing) {
  const Pool pool = pool_of("lqr_line", "max_steps=2"), other = pool_of("lqr_line", "");
  const Planner planner = planner_of(pool, "samples=3\nhorizon=2");
  float action = 9;
  act(planner, pool, &action);
  const auto before = state_of(planner);
  const auto refused = [&](rdm_result r, rdm_result code, const char* text) {
    EXPECT_EQ(r, code) << text;
    EXPECT_NE(std::string(rdm_planner_error(planner.get())).find(text), std::string::npos)
        << rdm_planner_error(planner.get());
    EXPECT_EQ(state_of(planner), before);
  };
  action = 9;
  refused(rdm_planner_act(planner.get(), other.get(), 0, &action, nullptr), RDM_ERROR_ARGUMENT,
          "pool: it is a pool of task lqr_line with other options");
  refused(rdm_planner_act(planner.get(), pool.get(), 1, &action, nullptr), RDM_ERROR_RANGE, "env: 1");
  refused(rdm_planner_act(planner.get(), nullptr, 0, &action, nullptr), RDM_ERROR_ARGUMENT, "pool is NULL");
  refused(rdm_planner_act(planner.get(), pool.get(), 0, nullptr, nullptr), RDM_ERROR_ARGUMENT,
          "action is NULL");
  const float bad[] = {0, std::numeric_limits<float>::infinity()};
  refused(rdm_planner_set_plan(planner.get(), bad), RDM_ERROR_ARGUMENT, "plan: entry 1 is not finite");
  for (int i = 0; i < 2; ++i) ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
  refused(rdm_planner_act(planner.get(), pool.get(), 0, &action, nullptr), RDM_ERROR_STATE,
          "no episode runs in world 0");
  EXPECT_EQ(action, 9);
  EXPECT_EQ(rdm_planner_act(nullptr, pool.get(), 0, &action, nullptr), RDM_ERROR_ARGUMENT);
  rdm_planner_destroy(nullptr);
}

TEST(PlannerOptions, AreListedAndGivenBack) {
  rdm_option_spec row = RDM_INIT(rdm_option_spec);
  int32_t count = 0;
  bool method = false;
  for (; rdm_planner_option_at(count, &row) == RDM_OK; ++count) method |= std::string(row.key) == "method";
  EXPECT_TRUE(method);
  EXPECT_GT(count, 10);
  EXPECT_EQ(rdm_planner_option_at(-1, &row), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_planner_option_at(count, &row), RDM_ERROR_RANGE);
  const Pool pool = pool_of("lqr_line", "");
  const Planner a = planner_of(pool, "method=cem\nnoise=0.33\nhorizon=9");
  size_t size = 0;
  ASSERT_EQ(rdm_planner_get_settings(a.get(), nullptr, 0, &size), RDM_OK);
  std::string text(size + 1, '\0');
  ASSERT_EQ(rdm_planner_get_settings(a.get(), text.data(), text.size(), &size), RDM_OK);
  EXPECT_NE(text.find("noise=0.33"), std::string::npos) << text;
  const Planner b = planner_of(pool, text.c_str());
  float x = 0, y = 0;
  act(a, pool, &x);
  act(b, pool, &y);
  EXPECT_EQ(x, y);
  EXPECT_EQ(state_of(a), state_of(b));
}

TEST(PlannerMemory, NoHeapAfterTheFirstCallAndAllOfItGoesBack) {
  CountingHost host;
  {
    const Pool pool = pool_of("hand_over_safe_finger", "", 1, 1, 2);
    const Agent agent = agent_of(pool, "hidden=16,16\nhistory=3");
    const Policy policy = policy_of(agent);
    rdm_planner_config c = config_of(pool, "method=mppi\nsamples=12\nhorizon=4\niterations=2");
    c.host = &host.hooks;
    c.policy = policy.get();
    c.agent = agent.get();
    const Planner planner = planner_of(c);
    const rdm_buffers b = buffers_of(pool.get());
    act(planner, pool, b.action);
    const int64_t heap = heap_count();
    const size_t calls = host.calls;
    for (int i = 0; i < 3; ++i) {
      act(planner, pool, b.action);
      ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    }
    EXPECT_EQ(host.calls, calls);
    if (kHeapIsCounted) {
      EXPECT_EQ(heap_count(), heap);
    }
    EXPECT_GT(host.live, 0u);
  }
  EXPECT_EQ(host.live, 0u);
}

TEST(PlannerMemory, AHostThatRefusesLosesNothing) {
  const Pool pool = pool_of("lqr_line", "");
  CountingHost host;
  rdm_planner_config c = config_of(pool, "samples=3\nhorizon=4");
  c.host = &host.hooks;
  planner_of(c);
  const size_t calls = host.calls;
  ASSERT_EQ(host.live, 0u);
  for (size_t at = 0; at < calls; ++at) {
    host.calls = 0;
    host.refuse_at = at;
    rdm_planner* p = nullptr;
    EXPECT_EQ(rdm_planner_create(&p, &c), RDM_ERROR_MEMORY) << at;
    EXPECT_EQ(p, nullptr);
    EXPECT_EQ(host.live, 0u) << at;
  }
}

TEST(PlannedSensors, APoolWithPicturesIsPlannedInWithout) {
  const Pool seen = pool_of("hand_over_safe_finger", "modality=depth\nimage_width=16\nimage_height=16", 1, 3);
  const Pool blind = pool_of("hand_over_safe_finger", "", 1, 3);
  const Planner planner = planner_of(seen, "samples=3\nhorizon=2");
  std::vector<float> a(sz(spec_of(seen.get()).action_dim)), b(a.size());
  act(planner, seen, a.data());
  const Planner other = planner_of(blind, "samples=3\nhorizon=2");
  act(other, blind, b.data());
  EXPECT_EQ(a, b);
}

}  // namespace

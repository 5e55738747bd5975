#include <cmath>
#include <limits>

#include "agents.hpp"
#include "algos/rollout/collector.hpp"
#include "nn/gaussian.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

// A collector of constant observations whose critics are constants: V = 3, V_c = 7.
struct Bench {
  AgentSetup setup;
  ResolvedAgentConfig resolved;
  Arena arena;
  Networks nets;
  BatchWorkers workers;
  Collector collector;
  std::vector<float> obs, action, reward, cost, final_obs;
  std::vector<uint8_t> terminated, truncated, valid, success;
  Transition t;

  explicit Bench(AgentSetup s) : setup(std::move(s)), resolved(resolve_config(setup.ready())) {
    Arena measure;
    carve(measure);
    arena = Arena(host(), measure.used());
    carve(arena);
    workers.open(host(), setup.config.num_threads);
    init_networks(nets, resolved);
    for (const int32_t net : {Networks::kReward, Networks::kCost}) {
      const MlpShape& shape = nets.shape[net];
      std::fill_n(nets.net(net), shape.num_params(), 0.0f);
      nets.net(net)[shape.bias_offset(shape.num_hidden)] = net == Networks::kReward ? 3.0f : 7.0f;
    }
    collector.open(resolved, nets, workers);
    const size_t n = resolved.num_envs();
    obs.assign(n * resolved.obs_dim(), 1);
    final_obs = obs;
    action.resize(n * resolved.action_dim());
    reward.assign(n, 1);
    cost.assign(n, 2);
    terminated.assign(n, 0), truncated.assign(n, 0), valid.assign(n, 1), success.assign(n, 0);
    t.reward = reward.data(), t.cost = cost.data();
    t.terminated = terminated.data(), t.truncated = truncated.data();
    t.valid = valid.data(), t.success = success.data();
    t.final_obs = final_obs.data();
  }
  void carve(Arena& a) {
    nets = carve_networks(a, resolved);
    workers.carve(a, resolved, nets.size);
    collector.carve(a, resolved);
  }
  void decide() {
    collector.act(obs.data(), true, action.data());
    collector.record(t);
  }
  const Rollout& rollout() const { return collector.rollout(); }
};

AgentSetup world() {
  AgentSetup s("ppo_lag", 2, 3, 4);
  s.config.max_steps = 10;
  s.with("horizon", "3").with("discount", "0.9").with("action_repeat", "2").with("hidden", "4");
  return s;
}

}  // namespace

TEST(Collector, EndsOfPaths) {
  Bench b(world());
  b.terminated = {1, 0, 1, 0};
  b.truncated = {0, 1, 1, 0};
  b.decide();
  const Rollout& r = b.rollout();
  const float g = 0.81f;  // per decision of two control steps
  const float reward[] = {1, 1 + g * 3, 1, 1}, cost[] = {2, 2 + g * 7, 2, 2}, discount[] = {0, 0, 0, g};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_FLOAT_EQ(r.reward[i], reward[i]) << i;
    EXPECT_FLOAT_EQ(r.cost[i], cost[i]) << i;
    EXPECT_FLOAT_EQ(r.discount[i], discount[i]) << i;
  }
  const EpisodeStats s = b.collector.episodes().stats();
  EXPECT_EQ(s.finished, 3);
  EXPECT_NEAR(s.fall_rate, 2.0 / 3, 1e-12);
  EXPECT_EQ(s.ret, 1);
}

// A regression test: a peer bootstrapped costs with the reward's value. V = 3, V_c = 7, r = 1, c = 2.
TEST(Collector, CostsBootstrapWithTheCostCritic) {
  AgentSetup s = world();
  Bench b(std::move(s.with("cost_lambda", "0").with("lambda", "0")));
  b.decide();
  b.truncated = {0, 1, 0, 0};
  b.decide();
  b.truncated = {0, 0, 0, 0};
  b.decide();
  b.collector.estimate(b.obs.data());
  const Rollout& r = b.rollout();
  for (const size_t row : {0u, 5u, 8u}) {  // inside a path, at a time limit, at the horizon
    EXPECT_FLOAT_EQ(r.target[row], 1 + 0.81f * 3) << row;
    EXPECT_FLOAT_EQ(r.cost_target[row], 2 + 0.81f * 7) << row;
  }
}

TEST(Collector, TruncationWithoutFinalObservationHasValueZero) {
  Bench b(world());
  b.truncated = {1, 0, 0, 0};
  b.t.final_obs = nullptr;
  b.decide();
  EXPECT_EQ(b.rollout().reward[0], 1);
}

TEST(Collector, LastDecisionOfAnEpisodeMayBeShorter) {
  Bench b(world());
  const int32_t steps[] = {1, 2, 2, 0};
  b.truncated = {1, 1, 0, 0};
  b.t.steps = steps;
  b.decide();
  EXPECT_FLOAT_EQ(b.rollout().reward[0], 1 + 0.9f * 3);
  EXPECT_FLOAT_EQ(b.rollout().reward[1], 1 + 0.81f * 3);
  EXPECT_EQ(b.collector.env_steps(), 5);
}

TEST(Collector, EstimateUsesTheValueAfterTheHorizon) {
  Bench b(world());
  for (int i = 0; i < 3; ++i) b.decide();
  EXPECT_EQ(b.collector.missing(), 0);
  b.collector.estimate(b.obs.data());
  EXPECT_EQ(b.collector.listed().rows, 12);
  // All rows alike: V = 3, r = 1; targets are the lambda returns of the remaining steps.
  const double d = 1 + 0.81 * 3 - 3;
  EXPECT_NEAR(b.rollout().target[8], 3 + d, 1e-5);
  EXPECT_NEAR(b.rollout().target[4], 3 + d * (1 + 0.81 * 0.95), 1e-5);
}

// What next-step autoreset returns for the step that only resets.
TEST(Collector, ARowThatOnlyResetsIsNotCounted) {
  Bench b(world());
  b.valid = {1, 0, 1, 1};
  b.reward[1] = std::numeric_limits<float>::quiet_NaN();
  b.decide();
  EXPECT_EQ(b.collector.env_steps(), 6);
  EXPECT_EQ(b.collector.episodes().stats().finished, 0);
  EXPECT_EQ(b.collector.episodes().length(1), 0);
  EXPECT_EQ(b.rollout().reward[1], 0);
  EXPECT_EQ(b.collector.totals().invalid, 0);
  for (int i = 0; i < 2; ++i) b.decide();
  b.collector.estimate(b.obs.data());
  EXPECT_EQ(b.collector.listed().rows, 9);
}

// An emergency stop: the row is not learned from, but its cost counts and the episode is over.
TEST(Collector, AnEndInARowThatIsNotValidEndsTheEpisode) {
  Bench b(world());
  b.decide();
  b.valid = {1, 0, 1, 0};
  b.truncated = {0, 1, 0, 0};
  b.reward[1] = b.reward[3] = std::numeric_limits<float>::quiet_NaN();
  b.decide();
  const EpisodeStats s = b.collector.episodes().stats();
  EXPECT_EQ(s.finished, 1);
  EXPECT_EQ(s.cost[0], 4);
  EXPECT_EQ(s.ret, 1);
  EXPECT_EQ(s.length, 4);
  EXPECT_EQ(b.collector.episodes().length(1), 0);
  EXPECT_EQ(b.collector.episodes().length(3), 4);
  EXPECT_EQ(b.collector.episodes().cost(3, 0), 4);
  EXPECT_EQ(b.collector.totals().invalid, 2);
  EXPECT_EQ(b.collector.totals().cost[0], 16);
  EXPECT_EQ(b.collector.totals().steps, 16);
  EXPECT_EQ(b.rollout().discount[5], 0);
  EXPECT_EQ(b.rollout().cost[5], 0);
}

// Ten control steps of two a decision: sums close, the path goes on.
TEST(Collector, AnEpisodeThatIsTooLongIsCountedAsEnded) {
  AgentSetup s = world();
  Bench b(std::move(s.with("horizon", "7")));
  for (int i = 0; i < 7; ++i) b.decide();
  const EpisodeStats e = b.collector.episodes().stats();
  EXPECT_EQ(e.finished, 4);
  EXPECT_EQ(e.length, 10);
  EXPECT_EQ(e.cost[0], 10);
  EXPECT_EQ(e.fall_rate, 0);
  EXPECT_EQ(b.collector.episodes().length(0), 4);
  EXPECT_EQ(b.collector.totals().cut, 4);
  for (int32_t row = 0; row < 28; ++row) EXPECT_GT(b.rollout().discount[row], 0);
  b.collector.drop();
  EXPECT_EQ(b.collector.totals().cut, 0);
  EXPECT_EQ(b.collector.totals().steps, 0);
}

TEST(Collector, EpisodeStepsStandForMaxSteps) {
  AgentSetup s = world();
  Bench b(std::move(s.with("episode_steps", "4").with("horizon", "6")));
  for (int i = 0; i < 6; ++i) b.decide();
  EXPECT_EQ(b.collector.episodes().stats().finished, 12);
  EXPECT_EQ(b.collector.episodes().stats().length, 4);
}

TEST(Collector, RefusesWhatNoFlagAndNoCostIs) {
  const auto refused = [](auto&& spoil, const char* text) {
    Bench b(world());
    spoil(b);
    const Thrown t = thrown([&] { b.decide(); });
    EXPECT_EQ(t.code, Code::kArgument) << text;
    EXPECT_STREQ(t.text.c_str(), text);
  };
  refused([](Bench& b) { b.cost[2] = -3; }, "cost: row 2, column 0 is -3, but it must be 0 or more");
  refused([](Bench& b) { b.valid[2] = 0, b.cost[2] = -3; },
          "cost: row 2, column 0 is -3, but it must be 0 or more");
  refused([](Bench& b) { b.valid[1] = 0, b.cost[1] = std::numeric_limits<float>::quiet_NaN(); },
          "cost: row 1 is not finite");
  refused([](Bench& b) { b.terminated[0] = 2; }, "terminated: row 0 is 2, neither 0 nor 1");
  refused([](Bench& b) { b.truncated[1] = 255; }, "truncated: row 1 is 255, neither 0 nor 1");
  refused([](Bench& b) { b.valid[3] = 7; }, "valid: row 3 is 7, neither 0 nor 1");
  refused([](Bench& b) { b.success[3] = 3; }, "success: row 3 is 3, neither 0 nor 1");
}

TEST(Collector, CountsStatusBits) {
  Bench b(world());
  const std::vector<uint32_t> status = {0, 1 | 32, 2 | 16, 4 | 8};
  b.t.status = status.data();
  for (int i = 0; i < 2; ++i) b.decide();
  const EpochTotals t = b.collector.totals();
  for (const int64_t count : t.status) EXPECT_EQ(count, 2);
}

TEST(Collector, RemembersTheLogProbabilityOfWhatItDid) {
  AgentSetup s = world();
  Bench b(std::move(s.with("noise_correlation", "0.5").with("init_std", "0.3")));
  std::vector<float> before(12, 0.0f);
  for (int step = 0; step < 3; ++step) {
    b.decide();
    const Rollout& r = b.rollout();
    float log_std[3];
    for (float& l : log_std) l = std::log(0.3f * std::sqrt(0.75f));
    for (size_t i = 0; i < 4; ++i) {
      const size_t row = r.row(step) + i;
      float noise[3], centered[3];
      for (size_t j = 0; j < 3; ++j) {
        noise[j] = b.action[3 * i + j] - r.mean[3 * row + j];
        centered[j] = b.action[3 * i + j] - 0.5f * before[3 * i + j];
        EXPECT_NEAR(r.action[3 * row + j], centered[j], 1e-6);
        before[3 * i + j] = noise[j];
      }
      EXPECT_NEAR(r.log_prob[row], gaussian_log_prob(&r.mean[3 * row], log_std, centered, 3), 1e-4);
    }
  }
}

TEST(Collector, NormaliserLearnsFromSamplesOnly) {
  Bench b(world());
  for (size_t i = 0; i < b.obs.size(); ++i) b.obs[i] = static_cast<float>(i);
  b.collector.act(b.obs.data(), false, b.action.data());
  EXPECT_EQ(b.collector.normalizer().count, 0);
  b.decide();
  EXPECT_EQ(b.collector.normalizer().count, 4);
  EXPECT_EQ(b.collector.normalizer().mean[1], 4);
  // The networks saw the statistics that include this very batch.
  EXPECT_FLOAT_EQ(b.rollout().obs[0], -3 / std::sqrt(20 / 3.0f));
  AgentSetup s = world();
  Bench raw(std::move(s.with("normalize_obs", "off")));
  raw.obs = b.obs;
  raw.decide();
  EXPECT_EQ(raw.collector.normalizer().count, 0);
  EXPECT_EQ(raw.rollout().obs[5], 5);
}

// Two decisions of four rows fill it; later ones change nothing.
TEST(Collector, NormaliserStandsStill) {
  AgentSetup s = world();
  Bench b(std::move(s.with("obs_freeze", "8")));
  for (int32_t t = 0; t < 4; ++t) {
    for (size_t i = 0; i < b.obs.size(); ++i) b.obs[i] = static_cast<float>(t + 1) * static_cast<float>(i);
    b.decide();
    EXPECT_EQ(b.collector.normalizer().count, std::min(8, 4 * (t + 1)));
    EXPECT_EQ(b.collector.normalizer().mean[1], t == 0 ? 4 : 6);
    b.collector.drop();
  }
}

// 10 control steps long, cost 2 per decision of 2 steps: rate 1 per control step.
TEST(Collector, TerminalCostChargesTheMissingSteps) {
  AgentSetup s = world();
  Bench b(std::move(s.with("terminal_cost", "on")));
  b.decide();
  b.terminated = {1, 0, 0, 0};
  b.truncated = {0, 1, 0, 0};
  b.decide();
  const EpisodeStats stats = b.collector.episodes().stats();
  EXPECT_DOUBLE_EQ(stats.cost[0], 4);
  EXPECT_DOUBLE_EQ(stats.charged_cost[0], (10.0 + 4) / 2);
  double tail = 0;
  for (int i = 2; i < 8; ++i) tail += std::pow(0.9, i);
  EXPECT_NEAR(b.rollout().cost[4], 2 + tail, 1e-5);
  EXPECT_FLOAT_EQ(b.rollout().cost[5], 2 + 0.81f * 7);
}

TEST(Collector, TerminalCostIsOffByDefault) {
  Bench b(world());
  b.terminated = {1, 0, 0, 0};
  b.decide();
  EXPECT_EQ(b.collector.episodes().stats().charged_cost[0], 2);
  EXPECT_EQ(b.rollout().cost[0], 2);
}

TEST(Collector, NumbersThatAreNotFiniteAreNamedAndChangeNothing) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()};
  for (const float x : bad) {
    Bench b(world());
    b.obs[5] = x;
    const Thrown act = thrown([&] { b.collector.act(b.obs.data(), true, b.action.data()); });
    EXPECT_EQ(act.code, Code::kArgument);
    EXPECT_NE(act.text.find("obs: row 2"), std::string::npos) << act.text;
    EXPECT_TRUE(b.collector.idle());
    EXPECT_EQ(b.collector.normalizer().count, 0);
    b.obs[5] = 1;
    b.collector.act(b.obs.data(), true, b.action.data());
    b.reward[1] = x;
    EXPECT_NE(thrown([&] { b.collector.record(b.t); }).text.find("reward: row 1"), std::string::npos);
    b.reward[1] = 1;
    b.cost[3] = x;
    EXPECT_NE(thrown([&] { b.collector.record(b.t); }).text.find("cost: row 3"), std::string::npos);
    b.cost[3] = 1;
    b.final_obs[0] = x;
    EXPECT_EQ(thrown([&] { b.collector.record(b.t); }).code, Code::kOk);  // only read where truncated
    b.collector.act(b.obs.data(), true, b.action.data());
    b.truncated[0] = 1;
    EXPECT_NE(thrown([&] { b.collector.record(b.t); }).text.find("final_obs: row 0"), std::string::npos);
    EXPECT_EQ(b.collector.missing(), 2);
    EXPECT_EQ(b.collector.env_steps(), 8);
  }
}

TEST(Collector, OrderOfCalls) {
  Bench b(world());
  EXPECT_EQ(thrown([&] { b.collector.record(b.t); }).code, Code::kState);
  b.collector.act(b.obs.data(), true, b.action.data());
  EXPECT_EQ(thrown([&] { b.collector.act(b.obs.data(), true, b.action.data()); }).code, Code::kState);
  b.collector.act(b.obs.data(), false, b.action.data());
  EXPECT_FALSE(b.collector.idle());
  b.collector.drop();
  EXPECT_TRUE(b.collector.idle());
  for (int i = 0; i < 3; ++i) b.decide();
  EXPECT_EQ(thrown([&] { b.collector.act(b.obs.data(), true, b.action.data()); }).code, Code::kState);
  EXPECT_EQ(thrown([&] { b.collector.record(b.t); }).code, Code::kState);
  Transition empty;
  Bench c(world());
  c.collector.act(c.obs.data(), true, c.action.data());
  EXPECT_EQ(thrown([&] { c.collector.record(empty); }).code, Code::kArgument);
  c.t.cost = nullptr;
  EXPECT_EQ(thrown([&] { c.collector.record(c.t); }).code, Code::kArgument);
}

TEST(Collector, NoiseStartsAfreshWithAnEpisode) {
  AgentSetup s = world();
  Bench b(std::move(s.with("noise_correlation", "0.9")));
  b.terminated = {1, 0, 0, 0};
  b.truncated = {0, 1, 0, 0};
  b.valid = {1, 1, 0, 1};
  b.decide();
  b.decide();
  const Rollout& r = b.rollout();
  for (size_t i = 0; i < 4; ++i) {
    const bool fresh = b.action[3 * i] == r.action[3 * (r.row(1) + i)];
    EXPECT_EQ(fresh, i < 3) << i;
  }
}

TEST(Collector, RewardsAndCostsAreNormalisedWhereItIsAsked) {
  AgentSetup s = world();
  Bench plain(world()), b(std::move(s.with("normalize_reward", "on").with("normalize_cost", "on")));
  for (Bench* c : {&plain, &b}) {
    c->reward = {1, 2, 3, 4};
    c->cost = {0, 1, 0, 1};
    c->decide();
  }
  const double reward_std = std::sqrt(5.0 / 3), cost_std = std::sqrt(1.0 / 3);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(b.rollout().reward[i], (static_cast<double>(i) - 1.5) / reward_std, 1e-6);
    EXPECT_NEAR(b.rollout().cost[i], (static_cast<double>(i % 2) - 0.5) / cost_std, 1e-6);
    EXPECT_EQ(plain.rollout().reward[i], static_cast<float>(i + 1));
  }
  // What is reported and what limits hold for stay as they are.
  b.terminated = {1, 1, 1, 1};
  b.decide();
  EXPECT_EQ(b.collector.episodes().stats().ret, 5);
  EXPECT_EQ(b.collector.episodes().stats().charged_cost[0], 1);
}

TEST(Collector, RewardsAreLearnedTimesAFactor) {
  AgentSetup s = world();
  Bench b(std::move(s.with("reward_factor", "0.25")));
  b.reward = {1, 2, 3, 4};
  b.terminated = {1, 1, 1, 1};
  b.decide();
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(b.rollout().reward[i], 0.25f * static_cast<float>(i + 1));
  EXPECT_EQ(b.rollout().cost[0], 2);
  EXPECT_EQ(b.collector.episodes().stats().ret, 2.5) << "what is reported stays as it is";
}

TEST(Collector, DiscountedLimit) {
  AgentSetup s = world();
  Bench b(std::move(s.with("discounted_limit", "on")));
  b.decide();
  b.terminated = {1, 0, 0, 0};
  b.decide();
  const EpisodeStats e = b.collector.episodes().stats();
  EXPECT_NEAR(e.charged_cost[0], 2 + 0.81 * 2, 1e-6);  // decisions of two control steps
  EXPECT_EQ(e.cost[0], 4);
}

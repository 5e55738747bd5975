#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "agents.hpp"
#include "algos/first_order/ppo.hpp"
#include "heap_count.hpp"
#include "nn/policy.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup lag(int32_t threads = 0) {
  AgentSetup s("ppo_lag", 6, 3, 40);
  s.config.num_threads = threads;
  s.config.cost_dim = 2;
  s.config.max_steps = 30;
  s.config.seed = 11;
  s.with("hidden", "16,8").with("horizon", "12").with("passes", "3").with("minibatches", "2");
  s.with("noise_correlation", "0.3").with("lr_schedule", "kl").with("learning_rate", "2e-3");
  s.with("terminal_cost", "on").with("early_stop_kl", "0.5").with("cost_limit", "1");
  return s;
}

// Runs bodies last to first, every other time in two threads.
void adversary(void* user, int32_t n, ParallelBody body, void* context) {
  auto& calls = *static_cast<int*>(user);
  const auto run = [=](int32_t odd) {
    for (int32_t i = n - 1; i >= 0; --i)
      if (i % 2 == odd) body(context, i);
  };
  if (++calls % 2) {
    run(1);
    run(0);
  } else {
    std::thread other(run, 1);
    run(0);
    other.join();
  }
}

std::vector<float> play(AgentSetup s, int epochs) {
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; i < epochs; ++i) world.epoch(*a);
  return parameters(*a);
}

bool same_bytes(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace

// Of the actor's tensors, in the order of the agent's.
std::vector<float> policy_parameters(Agent& a) {
  const auto bytes = policy_file(a);
  Policy* p = Policy::read(bytes.data(), bytes.size(), HostHooks());
  const PolicyView& v = p->view();
  std::vector<float> out(v.log_std, v.log_std + v.action_dim());
  out.insert(out.end(), v.params, v.params + v.actor.num_params());
  Policy::destroy(p);
  return out;
}

// What an agent whose option average is `share` writes after each of six epochs.
std::vector<std::vector<float>> policies(const char* share, std::vector<float>* learned) {
  AgentSetup s = lag();
  s.with("average", share);
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  std::vector<std::vector<float>> out;
  for (int i = 0; i < 6; ++i) {
    world.epoch(*a);
    out.push_back(policy_parameters(*a));
  }
  *learned = parameters(*a);
  return out;
}

TEST(Agent, AnAverageIsWhatPoliciesAreAndChangesNoLearning) {
  std::vector<float> with, without;
  const auto mean = policies("0.6", &with), last = policies("0", &without);
  EXPECT_TRUE(same_bytes(with, without));
  std::vector<double> wanted(last[0].size());
  size_t moved = 0;
  for (size_t k = 0; k < last.size(); ++k)
    for (size_t j = 0; j < wanted.size(); ++j) {
      const double share = std::max(0.4, 1.0 / static_cast<double>(k + 1));
      wanted[j] += share * (static_cast<double>(last[k][j]) - wanted[j]);
      ASSERT_NEAR(static_cast<double>(mean[k][j]), wanted[j], 1e-5) << k << " " << j;
      if (k > 0) moved += mean[k][j] != last[k][j];
    }
  EXPECT_GT(moved, 4 * wanted.size());
}

TEST(Agent, AnAverageActsWithoutNoise) {
  for (const char* std_mode : {"free", "state"}) {
    AgentSetup s = lag();
    s.with("average", "0.6").with("std_mode", std_mode);
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    for (int i = 0; i < 4; ++i) world.epoch(*a);
    const auto bytes = policy_file(*a);
    Policy* p = Policy::read(bytes.data(), bytes.size(), HostHooks());
    std::vector<float> own(40 * 3), frozen(40 * 3);
    a->act(world.obs(), false, own.data());
    std::vector<unsigned char> scratch(p->scratch_bytes(40) + 64);
    auto at = reinterpret_cast<uintptr_t>(scratch.data());
    p->act(world.obs(), 40, nullptr, frozen.data(), scratch.data() + (64 - at % 64) % 64);
    for (size_t i = 0; i < own.size(); ++i)
      EXPECT_EQ(std::clamp(own[i], -1.0f, 1.0f), frozen[i]) << std_mode << " " << i;
    Policy::destroy(p);
  }
}

TEST(Agent, AnAverageBeginsAgainWithWrittenTensors) {
  AgentSetup s = lag();
  s.with("average", "0.6").with("hidden", "4");
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; i < 3; ++i) world.epoch(*a);
  TensorInfo t;
  ASSERT_TRUE(a->tensor(1, &t));
  t.data[0] = 0.125f;
  a->tensors_changed();
  EXPECT_EQ(policy_parameters(*a)[3], 0.125f);
}

TEST(Agent, SameBytesForAnyThreadsAndAnySchedule) {
  const std::vector<float> wanted = play(lag(), 4);
  for (const float x : wanted) ASSERT_TRUE(std::isfinite(x));
  for (const int32_t threads : {1, 2, 3, 4, 8})
    EXPECT_TRUE(same_bytes(play(lag(threads), 4), wanted)) << threads;
  for (const int32_t threads : {0, 2, 4}) {
    int calls = 0;
    AgentSetup s = lag(threads);
    s.config.hooks.user = &calls;
    s.config.hooks.parallel = adversary;
    EXPECT_TRUE(same_bytes(play(std::move(s), 4), wanted)) << threads;
    EXPECT_EQ(calls > 0, threads > 0);
  }
  AgentSetup other = lag();
  other.config.seed = 12;
  EXPECT_FALSE(same_bytes(play(std::move(other), 4), wanted));
}

TEST(Agent, ActionsDoNotDependOnThreads) {
  AgentSetup one = lag(), four = lag(4);
  const AgentPtr a = one.make(), b = four.make();
  NoiseWorld v(one.config), w(four.config);
  v.epoch(*a), w.epoch(*b);
  for (const bool sample : {false, true}) {
    a->act(v.obs(), sample, v.action());
    b->act(w.obs(), sample, w.action());
    EXPECT_EQ(0, std::memcmp(v.action(), w.action(), 40 * 3 * sizeof(float)));
  }
}

TEST(Agent, ResumeEqualsUnbroken) {
  AgentSetup s = lag();
  const AgentPtr whole = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; i < 3; ++i) world.epoch(*whole);
  whole->set_option({"multiplier_lr", nullptr, 0.1});
  const auto bytes = saved(*whole);
  AgentSetup other = lag(2);
  other.config.seed = 999;
  const AgentPtr resumed = other.make();
  resumed->load(bytes.data(), bytes.size());
  EXPECT_EQ(saved(*resumed), bytes);
  EXPECT_EQ(resumed->options().number("multiplier_lr"), 0.1);
  NoiseWorld copy = world;
  Epoch e, f;
  for (int i = 0; i < 3; ++i) {
    world.epoch(*whole, &e);
    copy.epoch(*resumed, &f);
    EXPECT_EQ(0, std::memcmp(&e, &f, sizeof e)) << i;
  }
  EXPECT_TRUE(same_bytes(parameters(*whole), parameters(*resumed)));
  EXPECT_EQ(saved(*whole), saved(*resumed));
}

TEST(Agent, SaveOnlyBetweenEpochs) {
  AgentSetup s = lag();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  a->act(world.obs(), false, world.action());
  EXPECT_NO_THROW(saved(*a));
  a->act(world.obs(), true, world.action());
  EXPECT_EQ(thrown([&] { saved(*a); }).code, Code::kState);
  world.draw();
  a->record(world.transition());
  EXPECT_EQ(thrown([&] { saved(*a); }).code, Code::kState);
  a->drop_horizon();
  EXPECT_NO_THROW(saved(*a));
}

TEST(Agent, BadBytesChangeNothing) {
  AgentSetup s = lag();
  const AgentPtr a = s.make(), b = s.make();
  NoiseWorld world(s.config);
  world.epoch(*b);
  const auto before = saved(*a);
  const auto good = saved(*b);
  for (size_t cut = 0; cut < good.size(); cut += 97)
    EXPECT_EQ(thrown([&] { a->load(good.data(), cut); }).code, Code::kFormat);
  for (size_t at = 8; at < good.size(); at += 131) {
    auto bad = good;
    bad[at] ^= 0x40;
    const Code code = thrown([&] { a->load(bad.data(), bad.size()); }).code;
    EXPECT_TRUE(code == Code::kFormat || code == Code::kVersion) << at;
  }
  EXPECT_EQ(thrown([&] { a->load(nullptr, 0); }).code, Code::kArgument);
  EXPECT_EQ(saved(*a), before);
  AgentSetup other = lag();
  other.config.num_envs = 39;
  const Thrown t = thrown([&] { other.make()->load(good.data(), good.size()); });
  EXPECT_EQ(t.code, Code::kFormat);
  EXPECT_NE(t.text.find("num_envs"), std::string::npos) << t.text;
}

TEST(Agent, NoHeapInActRecordUpdate) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  for (const int32_t threads : {0, 2}) {
    AgentSetup s = lag(threads);
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    world.epoch(*a);
    Epoch e;
    const int64_t before = heap_count();
    for (int i = 0; i < 3; ++i) world.epoch(*a, &e);
    a->act(world.obs(), false, world.action());
    EXPECT_EQ(heap_count(), before) << threads;
  }
}

TEST(Agent, EpochTellsWhatHappened) {
  AgentSetup s = lag();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  Epoch e;
  for (int i = 1; i <= 2; ++i) {
    world.epoch(*a, &e);
    EXPECT_EQ(e.epoch, i);
  }
  EXPECT_GT(e.env_steps, 2 * 40 * 12 * 0.8);
  EXPECT_LT(e.env_steps, 2 * 40 * 12);
  EXPECT_GT(e.episodes, 50);
  EXPECT_NEAR(e.fall_rate, 1.0 / 3, 0.2);
  EXPECT_NEAR(e.cost_per_step, 0.5, 0.1);
  EXPECT_NEAR(e.cost[1] / e.length, 0.5, 0.1);
  EXPECT_GT(e.multiplier[0], 0.03);
  EXPECT_EQ(e.multiplier[1], 0);
  EXPECT_GT(e.kl, 0);
  EXPECT_NEAR(e.action_std, 0.6, 0.1);
  EXPECT_NEAR(e.entropy, 3 * (std::log(e.action_std * std::sqrt(1 - 0.09)) + 1.4189385), 0.02);
  EXPECT_GT(e.loss_reward_value, 0);
  EXPECT_GT(e.loss_cost_value, 0);
  EXPECT_EQ(e.passes, 3);
  EXPECT_GT(e.learning_rate, 0);
}

// A regression test of a peer that went through the data in the order in which they were collected.
TEST(Agent, EveryPassIsShuffled) {
  struct Probe : Ppo {
    using Ppo::Ppo;
    using Ppo::rollout;
  };
  AgentSetup s("ppo", 6, 3, 40);
  s.with("horizon", "12").with("hidden", "8").with("passes", "1");
  Probe a(resolve_config(s.ready()));
  a.open(s.config);
  NoiseWorld world(s.config);
  std::vector<std::vector<int32_t>> orders;
  for (int epoch = 0; epoch < 2; ++epoch) {
    world.epoch(a);
    const Rollout& r = a.rollout();
    const auto valid = static_cast<size_t>(std::count(r.valid, r.valid + r.samples(), 1));
    std::vector<int32_t> order(r.order, r.order + valid);
    EXPECT_FALSE(std::is_sorted(order.begin(), order.end()));
    orders.push_back(order);
    std::sort(order.begin(), order.end());
    EXPECT_EQ(std::adjacent_find(order.begin(), order.end()), order.end());
    for (const int32_t row : order) EXPECT_TRUE(r.valid[row]);
  }
  EXPECT_NE(orders[0], orders[1]);
}

TEST(Agent, EarlyStopEndsThePasses) {
  AgentSetup s = lag();
  const AgentPtr a = s.with("passes", "50").with("early_stop_kl", "0.001").make();
  NoiseWorld world(s.config);
  Epoch e;
  world.epoch(*a, &e);
  EXPECT_LT(e.passes, 10);
  EXPECT_GE(e.passes, 1);
}

TEST(Agent, OrderOfCalls) {
  AgentSetup s = lag();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  EXPECT_EQ(thrown([&] { a->update(world.obs(), nullptr); }).code, Code::kState);
  EXPECT_EQ(a->missing(), 12);
  EXPECT_EQ(a->horizon(), 12);
  while (a->missing() > 0) world.decide(*a);
  EXPECT_EQ(thrown([&] { a->update(nullptr, nullptr); }).code, Code::kArgument);
  std::vector<float> bad(world.obs(), world.obs() + 240);
  bad[239] = std::numeric_limits<float>::infinity();
  EXPECT_NE(thrown([&] { a->update(bad.data(), nullptr); }).text.find("row 39"), std::string::npos);
  EXPECT_EQ(a->missing(), 0);
  a->update(world.obs(), nullptr);
  EXPECT_EQ(a->missing(), 12);
}

TEST(Agent, CancelDropsTheHorizonAndTheAgentGoesOn) {
  AgentSetup s = lag();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  world.epoch(*a);
  const std::vector<float> before = parameters(*a);
  while (a->missing() > 0) world.decide(*a);
  a->cancel();
  EXPECT_EQ(thrown([&] { a->update(world.obs(), nullptr); }).code, Code::kCancelled);
  EXPECT_EQ(a->missing(), 12);
  EXPECT_TRUE(same_bytes(parameters(*a), before));
  Epoch e;
  world.epoch(*a, &e);
  EXPECT_EQ(e.epoch, 2);
}

TEST(Agent, LiveOptions) {
  AgentSetup s = lag();
  const AgentPtr a = s.make();
  a->set_option({"Cost-Limit", "1000", 0});
  EXPECT_EQ(a->options().number("cost_limit"), 1000);
  NoiseWorld world(s.config);
  Epoch e;
  world.epoch(*a, &e);
  EXPECT_EQ(e.multiplier[0], 0);  // far under the new limit
  EXPECT_EQ(thrown([&] { a->set_option({"hidden", "8", 0}); }).code, Code::kState);
  EXPECT_EQ(thrown([&] { a->set_option({"clip", nullptr, -1}); }).code, Code::kRange);
  EXPECT_EQ(thrown([&] { a->set_option({"clop", nullptr, 1}); }).code, Code::kNotFound);
  EXPECT_EQ(thrown([&] { a->set_option({nullptr, nullptr, 1}); }).code, Code::kArgument);
  EXPECT_EQ(thrown([&] { a->set_option({"cost_limit", nullptr, -1}); }).code, Code::kState);
  EXPECT_EQ(a->options().number("cost_limit"), 1000);
  a->set_option({"learning_rate", nullptr, 0});
  a->set_option({"critic_learning_rate", nullptr, 0});
  const std::vector<float> before = parameters(*a);
  world.epoch(*a);
  EXPECT_TRUE(same_bytes(parameters(*a), before));
}

TEST(Agent, TensorsAreTheNetwork) {
  AgentSetup s = lag();
  const AgentPtr a = s.make();
  TensorInfo t;
  int32_t found = 0;
  for (int32_t i = 0; a->tensor(i, &t); ++i) {
    if (std::strcmp(t.name, "actor.2.weight") == 0) std::fill_n(t.data, t.rows * t.cols, 0.0f), ++found;
    if (std::strcmp(t.name, "actor.2.bias") == 0) t.data[0] = 0.5f, t.data[1] = -3, t.data[2] = 2, ++found;
    if (std::strcmp(t.name, "actor.log_std") == 0) t.data[1] = 100, ++found;
  }
  ASSERT_EQ(found, 3);
  a->tensors_changed();
  NoiseWorld world(s.config);
  a->act(world.obs(), false, world.action());
  EXPECT_EQ(world.action()[3], 0.5f);
  EXPECT_EQ(world.action()[4], -3);
  ASSERT_TRUE(a->tensor(0, &t));
  EXPECT_FLOAT_EQ(t.data[1], std::log(10.0f));
}

TEST(Agent, WeightsThatAreNotFiniteAreReportedAndNotSpread) {
  AgentSetup s = lag();
  std::string line;
  s.config.hooks.user = &line;
  s.config.hooks.log = [](void* user, int32_t level, const char* text) {
    EXPECT_EQ(level, 1);
    *static_cast<std::string*>(user) = text;
  };
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  while (a->missing() > 0) world.decide(*a);
  TensorInfo t;
  for (int32_t i = 0; a->tensor(i, &t); ++i)
    if (std::strcmp(t.name, "reward_critic.0.bias") == 0) t.data[0] = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> before = parameters(*a);
  a->update(world.obs(), nullptr);
  const std::vector<float> after = parameters(*a);
  EXPECT_NE(line.find("not finite"), std::string::npos) << line;
  size_t broken = 0;
  for (const float x : after) broken += !std::isfinite(x);
  EXPECT_EQ(broken, 1u);
}

TEST(Agent, PolicyFileActsAsTheAgent) {
  AgentSetup s = lag();
  s.config.task = "noise";
  s.config.layout_hash = 1234;
  s.config.control_dt = 0.02f;
  const AgentPtr a = s.with("action_repeat", "4").make();
  NoiseWorld world(s.config);
  world.epoch(*a);
  const std::vector<unsigned char> bytes = policy_file(*a);
  Policy* p = Policy::read(bytes.data(), bytes.size(), HostHooks());
  const PolicyView& v = p->view();
  EXPECT_STREQ(v.task, "noise");
  EXPECT_EQ(v.layout_hash, 1234u);
  EXPECT_EQ(v.action_repeat, 4);
  EXPECT_EQ(v.control_dt, 0.02f);
  EXPECT_EQ(v.noise_correlation, 0.3f);
  Epoch e;
  EXPECT_NEAR(std::exp(v.log_std[0]), 0.6, 0.05);  // the stationary deviation, not the innovation's
  a->act(world.obs(), false, world.action());
  std::vector<float> action(120);
  Arena measure;
  measure.make<unsigned char>(p->scratch_bytes(40));
  Arena arena(HostHooks(), measure.used());
  p->act(world.obs(), 40, nullptr, action.data(), arena.make<unsigned char>(p->scratch_bytes(40)));
  for (size_t i = 0; i < action.size(); ++i) EXPECT_EQ(action[i], std::clamp(world.action()[i], -1.0f, 1.0f));
  Policy::destroy(p);
}

// At a rate of 0 the policy that is learned is the one that acted: no KL, and a mean advantage of 0.
TEST(Agent, StateDeviationsActAsTheyAreLearned) {
  for (const int32_t threads : {0, 2}) {
    AgentSetup s = lag();
    s.config.num_threads = threads;
    s.with("std_mode", "state").with("last_layer_scale", "1").with("learning_rate", "0").with("lr_min", "0");
    s.with("multiplier_init", "0").with("multiplier_lr", "0").with("std_max", "0.7");
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    Epoch e;
    world.epoch(*a, &e);
    EXPECT_NEAR(e.kl, 0, 1e-6);
    EXPECT_NEAR(e.loss_policy, 0, 1e-5);
    EXPECT_EQ(e.clip_fraction, 0);
    EXPECT_GT(e.action_std, 0.3);
    EXPECT_LT(e.action_std, 0.7);
    const std::vector<unsigned char> bytes = policy_file(*a);
    Policy* p = Policy::read(bytes.data(), bytes.size(), HostHooks());
    EXPECT_EQ(p->view().action_dim(), s.config.action_dim);
    EXPECT_FLOAT_EQ(std::exp(p->view().std_bounds[1]), 0.7f);  // the stationary deviation's
    Policy::destroy(p);
  }
}

// One step per episode, observation -1 or 1; only at 1 does the action matter, and only at 1 does noise cost.
// The deviations are those of the policy file.
TEST(Agent, StateDeviationsFallWhereNoiseCosts) {
  for (const char* algo : {"ppo_lag", "cpo"}) {
    constexpr int32_t kEnvs = 50;
    AgentSetup s(algo, 1, 1, kEnvs);
    s.with("std_mode", "state").with("horizon", "20").with("hidden", "16").with("learning_rate", "3e-3");
    s.with("entropy", "0.02").with("cost_limit", "100").with("init_std", "0.5");
    const AgentPtr a = s.make();
    std::vector<float> obs(kEnvs), action(kEnvs), reward(kEnvs), spread(kEnvs);
    const std::vector<float> cost(kEnvs, 0), ones(kEnvs, 1);
    const std::vector<uint8_t> over(kEnvs, 1);
    for (size_t i = 0; i < kEnvs; ++i) obs[i] = i % 2 ? 1.0f : -1.0f;
    Transition t;
    t.reward = reward.data(), t.cost = cost.data(), t.terminated = over.data();
    for (int epoch = 0; epoch < 60; ++epoch) {
      while (a->missing() > 0) {
        a->act(obs.data(), true, action.data());
        for (size_t i = 0; i < kEnvs; ++i)
          reward[i] = obs[i] > 0 ? -(action[i] - 0.3f) * (action[i] - 0.3f) : 0;
        a->record(t);
      }
      a->update(obs.data(), nullptr);
    }
    const std::vector<unsigned char> bytes = policy_file(*a);
    Policy* p = Policy::read(bytes.data(), bytes.size(), HostHooks());
    Arena measure;
    measure.make<unsigned char>(p->scratch_bytes(kEnvs));
    Arena arena(HostHooks(), measure.used());
    auto* scratch = arena.make<unsigned char>(p->scratch_bytes(kEnvs));
    p->act(obs.data(), kEnvs, nullptr, action.data(), scratch);
    p->act(obs.data(), kEnvs, ones.data(), spread.data(), scratch);
    Policy::destroy(p);
    EXPECT_NEAR(action[1], 0.3, 0.05) << algo;
    EXPECT_LT(spread[1] - action[1], 0.2) << algo;
    EXPECT_GT(spread[0] - action[0], 0.4) << algo;
  }
}

TEST(Agent, ConfigIsCopied) {
  const auto a = [] {
    AgentSetup s = lag();
    std::string task = "some_task";
    s.config.task = task.c_str();
    s.ready();
    AgentPtr made(Agent::create(s.config));
    task = "xxxxxxxxx";
    return made;
  }();
  EXPECT_STREQ(a->config().task, "some_task");
  EXPECT_STREQ(a->config().algo, "ppo_lag");
  EXPECT_EQ(a->config().options, nullptr);
  EXPECT_EQ(a->config().num_envs, 40);
}

TEST(Agent, AHorizonOfDeadRowsTeachesNothing) {
  AgentSetup s = lag();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  const std::vector<uint8_t> none(40, 0);
  while (a->missing() > 0) {
    a->act(world.obs(), true, world.action());
    world.draw();
    Transition t = world.transition();
    t.valid = none.data();
    t.terminated = t.truncated = nullptr;
    a->record(t);
  }
  const std::vector<float> before = parameters(*a);
  Epoch e;
  a->update(world.obs(), &e);
  EXPECT_TRUE(same_bytes(parameters(*a), before));
  EXPECT_EQ(e.passes, 0);
  EXPECT_EQ(e.env_steps, 0);
  for (const double x : {e.kl, e.loss_policy, e.loss_reward_value, e.value_reward, e.ret, e.length})
    EXPECT_TRUE(std::isnan(x));
  EXPECT_EQ(e.flags, kEpochNoEpisode);
}

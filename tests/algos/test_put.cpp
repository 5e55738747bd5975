// Data that was sampled elsewhere: put stands where act and record stand.
#include <cmath>
#include <functional>
#include <limits>

#include "agents.hpp"
#include "algos/first_order/ppo.hpp"
#include "heap_count.hpp"
#include "nn/policy.hpp"
#include "point_world.hpp"
#include "ranks.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

// A saved state without the section of noise, whose streams put leaves alone.
std::vector<unsigned char> without_noise(std::vector<unsigned char> bytes) {
  constexpr size_t kHead = 16;
  for (size_t at = kFileLengthAt + 8; at < bytes.size();) {
    uint64_t length = 0;
    std::memcpy(&length, &bytes[at + 8], sizeof length);
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto size = static_cast<std::ptrdiff_t>(kHead + length);
    if (std::memcmp(&bytes[at], "NOIS", 4) == 0) {
      bytes.erase(first, first + size);
      return bytes;
    }
    at += kHead + length;
  }
  ADD_FAILURE() << "no section NOIS";
  return bytes;
}

AgentSetup setup_of(const char* algo, const char* correlation = "0") {
  AgentSetup s = busy_setup(algo, "free", 40);
  return s.with("noise_correlation", correlation);
}

uint64_t generation_of(const std::vector<unsigned char>& file) {
  Policy* p = Policy::read(file.data(), file.size(), {});
  const uint64_t generation = p->view().generation;
  Policy::destroy(p);
  return generation;
}

// One decision of `actor`, put into the others.
void decide(NoiseWorld& world, Agent& actor, std::initializer_list<Agent*> fed) {
  const std::vector<float> obs(world.obs(), world.obs() + 40 * 6);
  actor.act(obs.data(), true, world.action());
  world.draw();
  actor.record(world.transition());
  for (Agent* a : fed) a->put(obs.data(), world.action(), world.transition());
}

class EveryAlgoIsFed : public testing::TestWithParam<int> {};

}  // namespace

TEST_P(EveryAlgoIsFed, TheSameBytesAsByActing) {
  AgentSetup s = setup_of(algo_at(GetParam()).name);
  const AgentPtr actor = s.make(), fed = s.make();
  NoiseWorld world(s.config);
  Epoch e, f;
  for (int i = 0; i < 2; ++i) {
    while (actor->missing() > 0) decide(world, *actor, {fed.get()});
    actor->update(world.obs(), &e);
    fed->update(world.obs(), &f);
    EXPECT_EQ(0, std::memcmp(&e, &f, sizeof e));
  }
  EXPECT_EQ(without_noise(saved(*fed)), without_noise(saved(*actor)));
  EXPECT_EQ(policy_file(*fed), policy_file(*actor));
  EXPECT_NE(saved(*fed), saved(*actor));
}

INSTANTIATE_TEST_SUITE_P(List, EveryAlgoIsFed, testing::Range(0, algo_count()),
                         [](const auto& info) { return std::string(algo_at(info.param).name); });

// What is left of an action is its own sample, whose density is learned from: rounding aside as in the agent
// that drew it, over ends of episodes and over epochs.
TEST(Put, CorrelatedNoiseGoesOn) {
  struct Probe : Ppo {
    using Ppo::Ppo;
    using Ppo::rollout;
  };
  AgentSetup s = setup_of("ppo", "0.8");
  s.with("learning_rate", "0").with("critic_learning_rate", "0");
  Probe actor(resolve_config(s.ready())), fed(resolve_config(s.ready()));
  actor.open(s.config), fed.open(s.config);
  NoiseWorld world(s.config);
  for (int i = 0; i < 3; ++i) {
    while (actor.missing() > 0) decide(world, actor, {&fed});
    const Rollout &a = actor.rollout(), &b = fed.rollout();
    const size_t n = size_of(a.samples());
    for (size_t k = 0; k < n * a.action_dim; ++k) ASSERT_NEAR(a.action[k], b.action[k], 1e-5) << k;
    for (size_t k = 0; k < n; ++k) ASSERT_NEAR(a.log_prob[k], b.log_prob[k], 1e-4) << k;
    actor.update(world.obs(), nullptr), fed.update(world.obs(), nullptr);
  }
}

TEST(Put, TakesTurnsWithActing) {
  AgentSetup s = setup_of("ppo_lag", "0.3");
  const AgentPtr actor = s.make(), fed = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; actor->missing() > 0; ++i)
    if (i % 2)
      decide(world, *actor, {fed.get()});
    else
      actor->put(world.obs(), world.action(), world.transition()), world.decide(*fed);
  EXPECT_EQ(fed->missing(), 0);
  actor->update(world.obs(), nullptr);
  fed->update(world.obs(), nullptr);
}

// By the number in the policy file that was played elsewhere.
TEST(Put, AGenerationThatIsNotThePolicysIsStale) {
  AgentSetup s = setup_of("ppo_lag");
  const AgentPtr a = s.with("average", "0").make();
  NoiseWorld world(s.config);
  std::vector<uint64_t> played;
  for (int i = 0; i < 3; ++i) {
    played.push_back(generation_of(policy_file(*a)));
    EXPECT_EQ(a->generation(), played.back());
    EXPECT_EQ(played.back() & 0xffffffff, static_cast<uint64_t>(i)) << "epochs";
    while (a->missing() > 0) {
      Transition t = world.transition();
      for (const uint64_t other : {i > 0 ? played[size_of(i - 1)] : 1, played.back() ^ uint64_t{1} << 40}) {
        t.generation = other;
        const Thrown why = thrown([&] { a->put(world.obs(), world.action(), t); });
        EXPECT_EQ(why.code, Code::kState);
        EXPECT_EQ(why.text, "put: generation: the rows were sampled by " + std::to_string(other) +
                                ", but the policy is " + std::to_string(played.back()));
      }
      t.generation = a->missing() % 2 ? played.back() : 0;
      a->put(world.obs(), world.action(), t);
      EXPECT_EQ(generation_of(policy_file(*a)), played.back())
          << "statistics have moved, the network has not";
    }
    a->update(world.obs(), nullptr);
  }
  const auto state = saved(*a);
  const AgentPtr other = s.make();
  other->load(state.data(), state.size());
  EXPECT_EQ(other->generation(), a->generation());
}

// A host that sets a tensor within a horizon has another policy from there on.
TEST(Put, AGenerationEndsWithAChangeOfTensors) {
  AgentSetup s = setup_of("ppo_lag");
  const AgentPtr a = s.with("average", "0").make();
  NoiseWorld world(s.config);
  Transition t = world.transition();
  const auto put = [&] { return thrown([&] { a->put(world.obs(), world.action(), t); }).code; };
  t.generation = a->generation();
  EXPECT_EQ(put(), Code::kOk);
  TensorInfo tensor;
  ASSERT_TRUE(a->tensor(0, &tensor));
  tensor.data[0] += 0.25f;
  a->tensors_changed();
  EXPECT_EQ(put(), Code::kState);
  t.generation = generation_of(policy_file(*a));
  EXPECT_EQ(put(), Code::kOk);
}

// A policy file is the average then, and another network samples.
TEST(Put, NoGenerationWithAnAverage) {
  AgentSetup s = setup_of("ppo_lag");
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  Transition t = world.transition();
  t.generation = generation_of(policy_file(*a));
  const Thrown why = thrown([&] { a->put(world.obs(), world.action(), t); });
  EXPECT_EQ(why.code, Code::kUnsupported);
  EXPECT_EQ(why.text,
            "put: generation: with option average a policy file holds the running mean, not the network that "
            "samples");
}

TEST(Put, WhatIsRefusedChangesNothing) {
  AgentSetup s = setup_of("ppo_lag");
  const AgentPtr a = s.make(), plain = s.make();
  NoiseWorld world(s.config);
  std::vector<float> obs(world.obs(), world.obs() + 240), action(120, 0.5f), cost(80, 0.0f);
  Transition t = world.transition();
  const auto why = [&] { return thrown([&] { a->put(obs.data(), action.data(), t); }); };
  a->act(obs.data(), true, action.data());
  EXPECT_EQ(why().text, "put: the actions that were sampled last have not been recorded");
  a->discard();
  const AgentPtr fresh = s.make();  // a's normaliser has counted what it acted on
  const auto refused = [&](Code code, const char* text) {
    const Thrown got = thrown([&] { fresh->put(obs.data(), action.data(), t); });
    EXPECT_EQ(got.code, code);
    EXPECT_EQ(got.text, text);
  };
  action[119] = 1.5e5f;
  refused(Code::kRange, "action: row 39, entry 2 is 150000, which is outside [-100000, 100000]");
  action[119] = std::numeric_limits<float>::quiet_NaN();
  refused(Code::kRange, "action: row 39, entry 2 is nan, which is outside [-100000, 100000]");
  action[119] = 0;
  obs[239] = std::numeric_limits<float>::infinity();
  refused(Code::kArgument, "obs: row 39 is not finite");
  obs[239] = 0;
  cost[79] = -1;
  t.cost = cost.data();
  refused(Code::kArgument, "cost: row 39, column 1 is -1, but it must be 0 or more");
  t = world.transition();
  for (int i = 0; i < 12; ++i)
    fresh->put(obs.data(), action.data(), t), plain->put(obs.data(), action.data(), t);
  refused(Code::kState, "put: the horizon is full; call rdm_agent_update first");
  fresh->update(obs.data(), nullptr), plain->update(obs.data(), nullptr);
  EXPECT_EQ(saved(*fresh), saved(*plain));
  fresh->cancel();
  refused(Code::kCancelled, "cancelled by the host");
  AgentSetup sees = PointWorld::setup("ppo_lag", 40);
  EXPECT_EQ(thrown([&] { sees.make()->put(obs.data(), action.data(), t); }).code, Code::kUnsupported);
}

// The largest actions that are taken teach something finite, and what they leave of the noise loads again.
TEST(Put, FarActionsStayFinite) {
  AgentSetup s = setup_of("ppo_lag", "0.9");
  const AgentPtr a = s.make(), other = s.make();
  NoiseWorld world(s.config);
  const std::vector<float> far(120, 1e5f);
  Epoch e;
  while (a->missing() > 0) {
    Transition t = world.transition();
    t.terminated = t.truncated = nullptr;
    a->put(world.obs(), far.data(), t);
    world.draw();
  }
  a->update(world.obs(), &e);
  EXPECT_EQ(e.skipped_gradients, 0);
  const auto state = saved(*a);
  other->load(state.data(), state.size());
}

TEST(Put, TakesNothingFromTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  for (const int32_t threads : {0, 2}) {
    AgentSetup s = setup_of("ppo_lag");
    s.config.num_threads = threads;
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    world.epoch(*a);
    const int64_t before = heap_count();
    while (a->missing() > 0) a->put(world.obs(), world.action(), world.transition());
    EXPECT_EQ(heap_count(), before) << threads;
  }
}

TEST(Put, OfRanks) {
  const auto setup = [] {
    AgentSetup s = busy_setup("ppo_lag", "free", 16);
    return s.with("blocks", "4");
  };
  AgentSetup alone = setup();
  std::vector<float> action(16 * 3);
  for (size_t i = 0; i < action.size(); ++i) action[i] = static_cast<float>(i % 7) * 0.1f - 0.3f;
  const auto play = [&](Agent& a, NoiseWorld& world, size_t first) {
    while (a.missing() > 0) {
      Transition t = world.transition();
      t.reward += first, t.cost += 2 * first, t.valid += first, t.success += first;
      t.terminated += first, t.truncated += first, t.final_obs += 6 * first;
      a.put(world.obs() + 6 * first, &action[3 * first], t);
      world.draw();
    }
    a.update(world.obs() + 6 * first, nullptr);
  };
  const AgentPtr whole = alone.make();
  NoiseWorld world(alone.config);
  for (int i = 0; i < 2; ++i) play(*whole, world, 0);
  Meeting meeting(2);
  std::vector<std::vector<unsigned char>> states(2);
  each_rank(2, [&](int32_t rank) {
    AgentSetup s = setup();
    NoiseWorld all(s.config);
    s.config.num_envs = 8;
    s.config.ranks = meeting.hooks(rank);
    const AgentPtr a = s.make();
    for (int i = 0; i < 2; ++i) play(*a, all, 8 * size_of(rank));
    states[size_of(rank)] = saved(*a);
  });
  for (const auto& state : states) EXPECT_EQ(state, saved(*whole));
}

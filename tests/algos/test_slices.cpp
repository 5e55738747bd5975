// An update in slices: the bytes of one whole update however it is cut, and what holds between two slices.
#include <cstring>
#include <functional>
#include <tuple>

#include "agents.hpp"
#include "heap_count.hpp"
#include "point_world.hpp"
#include "ranks.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

bool same(const Epoch& a, const Epoch& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Units of the k-th slice.
using Cut = std::function<int32_t(int64_t k)>;
const std::pair<const char*, Cut> kCuts[] = {
    {"one by one", [](int64_t) { return 1; }},
    {"sevens", [](int64_t) { return 7; }},
    {"uneven", [](int64_t k) { return static_cast<int32_t>(1 + k * k % 11); }},
    {"all", [](int64_t) { return 1 << 30; }},
};

// The update of a full horizon in slices; between() runs after each but the last one. Returns their number.
template <class Between>
int64_t sliced(Agent& a, const float* last_obs, const Cut& cut, Epoch* out, Between&& between) {
  a.begin_update(last_obs);
  int64_t slices = 1;
  for (; !a.update_on(cut(slices), out); ++slices) between();
  return slices;
}

template <class World>
void collect(World& world, Agent& a) {
  while (a.missing() > 0) world.decide(a);
}

std::vector<float> mean_action(Agent& a, const float* obs) {
  std::vector<float> action(size_of(a.config().num_envs) * size_of(a.config().action_dim));
  a.act(obs, false, action.data());
  return action;
}

// Epochs of one agent by whole updates, of another by slices in which it acts: the same in every byte, and
// what acts is the policy of before.
template <class Make, class World>
void expect_same_bytes(Make&& make, const World& fresh, int epochs) {
  for (const auto& [name, cut] : kCuts) {
    SCOPED_TRACE(name);
    const AgentPtr whole = make(0), parts = make(name[0] == 'o' ? 2 : 0);
    World one = fresh, other = fresh;
    for (int i = 0; i < epochs; ++i) {
      Epoch e, f;
      one.epoch(*whole, &e);
      collect(other, *parts);
      const auto before = other.judged(*parts);
      sliced(*parts, other.obs(), cut, &f, [&] { ASSERT_EQ(other.judged(*parts), before); });
      EXPECT_TRUE(same(e, f)) << i;
    }
    EXPECT_EQ(saved(*whole), saved(*parts));
  }
}

struct Noisy : NoiseWorld {
  using NoiseWorld::NoiseWorld;
  std::vector<float> judged(Agent& a) const { return mean_action(a, obs()); }
};

// Options of which each puts another job into an update.
struct Variant {
  const char* name;
  std::vector<std::pair<const char*, const char*>> options;
};
const Variant kVariants[] = {
    {"free", {{"std_mode", "free"}, {"average", "0.6"}}},
    {"state", {{"std_mode", "state"}, {"early_stop_kl", "0.5"}}},
    {"blocks", {{"blocks", "4"}, {"warm_epochs", "1"}, {"critic_l2", "0.001"}, {"joint_grad_norm", "on"}}},
};

class EveryAlgoInSlices : public testing::TestWithParam<std::tuple<int, int>> {
 protected:
  AgentSetup setup(int32_t threads = 0) const {
    const char* algo = algo_at(std::get<0>(GetParam())).name;
    AgentSetup s = busy_setup(algo, "free", 40);
    s.with("average", "0").with("horizon", "20");
    for (const auto& [key, text] : kVariants[std::get<1>(GetParam())].options) s.with_known(key, text);
    if (std::strcmp(algo, "ipo") == 0) s.with("barrier", "exact");
    s.config.num_threads = threads;
    return s;
  }
};

}  // namespace

TEST_P(EveryAlgoInSlices, AnyCutGivesTheSameBytes) {
  AgentSetup s = setup();
  expect_same_bytes([&](int32_t threads) { return setup(threads).make(); }, Noisy(s.ready()), 3);
}

TEST_P(EveryAlgoInSlices, ADropLeavesTheActorAsItWas) {
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  Noisy world(s.config);
  world.epoch(*a);
  world.epoch(*a);
  for (const bool cancelled : {false, true}) {
    for (int64_t slices = 1;; slices += 9) {
      collect(world, *a);
      const auto file = policy_file(*a);
      a->begin_update(world.obs());
      int64_t i = 0;
      while (i < slices && !a->update_on(1, nullptr)) ++i;
      if (i < slices) break;  // it was done before
      EXPECT_EQ(policy_file(*a), file);
      if (cancelled) {
        a->cancel();
        ASSERT_EQ(thrown([&] { a->update_on(1, nullptr); }).code, Code::kCancelled);
      } else {
        a->discard();
      }
      ASSERT_FALSE(a->updating());
      ASSERT_EQ(a->missing(), a->horizon());
      ASSERT_EQ(policy_file(*a), file) << slices;
      if (slices == 1) saved(*a);
    }
  }
  Epoch e;
  world.epoch(*a, &e);
  EXPECT_EQ(e.epoch, 5);  // the two that came to their ends
}

INSTANTIATE_TEST_SUITE_P(List, EveryAlgoInSlices,
                         testing::Combine(testing::Range(0, algo_count()), testing::Range(0, 3)),
                         [](const auto& info) {
                           return std::string(algo_at(std::get<0>(info.param)).name) + "_" +
                                  kVariants[std::get<1>(info.param)].name;
                         });

namespace {

struct Seeing : PointWorld {
  using PointWorld::PointWorld;
  const float* obs() const { return PointWorld::obs.data(); }
  std::vector<float> judged(Agent& a) const {
    std::vector<float> y(action.size());
    a.act(obs(), false, y.data(), clouds());
    return y;
  }
};

}  // namespace

TEST(Slices, OfAgentsThatSee) {
  for (const char* algo : {"ppo_lag", "cpo"})
    for (const char* frozen : {"off", "on"}) {
      SCOPED_TRACE(frozen);
      const auto make = [&](int32_t threads) {
        AgentSetup s = PointWorld::setup(algo, 40);
        s.config.num_threads = threads;
        return s.with("encoder_frozen", frozen).make();
      };
      expect_same_bytes(make, Seeing(40), 2);
    }
}

TEST(Slices, OfAgentsThatImitate) {
  std::vector<float> obs(300 * 6), label(300 * 3);
  Stream stream(4, 0, Purpose::kTest);
  for (float& x : obs) x = static_cast<float>(stream.signed_unit());
  for (float& x : label) x = static_cast<float>(stream.signed_unit());
  const DemoRows demo{300, obs.data(), label.data(), nullptr, {}};
  for (const char* algo : {"p3o", "pcpo"}) {
    const auto make = [&](int32_t threads) {
      AgentSetup s = busy_setup(algo, "free", 40);
      s.config.num_threads = threads;
      AgentPtr a = s.with("imitation", "0.5").with("average", "0").make();
      a->set_recording(demo, 7);
      return a;
    };
    AgentSetup s = busy_setup(algo, "free", 40);
    expect_same_bytes(make, Noisy(s.ready()), 2);
  }
}

// Each rank cuts as it likes: they wait for each other where the update exchanges something.
TEST(Slices, OfRanks) {
  for (const char* algo : {"p3o", "cpo"}) {
    const auto setup = [&] {
      AgentSetup s = busy_setup(algo, "free", 16);
      s.with("blocks", "4");
      return s;
    };
    AgentSetup alone = setup();
    const AgentPtr whole = alone.make();
    Noisy world(alone.config);
    for (int i = 0; i < 2; ++i) world.epoch(*whole);
    Meeting meeting(2);
    std::vector<std::vector<unsigned char>> states(2);
    each_rank(2, [&](int32_t rank) {
      AgentSetup s = setup();
      s.config.num_envs = 8;
      s.config.ranks = meeting.hooks(rank);
      const AgentPtr a = s.make();
      NoisePart part(s.config);
      for (int i = 0; i < 2; ++i) {
        collect(part, *a);
        sliced(*a, part.obs(), kCuts[rank].second, nullptr, [] {});
      }
      states[size_of(rank)] = saved(*a);
    });
    for (const auto& state : states) EXPECT_EQ(state, saved(*whole)) << algo;
  }
}

TEST(Slices, TakeNothingFromTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  for (const char* algo : {"p3o", "pcpo"})
    for (const int32_t threads : {0, 2}) {
      AgentSetup s = busy_setup(algo, "free", 40);
      s.config.num_threads = threads;
      const AgentPtr a = s.make();
      Noisy world(s.config);
      world.epoch(*a);
      collect(world, *a);
      Epoch e;
      const int64_t before = heap_count();
      a->begin_update(world.obs());
      do a->act(world.obs(), false, world.action());
      while (!a->update_on(1, &e));
      EXPECT_EQ(heap_count(), before) << algo;
    }
}

TEST(Slices, WhatHasToWait) {
  AgentSetup s = busy_setup("ppo_lag", "free", 40);
  const AgentPtr a = s.make();
  Noisy world(s.config);
  EXPECT_EQ(thrown([&] { a->update_on(1, nullptr); }).code, Code::kState);
  EXPECT_EQ(thrown([&] { a->begin_update(world.obs()); }).code, Code::kState);
  const auto fresh = saved(*a);
  collect(world, *a);
  a->begin_update(world.obs());
  ASSERT_FALSE(a->update_on(5, nullptr));
  float value[1];
  const std::function<void()> calls[] = {
      [&] { a->act(world.obs(), true, world.action()); },
      [&] { a->record(world.transition()); },
      [&] { a->update(world.obs(), nullptr); },
      [&] { a->begin_update(world.obs()); },
      [&] { saved(*a); },
      [&] {
        a->set_option({"learning_rate", nullptr, 1e-3});
      },
      [&] { a->values(world.obs(), nullptr, 1, value, value); },
      [&] { a->set_recording({}, 0); },
      [&] { a->clone({}, {}); },
  };
  for (const auto& call : calls) {
    const Thrown t = thrown(call);
    EXPECT_EQ(t.code, Code::kState);
    EXPECT_NE(t.text.find("an update is under way; finish it with rdm_agent_update_slice"), std::string::npos)
        << t.text;
  }
  EXPECT_TRUE(a->updating());
  // bytes that do not load leave it where it is, bytes that do put it away
  EXPECT_NE(thrown([&] { a->load(fresh.data(), fresh.size() - 1); }).code, Code::kOk);
  EXPECT_TRUE(a->updating());
  a->load(fresh.data(), fresh.size());
  EXPECT_FALSE(a->updating());
  EXPECT_EQ(saved(*a), fresh);
}

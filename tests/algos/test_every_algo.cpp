// What every algorithm promises, for each of the list.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <tuple>

#include "agents.hpp"
#include "heap_count.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup setup_of(const char* algo, const char* std_mode, int32_t threads = 0) {
  AgentSetup s = busy_setup(algo, std_mode, 40);
  s.config.num_threads = threads;
  return s;
}

std::vector<unsigned char> state_after(AgentSetup s, int epochs) {
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; i < epochs; ++i) world.epoch(*a);
  return saved(*a);
}

class EveryAlgo : public testing::TestWithParam<std::tuple<int, const char*>> {
 protected:
  const AlgoInfo& info() const { return algo_at(std::get<0>(GetParam())); }
  AgentSetup setup(int32_t threads = 0) const {
    return setup_of(info().name, std::get<1>(GetParam()), threads);
  }
};

}  // namespace

TEST_P(EveryAlgo, Learns) {
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  const std::vector<float> before = parameters(*a);
  Epoch e;
  for (int i = 0; i < 3; ++i) world.epoch(*a, &e);
  const std::vector<float> after = parameters(*a);
  size_t changed = 0;
  for (size_t i = 0; i < after.size(); ++i) {
    ASSERT_TRUE(std::isfinite(after[i]));
    changed += after[i] != before[i];
  }
  EXPECT_GT(changed, after.size() * 9 / 10);
  EXPECT_GT(e.kl, 0);
  if (s.off_policy())
    EXPECT_GE(e.passes, 3);
  else
    EXPECT_EQ(e.passes, 3);
  EXPECT_GT(e.loss_reward_value, 0);
}

// A number that was not measured is NaN, not 0.
TEST_P(EveryAlgo, SaysWhatItDoesNotMeasure) {
  const auto one_of = [&](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(),
                       [&](const char* name) { return std::strcmp(name, info().name) == 0; });
  };
  const bool clips = one_of({"ppo", "ppo_lag", "p3o", "ipo", "cppo_pid", "focops", "cup", "rcpo", "mappo",
                             "mappo_lag", "happo", "ippo", "ippo_lag"});
  const bool steps = one_of({"trpo", "trpo_lag", "cpo", "pcpo", "crpo", "macpo", "pdo"});
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  Epoch e;
  for (int i = 0; i < 3; ++i) world.epoch(*a, &e);
  if (clips || steps || s.off_policy()) {
    EXPECT_EQ(std::isfinite(e.clip_fraction), clips) << e.clip_fraction;
  }
  const Costs costs = algo_row(algo_find(info().name)).costs;
  const bool judges =
      costs == Costs::kAny || costs == Costs::kOne || (s.off_policy() && costs != Costs::kNone);
  EXPECT_EQ(std::isfinite(e.loss_cost_value), judges) << e.loss_cost_value;
  EXPECT_EQ(std::isfinite(e.value_cost), judges) << e.value_cost;
  for (int32_t k = 0; k < kMaxCosts; ++k) EXPECT_EQ(std::isfinite(e.cost[k]), k < s.config.cost_dim) << k;
}

TEST_P(EveryAlgo, SameBytesForAnyThreads) {
  const auto wanted = state_after(setup(), 3);
  for (const int32_t threads : {1, 2, 4}) EXPECT_EQ(state_after(setup(threads), 3), wanted) << threads;
}

TEST_P(EveryAlgo, ResumeEqualsUnbroken) {
  AgentSetup s = setup();
  const AgentPtr whole = s.make();
  NoiseWorld world(s.config);
  for (int i = 0; i < 3; ++i) world.epoch(*whole);
  const auto bytes = saved(*whole);
  AgentSetup other = setup(2);
  other.config.seed = 999;
  const AgentPtr resumed = other.make();
  resumed->load(bytes.data(), bytes.size());
  EXPECT_EQ(saved(*resumed), bytes);
  NoiseWorld copy = world;
  Epoch e, f;
  for (int i = 0; i < 3; ++i) {
    world.epoch(*whole, &e);
    copy.epoch(*resumed, &f);
    EXPECT_EQ(0, std::memcmp(&e, &f, sizeof e)) << i;
  }
  EXPECT_EQ(saved(*whole), saved(*resumed));
}

TEST_P(EveryAlgo, NoHeapInActRecordUpdate) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  for (const int32_t threads : {0, 2}) {
    AgentSetup s = setup(threads);
    const AgentPtr a = s.make();
    NoiseWorld world(s.config);
    Epoch e;
    const int64_t before = heap_count();
    for (int i = 0; i < 3; ++i) world.epoch(*a, &e);
    a->act(world.obs(), false, world.action());
    EXPECT_EQ(heap_count(), before) << threads;
  }
}

TEST_P(EveryAlgo, AHorizonOfDeadRowsTeachesNothing) {
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  const std::vector<uint8_t> none(40, 0);
  while (a->missing() > 0) {
    a->act(world.obs(), true, world.action());
    world.draw();
    Transition t = world.transition();
    t.valid = none.data();
    a->record(t);
  }
  const std::vector<float> before = parameters(*a);
  a->update(world.obs(), nullptr);
  EXPECT_EQ(parameters(*a), before);
}

TEST_P(EveryAlgo, CancelLeavesAWorkingAgent) {
  AgentSetup s = setup();
  const AgentPtr a = s.make();
  NoiseWorld world(s.config);
  while (a->missing() > 0) world.decide(*a);
  const std::vector<float> before = parameters(*a);
  a->cancel();
  EXPECT_EQ(thrown([&] { a->update(world.obs(), nullptr); }).code, Code::kCancelled);
  EXPECT_EQ(parameters(*a), before);
  world.epoch(*a);
}

TEST_P(EveryAlgo, OptionsHaveHelpAndBounds) {
  const AlgoInfo& algo = info();
  for (int32_t i = 0; i < algo.num_options; ++i) {
    const OptionSpec& o = algo.options[i];
    EXPECT_GT(std::strlen(o.help), 10u) << o.key;
    EXPECT_LT(std::strlen(o.help), 100u) << o.key;
    for (int32_t k = 0; k < i; ++k) EXPECT_FALSE(same_name(o.key, algo.options[k].key)) << o.key;
    if (o.kind == OptionKind::kText) {
      EXPECT_NE(o.text, nullptr) << o.key;
    } else {
      EXPECT_LE(o.low, o.number) << o.key;
      EXPECT_GE(o.high, o.number) << o.key;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(List, EveryAlgo,
                         testing::Combine(testing::Range(0, algo_count()), testing::Values("free", "state")),
                         [](const auto& info) {
                           return std::string(algo_at(std::get<0>(info.param)).name) + "_" +
                                  std::get<1>(info.param);
                         });

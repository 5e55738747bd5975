// Learning from recorded rows: where they stand in the memory, each step against one in double, what the policy becomes,
// and what is promised of every call.
#include <cmath>

#include "agents.hpp"
#include "algos/off_policy/off_policy.hpp"
#include "heap_count.hpp"
#include "offline_oracle.hpp"

namespace rdm::test {
namespace {

// The algorithms that a recording can teach.
std::vector<const char*> learners() {
  std::vector<const char*> names;
  for (int32_t i = 0; i < algo_count(); ++i)
    if (algo_row(i).off_policy) names.push_back(algo_at(i).name);
  return names;
}

}  // namespace

// Each row that can be drawn is a recorded one with the next of its episode behind it; the last row of an episode is
// there where it terminated. Worlds that stepped together make no difference, nor do several rings.
TEST(Learn, TheMemoryHasTheRecordedRows) {
  const Recorded plain = noise(30, 2, 1);
  Recorded turns(2, 1);  // the same episodes, two at a time, row by row in turn
  std::vector<std::vector<size_t>> of(30);
  for (size_t i = 0; i < plain.reward.size(); ++i) of[static_cast<size_t>(plain.episode[i])].push_back(i);
  for (size_t e = 0; e < 30; e += 2)
    for (size_t t = 0; t < 12; ++t)
      for (const size_t k : {e, e + 1}) {
        if (t >= of[k].size()) continue;
        const size_t i = of[k][t];
        turns.obs.insert(turns.obs.end(), {plain.obs[2 * i], plain.obs[2 * i + 1]});
        turns.action.push_back(plain.action[i]), turns.cost.push_back(plain.cost[i]);
        turns.reward.push_back(plain.reward[i]), turns.terminated.push_back(plain.terminated[i]);
        turns.truncated.push_back(plain.truncated[i]), turns.episode.push_back(plain.episode[i]);
      }
  size_t wanted = 0;
  for (const auto& rows : of) wanted += rows.size() - !plain.terminated[rows.back()];
  for (const Recorded* r : {&plain, static_cast<const Recorded*>(&turns)})
    for (const int32_t envs : {1, 3}) {
      AgentSetup s = learner("td3_bc_lag", *r, "300", envs);
      const AgentPtr a = s.make();
      EXPECT_EQ(a->learn(r->rows(), 0).rows, static_cast<int64_t>(wanted));
      const Replay& m = memory_of(*a);
      size_t found = 0;
      for (int32_t i = 0; i < m.capacity(); ++i) {
        if (!m.drawable(i)) continue;
        ++found;
        const auto at = std::find(plain.reward.begin(), plain.reward.end(), m.reward(i));
        ASSERT_NE(at, plain.reward.end());
        const auto k = static_cast<size_t>(at - plain.reward.begin());
        EXPECT_EQ(m.obs(i)[0], plain.obs[2 * k]);
        EXPECT_EQ(m.action(i)[0], plain.action[k]);
        EXPECT_EQ(m.cost(i)[0], plain.cost[k]);
        EXPECT_EQ(m.discount(i), plain.terminated[k] ? 0 : 0.99f);
        EXPECT_EQ(m.next_obs(i)[1], plain.terminated[k] ? m.next_obs(i)[1] : plain.obs[2 * k + 3]);
      }
      EXPECT_EQ(found, wanted);
    }
}

// The same recording again is not filled in again; another one is; one that does not fit leaves all as it was.
TEST(Learn, FillsTheMemoryOnce) {
  const Recorded r = noise(20, 2, 1), other = noise(20, 2, 1, 1, 2), large = noise(400, 2, 1);
  AgentSetup s = learner("td3_bc_lag", r, "300");
  const AgentPtr a = s.make();
  a->learn(r.rows(), 5);
  const auto before = saved(*a);
  a->learn(r.rows(), 0);
  EXPECT_EQ(saved(*a), before);
  const Thrown refused = thrown([&] { a->learn(large.rows(), 1); });
  EXPECT_EQ(refused.code, Code::kRange);
  EXPECT_NE(refused.text.find("replay_rows: 300 has no place"), std::string::npos) << refused.text;
  EXPECT_EQ(saved(*a), before);
  const int64_t rows = a->learn(other.rows(), 0).rows;
  EXPECT_EQ(memory_of(*a).rows(), rows);
  EXPECT_NE(saved(*a), before);
}

TEST(Learn, RefusesWhatNothingCanBeLearnedFrom) {
  Stream stream(1, 0, Purpose::kTest);
  Recorded cut(2, 1);
  for (int64_t e = 0; e < 4; ++e) cut.add(e, stream, true, true);  // a row each, cut by time
  AgentSetup s = learner("td3_bc_lag", cut, "50");
  const AgentPtr a = s.make();
  EXPECT_NE(thrown([&] { a->learn(cut.rows(), 1); }).text.find("no row is followed"), std::string::npos);
  Recorded paid = noise(4, 2, 1);
  paid.cost[2] = -0.5f;
  EXPECT_NE(thrown([&] { a->learn(paid.rows(), 1); }).text.find("row 2 has a cost of -0.5"),
            std::string::npos);
  const Recorded good = noise(4, 2, 1);
  for (const auto& [key, value] : {std::pair("terminal_cost", "on"), {"cost_signal", "raw"}}) {
    AgentSetup t = learner("td3_bc_lag", good, "50");
    const AgentPtr b = t.with(key, value).make();
    const Thrown no = thrown([&] { b->learn(good.rows(), 1); });
    EXPECT_EQ(no.code, Code::kUnsupported) << key;
    EXPECT_NE(no.text.find(key), std::string::npos) << no.text;
  }
  NoiseWorld world(s.config);
  world.decide(*a);
  EXPECT_EQ(thrown([&] { a->learn(good.rows(), 1); }).code, Code::kState);
  AgentSetup on_policy("ppo_lag", 2, 1, 1);
  const AgentPtr p = on_policy.make();
  const Thrown no = thrown([&] { p->learn(good.rows(), 1); });
  EXPECT_EQ(no.code, Code::kUnsupported);
  EXPECT_NE(no.text.find("ppo_lag learns from its own decisions alone; td3_bc_lag"), std::string::npos)
      << no.text;
}

// For every learner from a memory, and any number of threads: 260 steps, cut into calls anyhow and saved in between.
TEST(Learn, SameBytesForAnyThreadsAndCalls) {
  const Recorded r = noise(40, 4, 2, 2);
  for (const char* algo : learners()) {
    const auto make = [&](int32_t threads) {
      AgentSetup s = learner(algo, r, "400");
      s.config.num_threads = threads;
      s.with("average", "0.5");
      return s.make();
    };
    const AgentPtr whole = make(0);
    whole->learn(r.rows(), 260);
    const auto wanted = saved(*whole);
    for (const int32_t threads : {1, 3}) {
      const AgentPtr a = make(threads);
      a->learn(r.rows(), 260);
      EXPECT_EQ(saved(*a), wanted) << algo << ' ' << threads;
    }
    const AgentPtr first = make(2), second = make(0);
    for (const int64_t steps : {60, 40, 77}) first->learn(r.rows(), steps);
    const auto bytes = saved(*first);
    second->load(bytes.data(), bytes.size());
    second->learn(r.rows(), 83);
    EXPECT_EQ(saved(*second), wanted) << algo;
  }
}

// With option average a policy file has the mean of what the policy was after each 100 steps; before the first 100, the
// policy itself.
TEST(Learn, PolicyFilesHaveTheMeanOverSteps) {
  const Recorded r = noise(40, 4, 2, 2);
  const auto make = [&](const char* share) {
    AgentSetup s = learner("td3_bc_lag", r, "400");
    return s.with("average", share).make();
  };
  const auto params = [](Agent& a) {
    const std::vector<unsigned char> file = policy_file(a);
    const std::unique_ptr<Policy, decltype(&Policy::destroy)> p(
        Policy::read(file.data(), file.size(), HostHooks()), Policy::destroy);
    return std::vector<double>(p->view().params, p->view().params + p->view().num_params());
  };
  const AgentPtr plain = make("0"), mean = make("0.75");
  plain->learn(r.rows(), 60), mean->learn(r.rows(), 60);
  EXPECT_EQ(params(*mean), params(*plain));
  std::vector<double> wanted;
  int taken = 0;
  for (const int64_t steps : {40, 100, 100, 100, 100, 100, 70}) {
    plain->learn(r.rows(), steps), mean->learn(r.rows(), steps);
    const std::vector<double> now = params(*plain);
    if (taken < 6) {  // the last call ends inside a hundred
      const double share = std::max(0.25, 1.0 / ++taken);
      if (taken == 1) wanted = now;
      for (size_t i = 0; i < now.size(); ++i) wanted[i] += share * (now[i] - wanted[i]);
    }
    const std::vector<double> got = params(*mean);
    ASSERT_EQ(got.size(), wanted.size());
    double apart = 0;
    for (size_t i = 0; i < got.size(); ++i) {
      EXPECT_NEAR(got[i], wanted[i], 1e-6) << i << " after mean " << taken;
      apart = std::max(apart, std::fabs(got[i] - now[i]));
    }
    if (taken > 1) {
      EXPECT_GT(apart, 1e-4);
    }
  }
}

TEST(Learn, NoHeapAfterTheFirstCall) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is the sanitizer's here";
  const Recorded r = noise(40, 4, 2);
  for (const char* algo : learners())
    for (const int32_t threads : {0, 2}) {
      AgentSetup s = learner(algo, r, "400", 2);
      s.config.num_threads = threads;
      const AgentPtr a = s.make();
      a->learn(r.rows(), 1);
      const int64_t before = heap_count();
      for (int i = 0; i < 3; ++i) a->learn(r.rows(), 120);
      EXPECT_EQ(heap_count(), before) << algo << ' ' << threads;
    }
}

// Six steps of td3_bc_lag beside the same in double: rows drawn by the same stream, targets, both critics of the reward
// and of the cost, the actor's loss by differences, slow copies.
TEST(Learn, Td3BcStepsAreThoseInDouble) {
  constexpr double kRate = 1e-2, kTau = 0.2, kAlpha = 1.7, kWeight = 0.6;
  constexpr size_t kBatch = 10;
  const Recorded r = noise(12, 3, 2);
  AgentSetup s = step_by_step("td3_bc_lag", 3, 2, "10",
                              {{"bc_alpha", "1.7", 0},
                               {"policy_delay", "1", 0},
                               {"target_std", "0", 0},
                               {"multiplier_init", "0.6", 0},
                               {"multiplier_lr", "0", 0}});
  const AgentPtr a = s.make();
  a->learn(r.rows(), 0);
  PlainNet actor = net_of(*a, "actor");
  PlainCritics q = critics_of(*a);
  PlainNet slow_actor = actor;
  PlainCritics slow = q;
  PlainAdam actor_adam, adam[4];
  const auto acts = [](const PlainNet& net, const Numbers& x) { return with_tanh(net(x)); };
  const Replay& m = memory_of(*a);
  Stream draws(s.config.seed, 1 << 20, Purpose::kMinibatch);
  for (int step = 0; step < 6; ++step) {
    int32_t rows[kBatch];
    m.draw(draws, kBatch, rows);
    Numbers target[2];
    for (const int32_t i : rows) {
      const Numbers next = numbers(m.next_obs(i), 3), x = joined(next, acts(slow_actor, next));
      const auto d = static_cast<double>(m.discount(i));
      target[0].push_back(static_cast<double>(m.reward(i)) + d * std::min(slow[0](x)[0], slow[1](x)[0]));
      target[1].push_back(static_cast<double>(m.cost(i)[0]) +
                          d * std::max({slow[2](x)[0], slow[3](x)[0], 0.0}));
    }
    for (int net = 0; net < 4; ++net) {
      const Numbers g = differences(q[net].p, [&] {
        double sum = 0;
        for (size_t k = 0; k < kBatch; ++k) {
          const double e = q[net](joined(numbers(m.obs(rows[k]), 3), numbers(m.action(rows[k]), 2)))[0] -
                           target[net / 2][k];
          sum += e * e / kBatch;
        }
        return sum;
      });
      adam[net].step(q[net].p, g, kRate);
      for (size_t i = 0; i < g.size(); ++i) slow[net].p[i] += kTau * (q[net].p[i] - slow[net].p[i]);
    }
    double scale = 0;
    const auto climbed = [&](bool magnitude) {
      double sum = 0;
      for (const int32_t i : rows) {
        const Numbers obs = numbers(m.obs(i), 3), x = joined(obs, acts(actor, obs));
        const double reward = q[0](x)[0], cost = std::max(q[2](x)[0], q[3](x)[0]);
        sum += magnitude ? std::abs(reward) + kWeight * std::abs(cost) : reward - kWeight * cost;
      }
      return sum / (kBatch * (1 + kWeight));
    };
    scale = kAlpha / climbed(true);
    const Numbers g = differences(actor.p, [&] {
      double away = 0;
      for (const int32_t i : rows) {
        const Numbers now = acts(actor, numbers(m.obs(i), 3));
        for (size_t j = 0; j < 2; ++j)
          away += std::pow(now[j] - static_cast<double>(m.action(i)[j]), 2) / (2 * kBatch);
      }
      return away - scale * climbed(false);
    });
    actor_adam.step(actor.p, g, kRate);
    for (size_t i = 0; i < g.size(); ++i) slow_actor.p[i] += kTau * (actor.p[i] - slow_actor.p[i]);
    a->learn(r.rows(), 1);
    SCOPED_TRACE("step " + std::to_string(step));
    expect_critics(*a, q, 2e-4);
    expect_nets(*a, {{"actor", &actor}}, 2e-4);
    ASSERT_FALSE(HasFailure());
  }
}

TEST(Learn, CancelLeavesAWorkingAgent) {
  const Recorded r = noise(40, 4, 2);
  AgentSetup s = learner("td3_bc_lag", r, "400");
  const AgentPtr a = s.make();
  a->learn(r.rows(), 3);
  const auto before = saved(*a);
  a->cancel();
  EXPECT_EQ(thrown([&] { a->learn(r.rows(), 5); }).code, Code::kCancelled);
  EXPECT_EQ(saved(*a), before);
  a->learn(r.rows(), 5);
  NoiseWorld world(s.config);
  world.epoch(*a);
}

}  // namespace rdm::test
